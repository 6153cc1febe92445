#include "host_sim/app/changed_telecommands.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "fsw/packets/message_traits.h"
#include "fsw/packets/packet.h"

namespace vbar::app {
namespace {

using fsw::packets::Apid;
using fsw::packets::PacketView;

/// Telecommands that the flight software accepts in any step; the others initialise it.
constexpr std::array kInFlight{Apid::kGncConfiguration, Apid::kWaypointTable, Apid::kModeCommand,
                               Apid::kSafetyConfiguration};

/// Parses a telecommand of this program, which is whole.
PacketView view_of(const twins::Packet& packet) {
  return fsw::packets::parse_packet(packet).value();
}

bool is_for_same(const PacketView& a, const PacketView& b) {
  return a.header.apid == b.header.apid && a.header.unit == b.header.unit;
}

std::string name_of(const PacketView& view) {
  return fsw::packets::message_name(view.header.apid);
}

twins::Packet dated(const PacketView& view, fsw::GpsTime time) {
  fsw::packets::PacketHeader header = view.header;
  header.time = time;
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::write_packet(header, view.payload, packet).value());
  return packet;
}

}  // namespace

std::vector<twins::Packet> changed_telecommands(const std::vector<twins::Packet>& sent,
                                                const std::vector<twins::Packet>& wanted, fsw::GpsTime time) {
  const auto same_in = [](const std::vector<twins::Packet>& packets, const PacketView& view) {
    return std::ranges::find_if(packets, [&](const twins::Packet& one) { return is_for_same(view_of(one), view); });
  };
  for (const twins::Packet& packet : sent)
    if (const PacketView view = view_of(packet); same_in(wanted, view) == wanted.end())
      throw std::runtime_error("it takes back the telecommand " + name_of(view) + ", which was sent");
  std::vector<twins::Packet> changed;
  for (const twins::Packet& packet : wanted) {
    const PacketView view = view_of(packet);
    const auto before = same_in(sent, view);
    if (before != sent.end() && std::ranges::equal(view_of(*before).payload, view.payload)) continue;
    if (std::ranges::find(kInFlight, view.header.apid) == kInFlight.end())
      throw std::runtime_error("it changes the telecommand " + name_of(view) +
                               ", which is given before the first step");
    changed.push_back(dated(view, time));
  }
  return changed;
}

}  // namespace vbar::app
