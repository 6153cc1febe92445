// Shows what the flight software's wire formats look like to programs that others wrote.
//   vbar_wire_tool checksums        stdin: a hex string a line   stdout: "crc16 crc32" of its bytes, decimal
//   vbar_wire_tool cobs-encode      stdin: a hex string a line   stdout: its COBS image, zero included, hex
//   vbar_wire_tool cobs-decode      stdin: a hex string a line   stdout: the frames in it, hex, separated by blanks
//   vbar_wire_tool reencode         stdin: a packet a line       stdout: the packet, decoded to its message and encoded
//   again vbar_wire_tool packets          stdout: example packets with their fields, JSON vbar_wire_tool segments
//   stdin: a hex string a line   stdout: packets that carry its bytes as segments, hex

#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "fsw/link/frame.h"
#include "fsw/packets/crc.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/segmentation.h"

namespace {

namespace packets = vbar::fsw::packets;
namespace link = vbar::fsw::link;
using Bytes = std::vector<std::uint8_t>;
using Json = nlohmann::json;

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

template <class T>
T unwrapped(const vbar::fsw::Result<T>& result) {
  if (!result.ok()) throw std::runtime_error("status " + std::to_string(static_cast<int>(result.status())));
  return result.value();
}

std::string checksums(const Bytes& bytes) {
  return std::to_string(packets::crc16_ccitt_false(bytes)) + ' ' + std::to_string(packets::crc32_ieee(bytes));
}

std::string cobs_encode(const Bytes& bytes) {
  Bytes out(link::kMaxCobsFrameBytes);
  out.resize(unwrapped(link::cobs_encode(bytes, out)));
  return to_hex(out);
}

std::string cobs_decode(const Bytes& stream) {
  link::CobsDecoder decoder;
  std::string frames;
  for (const std::uint8_t byte : stream) {
    if (decoder.push(byte)) frames += (frames.empty() ? "" : " ") + to_hex(decoder.frame());
  }
  return frames;
}

template <class Message>
Bytes encoded(const packets::PacketHeader& header, const Message& message) {
  Bytes out(packets::kMaxPacketBytes);
  out.resize(unwrapped(packets::encode(header, message, out)));
  return out;
}

std::string reencode(const Bytes& bytes) {
  const packets::PacketView packet = unwrapped(packets::parse_packet(bytes));
  Bytes again;
  packets::for_each_message([&]<class Message>() {
    if (packets::MessageTraits<Message>::kApid != packet.header.apid) return;
    again = encoded(packet.header, unwrapped(packets::decode<Message>(packet)));
  });
  return to_hex(again);
}

std::string segments(const Bytes& bytes) {
  packets::PacketHeader header;
  header.apid = packets::Apid::kIdealNavigation;
  header.sequence_count = 0x3FFF;
  packets::Segmenter segmenter(header, bytes);
  std::string lines;
  while (!segmenter.done()) {
    Bytes out(packets::kMaxPacketBytes);
    out.resize(unwrapped(segmenter.next(out)));
    lines += (lines.empty() ? "" : " ") + to_hex(out);
  }
  return lines;
}

template <class Message>
Json example(const packets::PacketHeader& header, const Message& message, const Json& fields) {
  return {{"packet", to_hex(encoded(header, message))},
          {"message", Message::getTypeName()},
          {"apid", static_cast<int>(packets::MessageTraits<Message>::kApid)},
          {"sequence_count", header.sequence_count},
          {"time_ns", header.time.ns},
          {"spacecraft", header.spacecraft},
          {"unit", header.unit},
          {"fields", fields}};
}

packets::PacketHeader header_of(std::uint16_t count, std::int64_t time_ns, std::uint8_t spacecraft, std::uint8_t unit) {
  packets::PacketHeader header;
  header.sequence_count = count;
  header.time.ns = time_ns;
  header.spacecraft = spacecraft;
  header.unit = unit;
  return header;
}

Json example_packets() {
  Json all = Json::array();
  vbar::tick tick{};
  tick.step = 42;
  tick.period_ns = 10'000'000'000;
  all.push_back(example(header_of(0, 1'400'000'000'123'456'789, 1, 0), tick,
                        {{"step", tick.step}, {"period_ns", tick.period_ns}}));

  vbar::executed_maneuver executed{};
  executed.maneuver_id = -7;
  executed.accepted = 1;
  executed.dv_rtn[0] = 0.001;
  executed.dv_rtn[1] = -2.5e-3;
  executed.dv_rtn[2] = 1e-300;
  all.push_back(
      example(header_of(0x3FFF, -1, 255, 7), executed,
              {{"maneuver_id", executed.maneuver_id}, {"accepted", executed.accepted}, {"dv_rtn", executed.dv_rtn}}));

  vbar::waypoint_table table{};
  table.count = 2;
  table.reference_semi_major_axis_m = 6'945'000.25;
  Json waypoints = Json::array();
  for (int i = 0; i < 16; ++i) {
    vbar::waypoint& waypoint = table.waypoints[i];
    waypoint.index = i;
    waypoint.control_mode = static_cast<std::int8_t>(-i);
    waypoint.gps_time_ns = std::int64_t{1'000'000'007} * (i + 1) * (i % 2 == 0 ? 1 : -1);
    for (int k = 0; k < 6; ++k) waypoint.a_roe_m[k] = -1.5 * i + 0.1 * k;
    waypoints.push_back({{"index", waypoint.index},
                         {"control_mode", waypoint.control_mode},
                         {"gps_time_ns", waypoint.gps_time_ns},
                         {"a_roe_m", waypoint.a_roe_m}});
  }
  all.push_back(example(header_of(5, 0, 0, 0), table,
                        {{"count", table.count},
                         {"reference_semi_major_axis_m", table.reference_semi_major_axis_m},
                         {"waypoints", waypoints}}));

  vbar::step_report report{};
  report.step = 3;
  report.unit = 2;
  report.count = 123'456'789'012;
  report.stack_bytes = 15'000;
  report.frames_resent = 9;
  all.push_back(example(header_of(0x1234, 10'000'000'000, 2, 1), report,
                        {{"step", report.step},
                         {"unit", report.unit},
                         {"count", report.count},
                         {"stack_bytes", report.stack_bytes},
                         {"frames_resent", report.frames_resent},
                         {"ticks_missing", report.ticks_missing}}));
  return all;
}

Json apids() {
  Json all = Json::object();
  packets::for_each_message(
      [&]<class Message>() { all[Message::getTypeName()] = static_cast<int>(packets::MessageTraits<Message>::kApid); });
  return all;
}

template <class Function>
void for_each_line(Function function) {
  std::string line;
  while (std::getline(std::cin, line)) std::cout << function(from_hex(line)) << '\n';
}

int run(const std::string& what) {
  if (what == "checksums") {
    for_each_line(checksums);
  } else if (what == "cobs-encode") {
    for_each_line(cobs_encode);
  } else if (what == "cobs-decode") {
    for_each_line(cobs_decode);
  } else if (what == "reencode") {
    for_each_line(reencode);
  } else if (what == "segments") {
    for_each_line(segments);
  } else if (what == "packets") {
    std::cout << example_packets().dump() << '\n';
  } else if (what == "apids") {
    std::cout << apids().dump() << '\n';
  } else {
    std::cerr << "vbar_wire_tool checksums | cobs-encode | cobs-decode | reencode | segments | packets | apids\n";
    return 2;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) try { return run(argc == 2 ? argv[1] : ""); } catch (const std::exception& error) {
  std::cerr << "vbar_wire_tool: " << error.what() << '\n';
  return 1;
}
