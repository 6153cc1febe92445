#include "host_sim/report/output_hash.h"

#include "fsw/packets/big_endian.h"
#include "fsw/packets/packet.h"

namespace vbar::report {

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
