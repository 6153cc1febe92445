#include "host_sim/flown_gnss/logged_receiver.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::flown_gnss {

LoggedReceiver::LoggedReceiver(const std::filesystem::path& log, std::uint8_t number, fsw::Duration period)
    : period_(period) {
  for (const twins::PacketRecord& record : twins::read_packet_log(log).records) {
    if (!record.to_flight || record.packet.empty()) continue;
    const auto packet = fsw::packets::parse_packet(record.packet);
    if (!packet.ok() || packet.value().header.spacecraft != number) continue;
    const auto message = fsw::packets::decode<gnss_bytes>(packet.value());
    if (!message.ok()) continue;
    constexpr auto kCapacity = static_cast<std::int32_t>(sizeof message.value().data);
    const auto count = std::clamp<std::int32_t>(message.value().count, 0, kCapacity);
    std::vector<std::uint8_t>& bytes = bytes_[packet.value().header.time];
    bytes.insert(bytes.end(), message.value().data, message.value().data + count);
  }
  if (bytes_.empty())
    throw std::runtime_error(
        fmt::format("{}: found no bytes of a receiver of spacecraft {}, expected packets of type gnss_bytes",
                    log.string(), number));
}

twins::gnss::ReceiverOutput LoggedReceiver::output_at(const twins::gnss::BodyTruth& truth) {
  twins::gnss::ReceiverOutput output;
  const auto end = bytes_.lower_bound(truth.time + period_);
  for (auto one = bytes_.lower_bound(truth.time); one != end; ++one)
    output.bytes.insert(output.bytes.end(), one->second.begin(), one->second.end());
  return output;
}

}  // namespace vbar::flown_gnss
