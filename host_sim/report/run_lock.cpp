#include "host_sim/report/run_lock.h"

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host_sim/files/remove_link.h"

namespace vbar::report {
namespace {

std::string process_in(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size() - 1, 0);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "of an unknown number";
}

/// Whether the open file is still the one of that name: its last holder may have removed it meanwhile.
bool is_current(int descriptor, const std::filesystem::path& file) {
  struct stat held {
  }, named{};
  return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace

RunLock::RunLock(const std::filesystem::path& folder) : file_(folder / kFile) {
  files::remove_link(file_);
  while (descriptor_ < 0) {
    const int descriptor = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (descriptor < 0)
      throw std::runtime_error(file_.string() + ": cannot be written: " + std::generic_category().message(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      const std::string process = process_in(descriptor);
      ::close(descriptor);
      if (error == EWOULDBLOCK)
        throw FolderRefused(folder.string() + ": is being written by a run in process " + process);
      throw std::runtime_error(file_.string() + ": cannot be locked: " + std::generic_category().message(error));
    }
    if (is_current(descriptor, file_))
      descriptor_ = descriptor;
    else
      ::close(descriptor);
  }
  const std::string process = std::to_string(::getpid());
  // The number only serves the message of another run; on a full disk it is missing.
  if (::ftruncate(descriptor_, 0) == 0) static_cast<void>(!::write(descriptor_, process.data(), process.size()));
}

RunLock::~RunLock() {
  if (is_current(descriptor_, file_)) ::unlink(file_.c_str());  // the folder may have been replaced
  ::close(descriptor_);
}

}  // namespace vbar::report
