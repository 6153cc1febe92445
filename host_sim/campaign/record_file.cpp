#include "host_sim/campaign/record_file.h"

#include <cerrno>
#include <cstdint>
#include <optional>
#include <span>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "fsw/packets/crc.h"
#include "host_sim/files/write_error.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign {
namespace {

constexpr std::string_view kChecksum = ",\"crc32\":\"";
constexpr std::size_t kDigits = 8;

std::string checksum_of(std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return fmt::format("{:08x}", fsw::packets::crc32_ieee(bytes));
}

std::optional<Json> object_of(std::string_view line) {
  const std::size_t end = kChecksum.size() + kDigits + 2;  // the quote and the brace
  if (line.size() < end || line.substr(line.size() - end, kChecksum.size()) != kChecksum) return std::nullopt;
  if (!line.ends_with("\"}")) return std::nullopt;
  const std::string body = std::string(line.substr(0, line.size() - end)) + "}";
  if (line.substr(line.size() - kDigits - 2, kDigits) != checksum_of(body)) return std::nullopt;
  Json object = Json::parse(body, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  return object;
}

}  // namespace

std::string line_of(const Json& object) {
  std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string checksum = checksum_of(text);
  text.pop_back();
  return fmt::format("{}{}{}\"}}", text, kChecksum, checksum);
}

RecordFile::RecordFile(std::filesystem::path file) : file_(std::move(file)) {
  errno = 0;
  descriptor_ = io::FileDescriptor(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644));
  if (descriptor_.get() < 0 || ::flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0) throw files::write_error(file_);
}

void RecordFile::append(const Json& object, Sync sync) {
  const std::string line = line_of(object) + "\n";
  std::string_view left = line;
  while (!left.empty()) {
    errno = 0;
    const ssize_t written = ::write(descriptor_.get(), left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw files::write_error(file_);
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  if (sync == Sync::kYes && ::fdatasync(descriptor_.get()) != 0) throw files::write_error(file_);
}

bool is_being_written(const std::filesystem::path& file) {
  const io::FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return descriptor.get() >= 0 && ::flock(descriptor.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

ReadLines read_lines_of(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  ReadLines read;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) break;  // the writer was killed in it
    if (auto object = object_of(rest.substr(0, end)))
      read.lines.push_back(std::move(*object));
    else
      ++read.damaged;
    rest.remove_prefix(end + 1);
  }
  return read;
}

}  // namespace vbar::campaign
