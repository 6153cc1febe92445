#pragma once
// Ethernet frames for tests: some that another implementation sent, and a plain builder for the rest.

#include <cstdint>
#include <span>
#include <vector>

#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::test {

using Frame = std::vector<std::uint8_t>;

inline constexpr boards::zynq7000::MacAddress kBoardMac{0x02, 0x76, 0x62, 0x61, 0x72, 0x15};
inline constexpr boards::zynq7000::Ipv4Address kBoardAddress{10, 0, 2, 15};
inline constexpr std::uint16_t kBoardPort = 5000;
inline constexpr boards::zynq7000::MacAddress kHostMac{0x52, 0x55, 0x0a, 0x00, 0x02, 0x02};
inline constexpr boards::zynq7000::Ipv4Address kHostAddress{10, 0, 2, 2};

/// ARP request for 10.0.2.15, as QEMU's user network (libslirp 4.7) sent it.
inline Frame recorded_arp_request() {
  return {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x08, 0x06, 0x00,
          0x01, 0x08, 0x00, 0x06, 0x04, 0x00, 0x01, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x0a, 0x00,
          0x02, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x02, 0x0f, 0x00, 0x00, 0x00,
          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
}

/// A datagram of 19 bytes from 10.0.2.2:40776 to 10.0.2.15:5000, likewise.
inline Frame recorded_datagram() {
  return {0x02, 0x76, 0x62, 0x61, 0x72, 0x15, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x08, 0x00, 0x45, 0x00,
          0x00, 0x2f, 0x00, 0x00, 0x00, 0x00, 0x40, 0x11, 0x62, 0xae, 0x0a, 0x00, 0x02, 0x02, 0x0a, 0x00,
          0x02, 0x0f, 0x9f, 0x48, 0x13, 0x88, 0x00, 0x1b, 0xab, 0x4b, 0x01, 0x01, 0x00, 0x00, 0x00, 0x0c,
          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x61, 0xe9, 0x1c, 0x9e};
}

inline void append16(Frame& frame, std::size_t value) {
  frame.push_back(static_cast<std::uint8_t>(value >> 8U));
  frame.push_back(static_cast<std::uint8_t>(value));
}

inline void set16(Frame& frame, std::size_t at, std::size_t value) {
  frame[at] = static_cast<std::uint8_t>(value >> 8U);
  frame[at + 1] = static_cast<std::uint8_t>(value);
}

/// The Internet checksum by another road than the code's: ones' complement addition is addition modulo 65535, here in
/// one 64-bit sum.
inline std::uint16_t reference_checksum(std::span<const std::uint8_t> bytes, std::uint64_t sum = 0) {
  for (std::size_t i = 0; i < bytes.size(); ++i) sum += std::uint64_t{bytes[i]} * (i % 2 == 0 ? 256U : 1U);
  const std::uint64_t folded = sum == 0 ? 0 : (sum - 1) % 65535 + 1;
  return static_cast<std::uint16_t>(65535 - folded);
}

inline std::uint64_t pseudo_header_sum(const boards::zynq7000::Ipv4Address& a, const boards::zynq7000::Ipv4Address& b,
                                       std::size_t udp_size) {
  const auto words = [](const boards::zynq7000::Ipv4Address& x) {
    return std::uint64_t{x[0]} * 256 + x[1] + std::uint64_t{x[2]} * 256 + x[3];
  };
  return words(a) + words(b) + 17 + udp_size;
}

/// What a test may want wrong about an IPv4 packet from the host to the board.
struct Ipv4Options {
  boards::zynq7000::MacAddress destination_mac = kBoardMac;
  boards::zynq7000::MacAddress source_mac = kHostMac;
  boards::zynq7000::Ipv4Address source = kHostAddress;
  boards::zynq7000::Ipv4Address destination = kBoardAddress;
  std::uint8_t protocol = 17;
  std::uint16_t fragment = 0;
  std::size_t option_words = 0;
};

inline Frame ipv4_frame(std::span<const std::uint8_t> payload, const Ipv4Options& options = {}) {
  Frame frame(options.destination_mac.begin(), options.destination_mac.end());
  frame.insert(frame.end(), options.source_mac.begin(), options.source_mac.end());
  append16(frame, 0x0800);
  const std::size_t header_size = 20 + 4 * options.option_words;
  frame.push_back(static_cast<std::uint8_t>(0x40U | (header_size / 4)));
  frame.push_back(0);
  append16(frame, header_size + payload.size());
  append16(frame, 1);
  append16(frame, options.fragment);
  frame.push_back(64);
  frame.push_back(options.protocol);
  append16(frame, 0);
  frame.insert(frame.end(), options.source.begin(), options.source.end());
  frame.insert(frame.end(), options.destination.begin(), options.destination.end());
  frame.insert(frame.end(), 4 * options.option_words, 1);  // no operation
  set16(frame, 24, reference_checksum(std::span(frame).subspan(14, header_size)));
  frame.insert(frame.end(), payload.begin(), payload.end());
  return frame;
}

inline Frame udp(std::span<const std::uint8_t> payload, const Ipv4Options& options = {}, std::uint16_t from = 40000,
                 std::uint16_t to = kBoardPort) {
  Frame datagram;
  append16(datagram, from);
  append16(datagram, to);
  append16(datagram, 8 + payload.size());
  append16(datagram, 0);
  datagram.insert(datagram.end(), payload.begin(), payload.end());
  const std::uint16_t sum =
      reference_checksum(datagram, pseudo_header_sum(options.source, options.destination, datagram.size()));
  set16(datagram, 6, sum == 0 ? 0xFFFF : sum);
  return datagram;
}

}  // namespace vbar::test
