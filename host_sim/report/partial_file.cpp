#include "host_sim/report/partial_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "host_sim/files/remove_link.h"
#include "host_sim/files/write_error.h"

namespace vbar::files {

PartialFile::PartialFile(std::filesystem::path file) : file_(std::move(file)) {
  remove_link(part_of(file_));
  errno = 0;
  stream_.open(part_of(file_), std::ios::binary | std::ios::trunc);
  if (!stream_) fail();
}

void PartialFile::append(std::string_view text) {
  errno = 0;
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) fail();
}

void PartialFile::flush() {
  if (!stream_.flush()) fail();
}

void PartialFile::finish() {
  errno = 0;
  stream_.close();
  std::error_code error;
  if (stream_) std::filesystem::rename(part_of(file_), file_, error);
  if (!stream_ || error) fail();
}

std::filesystem::path PartialFile::part_of(const std::filesystem::path& file) {
  std::filesystem::path part = file;
  part += ".part";
  return part;
}

void PartialFile::fail() const {
  throw write_error(file_);
}

}  // namespace vbar::files
