#include "host_sim/report/provenance.h"

#include <utility>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/packet.h"
#include "host_sim/files/data_stream.h"

namespace vbar::report {

std::optional<FileDigest> digest_of(const std::filesystem::path& file) {
  auto sha256 = files::sha256_of_file(file);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (!sha256 || error) return std::nullopt;
  return FileDigest{file.string(), bytes, std::move(*sha256)};
}

using fsw::packets::Apid;

void OutputHash::add(std::span<const std::uint8_t> packet) {
  if (packet.size() < 2) return;
  constexpr std::uint16_t kApidBits = 0x07FF;
  const auto apid = static_cast<Apid>(fsw::packets::read_big_endian<std::uint16_t>(packet, 0) & kApidBits);
  if (apid == Apid::kManeuverCommand) commands_.add(packet);
  if (fsw::packets::is_telemetry(apid)) telemetry_.add(packet);
}

std::string OutputHash::commands_sha256() const {
  return commands_.hexadecimal();
}
std::string OutputHash::telemetry_sha256() const {
  return telemetry_.hexadecimal();
}

}  // namespace vbar::report
