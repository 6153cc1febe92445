#include "host_sim/twins/lcm_log_writer.h"

#include <array>
#include <cerrno>

#include "fsw/packets/big_endian.h"
#include "host_sim/files/remove_link.h"
#include "host_sim/files/write_error.h"
#include "host_sim/twins/lcm_log_format.h"

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

}  // namespace vbar::twins
