#include "boards/posix/telecommand_key_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <span>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace vbar::boards::posix {

const char* read_telecommand_key(const char* path, fsw::packets::TelecommandSecurity& security) {
  const int fd = ::open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (fd < 0) return std::strerror(errno);
  struct stat status {};
  std::array<char, 128> text{};
  const bool is_file = ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
  const ssize_t size = is_file ? ::read(fd, text.data(), text.size()) : 0;
  ::close(fd);
  if (!is_file) return "is not a file";
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) return "is accessible to others than its owner (chmod 600)";
  if (size < 0) return "cannot be read";
  const auto key = fsw::packets::parse_telecommand_key(std::span(text).first(static_cast<std::size_t>(size)));
  if (key.status() == fsw::Status::kInvalidArgument) return "has characters that are not hexadecimal digits";
  if (key.status() == fsw::Status::kTooShort) return "has fewer than 64 digits";
  if (!key.ok() || static_cast<std::size_t>(size) == text.size()) return "has more than 64 digits";
  timespec now{};
  if (::clock_gettime(CLOCK_REALTIME, &now) != 0) return std::strerror(errno);
  security.key = key.value();
  security.index = fsw::packets::kHostKeyIndex;
  security.sequence = fsw::packets::sequence_at(now.tv_sec, now.tv_nsec);
  return nullptr;
}

}  // namespace vbar::boards::posix
