#pragma once
// UDP port on one IPv4 address: ARP (RFC 826), IPv4 (RFC 791), UDP (RFC 768) and ICMP echo (RFC 792), the subset needed
// for one peer at a time. Independent of hardware: it receives and returns frames.
//
// Every incoming byte may be hostile. A frame is accepted only if its lengths, addresses and checksums agree; all
// others are counted and have no effect. The endpoint never requests an address: it answers to the one from which a
// request came. Fragments are not reassembled (a link frame fits a packet), options are skipped, and frames sent to a
// group address, or from one, are not answered.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"

namespace vbar::boards::zynq7000 {

using MacAddress = std::array<std::uint8_t, 6>;
using Ipv4Address = std::array<std::uint8_t, 4>;

inline constexpr std::size_t kEthernetHeaderBytes = 14;
inline constexpr std::size_t kMinEthernetFrameBytes = 60;    ///< without the check sequence; shorter ones are padded
inline constexpr std::size_t kMaxEthernetFrameBytes = 1514;  ///< without the check sequence
inline constexpr std::size_t kUdpOverheadBytes = kEthernetHeaderBytes + 20 + 8;
inline constexpr std::size_t kMaxDatagramBytes = kMaxEthernetFrameBytes - kUdpOverheadBytes;

/// Sender of a datagram, and destination of its answer.
struct UdpPeer {
  MacAddress mac{};
  Ipv4Address address{};
  std::uint16_t port = 0;
};

/// Result of a frame.
enum class UdpEvent : std::uint8_t {
  kNothing,   ///< not for this endpoint, or rejected
  kReply,     ///< the reply must be sent
  kDatagram,  ///< a datagram for the port
};

struct UdpReceived {
  UdpEvent event = UdpEvent::kNothing;
  std::span<const std::uint8_t> bytes;  ///< kReply: a complete frame, in the caller's buffer; kDatagram: the payload
  UdpPeer from;                         ///< kDatagram
};

struct UdpCounters {
  std::uint32_t datagrams = 0;
  std::uint32_t arp_replies = 0;
  std::uint32_t echo_replies = 0;
  std::uint32_t not_for_us = 0;  ///< other addresses, protocols and ports
  std::uint32_t malformed = 0;   ///< lengths, checksums, fragments, impossible addresses
};

class UdpEndpoint {
 public:
  UdpEndpoint(const MacAddress& mac, const Ipv4Address& address, std::uint16_t port)
      : mac_(mac), address_(address), port_(port) {}

  /// Processes one Ethernet frame (from the destination address to the end of its data, padding allowed, no check
  /// sequence). The answer is written to `reply`, which must not overlap `frame`; an answer that does not fit is not
  /// sent.
  UdpReceived receive(std::span<const std::uint8_t> frame, std::span<std::uint8_t> reply);

  /// Writes the Ethernet frame that carries `payload` to `to`; returns its length. kTooLong if it exceeds
  /// kMaxDatagramBytes or `out` is too small.
  fsw::Result<std::size_t> write_datagram(const UdpPeer& to, std::span<const std::uint8_t> payload,
                                          std::span<std::uint8_t> out);

  [[nodiscard]] const UdpCounters& counters() const { return counters_; }

 private:
  struct Ipv4Packet;
  UdpReceived receive_arp(std::span<const std::uint8_t> frame, std::span<std::uint8_t> reply);
  UdpReceived receive_ipv4(std::span<const std::uint8_t> frame, std::span<std::uint8_t> reply);
  UdpReceived receive_udp(const Ipv4Packet& packet);
  UdpReceived receive_icmp(const Ipv4Packet& packet, std::span<std::uint8_t> reply);
  void write_headers(const MacAddress& to_mac, const Ipv4Address& to, std::uint8_t protocol, std::size_t payload_size,
                     std::span<std::uint8_t> out);
  UdpReceived malformed();
  UdpReceived not_for_us();

  MacAddress mac_;
  Ipv4Address address_;
  std::uint16_t port_;
  std::uint16_t identification_ = 0;
  UdpCounters counters_;
};

}  // namespace vbar::boards::zynq7000
