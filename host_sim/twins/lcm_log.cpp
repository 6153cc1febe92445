#include "host_sim/twins/lcm_log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>

#include "fsw/packets/big_endian.h"
#include "host_sim/files/output_file.h"

namespace vbar::twins {

using fsw::packets::write_big_endian;

LcmLogWriter::LcmLogWriter(const std::filesystem::path& file) : file_(file) {
  files::remove_link(file);
  errno = 0;
  stream_.reset(std::fopen(file.c_str(), "we"));
  if (stream_ == nullptr) throw files::write_error(file);
}

void LcmLogWriter::put(std::span<const std::uint8_t> bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) throw files::write_error(file_);
}

void LcmLogWriter::write(std::int64_t timestamp, const std::string& channel, std::span<const std::uint8_t> data) {
  std::array<std::uint8_t, lcm_log::kHeaderBytes> header{};
  write_big_endian(lcm_log::kSyncWord, std::span(header), lcm_log::kSyncAt);
  write_big_endian(static_cast<std::uint64_t>(events_), std::span(header), lcm_log::kNumberAt);
  write_big_endian(static_cast<std::uint64_t>(timestamp), std::span(header), lcm_log::kTimeAt);
  write_big_endian(static_cast<std::uint32_t>(channel.size()), std::span(header), lcm_log::kChannelBytesAt);
  write_big_endian(static_cast<std::uint32_t>(data.size()), std::span(header), lcm_log::kDataBytesAt);
  put(header);
  put({reinterpret_cast<const std::uint8_t*>(channel.data()), channel.size()});
  put(data);
  ++events_;
}

void LcmLogWriter::flush() {
  errno = 0;
  if (std::fflush(stream_.get()) != 0) throw files::write_error(file_);
}

namespace {

using fsw::packets::read_big_endian;

using lcm_log::kHeaderBytes;
using lcm_log::kSyncWord;

constexpr std::uint32_t kChannelBytesMax = 63;                // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::uint32_t kDataBytesMax = 64U * 1024U * 1024U;  // a packet has 64 kB; other programs may log images

}  // namespace

LcmLogReader::LcmLogReader(const std::filesystem::path& file) : file_(file) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": no such file");
  stream_.open(file, std::ios::binary);
  if (!stream_) throw std::runtime_error(file.string() + ": cannot be read");
  size_ = std::filesystem::file_size(file);
}

void LcmLogReader::fail(std::uint64_t offset, const std::string& what) const {
  throw DamagedLog(file_.string() + ": byte " + std::to_string(offset) + ": " + what);
}

bool LcmLogReader::has_event_after(std::uint64_t offset) {
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset + 1));
  std::uint32_t window = 0;
  for (int byte = stream_.get(); byte != std::ifstream::traits_type::eof(); byte = stream_.get()) {
    window = window << 8U | static_cast<std::uint32_t>(byte);
    if (window == kSyncWord) return true;
  }
  return false;
}

/// The event at `offset` reaches beyond the end of the file. A truncated log ends there; if another
/// event follows, the size is wrong.
void LcmLogReader::take_rest_as_cut(std::uint64_t offset) {
  if (has_event_after(offset)) fail(offset, "an event whose size is wrong, as another event stands within it");
  cut_short_ = true;
  offset_ = size_;
}

std::optional<LoggedEvent> LcmLogReader::next() {
  const std::uint64_t begin = offset_, left = size_ - offset_;
  if (left == 0) return std::nullopt;
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  const std::size_t available = std::min<std::uint64_t>(left, kHeaderBytes);
  stream_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(available));
  if (!stream_) fail(begin, "cannot be read");
  const std::span header(bytes);
  if (available < sizeof kSyncWord && begin > 0) {
    take_rest_as_cut(begin);
    return std::nullopt;
  }
  if (available < sizeof kSyncWord || read_big_endian<std::uint32_t>(header, lcm_log::kSyncAt) != kSyncWord)
    fail(begin, begin == 0 ? "not an LCM log" : "no event starts here, where one has to");
  if (available < kHeaderBytes) {
    take_rest_as_cut(begin);
    return std::nullopt;
  }
  LoggedEvent event;
  event.offset = begin;
  event.number = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(header, lcm_log::kNumberAt));
  event.timestamp = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(header, lcm_log::kTimeAt));
  const auto channel_bytes = read_big_endian<std::uint32_t>(header, lcm_log::kChannelBytesAt);
  const auto data_bytes = read_big_endian<std::uint32_t>(header, lcm_log::kDataBytesAt);
  if (channel_bytes == 0 || channel_bytes > kChannelBytesMax)
    fail(begin, "an event whose channel name has " + std::to_string(channel_bytes) + " bytes; accepted: 1 to 63");
  if (data_bytes > kDataBytesMax)
    fail(begin, "an event that claims " + std::to_string(data_bytes) + " bytes; accepted: up to 67108864");
  if (left - kHeaderBytes < std::uint64_t{channel_bytes} + data_bytes) {
    take_rest_as_cut(begin);
    return std::nullopt;
  }
  event.channel.resize(channel_bytes);
  event.data.resize(data_bytes);
  stream_.read(event.channel.data(), channel_bytes);
  stream_.read(reinterpret_cast<char*>(event.data.data()), data_bytes);
  if (!stream_) fail(begin, "cannot be read");
  offset_ += kHeaderBytes + channel_bytes + data_bytes;
  return event;
}

}  // namespace vbar::twins
