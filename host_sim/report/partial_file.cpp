#include "host_sim/report/partial_file.h"

#include <stdexcept>
#include <system_error>
#include <utility>

namespace vbar::report {

PartialFile::PartialFile(std::filesystem::path file)
    : file_(std::move(file)), stream_(part_of(file_), std::ios::binary | std::ios::trunc) {
  if (!stream_) fail();
}

void PartialFile::append(std::string_view text) {
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) fail();
}

void PartialFile::flush() {
  if (!stream_.flush()) fail();
}

void PartialFile::finish() {
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
  throw std::runtime_error(file_.string() + ": cannot be written");
}

}  // namespace vbar::report
