#include "host_sim/files/output_file.h"

#include <array>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace vbar::files {

std::runtime_error write_error(const std::filesystem::path& file) {
  std::string text = file.string() + ": cannot be written";
  if (errno != 0) text += ": " + std::generic_category().message(errno);
  return std::runtime_error(text);
}

void remove_link(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(file, error))) return;
  if (!std::filesystem::remove(file, error) && error)
    throw std::runtime_error(file.string() + ": is a symbolic link that cannot be removed: " + error.message());
}

std::optional<std::string> contents_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string contents;
  std::array<char, 1 << 16> block;
  // An iterator over the stream's buffer would throw the library's own sentence where the disk fails.
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    contents.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  if (!stream.is_open() || stream.bad()) return std::nullopt;
  return contents;
}

std::string read_text_file(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": no such file");
  std::optional<std::string> text = contents_of(file);
  if (!text) throw std::runtime_error(file.string() + ": cannot be read");
  return *std::move(text);
}

std::filesystem::path neighbour_of(const std::filesystem::path& file) {
  return file.string() + ".new";
}

void replace_text_file(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path neighbour = neighbour_of(file);
  remove_link(neighbour);
  errno = 0;
  std::ofstream stream(neighbour, std::ios::binary | std::ios::trunc);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(neighbour, file, error);
  if (!stream || error) {
    const std::runtime_error reason = write_error(file);
    std::error_code ignored;
    std::filesystem::remove(neighbour, ignored);
    throw reason;
  }
}

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
