#include "host_sim/files/released_file.h"

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "host_sim/files/output_file.h"

namespace vbar::files {
namespace {

constexpr std::size_t kPendingBytes = 16'384;

}  // namespace

ReleasedFile::ReleasedFile(std::filesystem::path file) : file_(std::move(file)) {
  const PartialFile started(file_);
  pending_.reserve(kPendingBytes);
}

void ReleasedFile::append(std::string_view text) {
  if (pending_.size() + text.size() > kPendingBytes) flush();
  pending_ += text;
}

void ReleasedFile::flush() {
  if (pending_.empty()) return;
  errno = 0;
  std::ofstream stream(PartialFile::part_of(file_), std::ios::binary | std::ios::app);
  stream.write(pending_.data(), static_cast<std::streamsize>(pending_.size()));
  stream.close();
  pending_.clear();  // after a failure too: a part of it may have been written
  if (!stream) throw write_error(file_);
}

void ReleasedFile::finish() {
  flush();
  std::error_code error;
  std::filesystem::rename(PartialFile::part_of(file_), file_, error);
  if (error) throw write_error(file_);
}

}  // namespace vbar::files
