#include "boards/zynq7000/udp_endpoint.h"

#include <algorithm>

namespace vbar::boards::zynq7000 {
namespace {

using Bytes = std::span<const std::uint8_t>;
using MutableBytes = std::span<std::uint8_t>;

constexpr std::uint16_t kTypeIpv4 = 0x0800;
constexpr std::uint16_t kTypeArp = 0x0806;
constexpr std::uint8_t kProtocolIcmp = 1;
constexpr std::uint8_t kProtocolUdp = 17;
constexpr std::size_t kIpv4HeaderBytes = 20;
constexpr std::size_t kUdpHeaderBytes = 8;
constexpr std::size_t kIcmpHeaderBytes = 8;
constexpr std::size_t kArpBytes = 28;
constexpr MacAddress kBroadcastMac{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

std::uint16_t read16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>((static_cast<unsigned>(bytes[at]) << 8) | bytes[at + 1]);
}

void write16(MutableBytes bytes, std::size_t at, std::size_t value) {
  bytes[at] = static_cast<std::uint8_t>((value >> 8) & 0xFFU);
  bytes[at + 1] = static_cast<std::uint8_t>(value & 0xFFU);
}

template <std::size_t kSize>
std::array<std::uint8_t, kSize> read_address(Bytes bytes, std::size_t at) {
  std::array<std::uint8_t, kSize> address{};
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), kSize, address.begin());
  return address;
}

void write_bytes(MutableBytes out, std::size_t at, Bytes bytes) {
  std::copy(bytes.begin(), bytes.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
}

// Sum of 16-bit words for the Internet checksum (RFC 1071), not yet folded; no overflow below 64 KiB.
std::uint32_t add_words(Bytes bytes, std::uint32_t sum = 0) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    sum += read16(bytes, i);
  }
  if (bytes.size() % 2 != 0) {
    sum += static_cast<std::uint32_t>(bytes.back()) << 8;
  }
  return sum;
}

std::uint16_t checksum(std::uint32_t sum) {
  sum = (sum & 0xFFFFU) + (sum >> 16);
  sum = (sum & 0xFFFFU) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum & 0xFFFFU);
}

// The checksum of RFC 768 covers the addresses, the protocol and the length in addition to the datagram itself.
std::uint32_t pseudo_header(const Ipv4Address& source, const Ipv4Address& destination, std::size_t udp_size) {
  return add_words(source) + add_words(destination) + kProtocolUdp + static_cast<std::uint32_t>(udp_size);
}

bool is_group(const MacAddress& mac) {
  return (mac[0] & 1U) != 0U;
}

// Addresses of no single host: this network, loopback, multicast, reserved, broadcast (RFC 6890).
bool cannot_be_a_sender(const Ipv4Address& address) {
  return address[0] == 0 || address[0] == 127 || address[0] >= 224;
}

std::size_t pad(MutableBytes frame, std::size_t size) {
  const std::size_t padded = std::max(size, kMinEthernetFrameBytes);
  for (std::size_t i = size; i < padded; ++i) {
    frame[i] = 0;
  }
  return padded;
}

}  // namespace

struct UdpEndpoint::Ipv4Packet {
  MacAddress source_mac;
  Ipv4Address source;
  std::span<const std::uint8_t> payload;  ///< length according to the header
};

UdpReceived UdpEndpoint::malformed() {
  ++counters_.malformed;
  return {};
}

UdpReceived UdpEndpoint::not_for_us() {
  ++counters_.not_for_us;
  return {};
}

UdpReceived UdpEndpoint::receive(Bytes frame, MutableBytes reply) {
  if (frame.size() < kEthernetHeaderBytes || frame.size() > kMaxEthernetFrameBytes) {
    return malformed();
  }
  const auto destination = read_address<6>(frame, 0);
  if (is_group(read_address<6>(frame, 6))) {
    return malformed();
  }
  switch (read16(frame, 12)) {
    case kTypeArp:
      return destination == mac_ || destination == kBroadcastMac ? receive_arp(frame, reply) : not_for_us();
    case kTypeIpv4:
      return destination == mac_ ? receive_ipv4(frame, reply) : not_for_us();
    default:
      return not_for_us();
  }
}

UdpReceived UdpEndpoint::receive_arp(Bytes frame, MutableBytes reply) {
  const Bytes request = frame.subspan(kEthernetHeaderBytes);
  constexpr std::array<std::uint8_t, 6> kEthernetOverIpv4{0x00, 0x01, 0x08, 0x00, 6, 4};
  constexpr std::uint16_t kRequest = 1;
  constexpr std::uint16_t kReply = 2;
  if (request.size() < kArpBytes || !std::equal(kEthernetOverIpv4.begin(), kEthernetOverIpv4.end(), request.begin())) {
    return malformed();
  }
  if (read16(request, 6) != kRequest || read_address<4>(request, 24) != address_) {
    return not_for_us();
  }
  const auto sender_mac = read_address<6>(request, 8);
  const auto sender = read_address<4>(request, 14);
  // 0.0.0.0 asks whether the address is in use (RFC 5227) and must be answered.
  if (is_group(sender_mac) || sender == address_ || (sender != Ipv4Address{} && cannot_be_a_sender(sender))) {
    return malformed();
  }
  if (reply.size() < kMinEthernetFrameBytes) {
    return {};
  }
  write_bytes(reply, 0, sender_mac);
  write_bytes(reply, 6, mac_);
  write16(reply, 12, kTypeArp);
  write_bytes(reply, 14, kEthernetOverIpv4);
  write16(reply, 20, kReply);
  write_bytes(reply, 22, mac_);
  write_bytes(reply, 28, address_);
  write_bytes(reply, 32, sender_mac);
  write_bytes(reply, 38, sender);
  ++counters_.arp_replies;
  return {UdpEvent::kReply, reply.first(pad(reply, kEthernetHeaderBytes + kArpBytes)), {}};
}

UdpReceived UdpEndpoint::receive_ipv4(Bytes frame, MutableBytes reply) {
  const Bytes packet = frame.subspan(kEthernetHeaderBytes);
  if (packet.size() < kIpv4HeaderBytes || (packet[0] >> 4) != 4U) {
    return malformed();
  }
  const std::size_t header_size = static_cast<std::size_t>(packet[0] & 0xFU) * 4U;
  const std::size_t total_size = read16(packet, 2);
  if (header_size < kIpv4HeaderBytes || total_size < header_size || total_size > packet.size() ||
      checksum(add_words(packet.first(header_size))) != 0) {
    return malformed();
  }
  if (read_address<4>(packet, 16) != address_) {
    return not_for_us();
  }
  constexpr std::uint16_t kMoreFragmentsOrOffset = 0x3FFF;
  const auto source = read_address<4>(packet, 12);
  if ((read16(packet, 6) & kMoreFragmentsOrOffset) != 0 || cannot_be_a_sender(source) || source == address_) {
    return malformed();
  }
  const Ipv4Packet checked{read_address<6>(frame, 6), source, packet.subspan(header_size, total_size - header_size)};
  switch (packet[9]) {
    case kProtocolUdp:
      return receive_udp(checked);
    case kProtocolIcmp:
      return receive_icmp(checked, reply);
    default:
      return not_for_us();
  }
}

UdpReceived UdpEndpoint::receive_udp(const Ipv4Packet& packet) {
  const Bytes datagram = packet.payload;
  if (datagram.size() < kUdpHeaderBytes) {
    return malformed();
  }
  const std::uint16_t source_port = read16(datagram, 0);
  const std::size_t size = read16(datagram, 4);
  if (size < kUdpHeaderBytes || size > datagram.size() || source_port == 0) {
    return malformed();
  }
  if (read16(datagram, 2) != port_) {
    return not_for_us();
  }
  const bool has_checksum = read16(datagram, 6) != 0;
  const std::uint32_t sum = add_words(datagram.first(size), pseudo_header(packet.source, address_, size));
  if (has_checksum && checksum(sum) != 0) {
    return malformed();
  }
  ++counters_.datagrams;
  return {UdpEvent::kDatagram,
          datagram.subspan(kUdpHeaderBytes, size - kUdpHeaderBytes),
          {packet.source_mac, packet.source, source_port}};
}

UdpReceived UdpEndpoint::receive_icmp(const Ipv4Packet& packet, MutableBytes reply) {
  constexpr std::uint8_t kEchoRequest = 8;
  const Bytes request = packet.payload;
  if (request.size() < kIcmpHeaderBytes || checksum(add_words(request)) != 0) {
    return malformed();
  }
  if (request[0] != kEchoRequest || request[1] != 0) {
    return not_for_us();
  }
  const std::size_t frame_size = kEthernetHeaderBytes + kIpv4HeaderBytes + request.size();
  if (reply.size() < std::max(frame_size, kMinEthernetFrameBytes)) {
    return {};
  }
  write_headers(packet.source_mac, packet.source, kProtocolIcmp, request.size(), reply);
  const MutableBytes echo = reply.subspan(kEthernetHeaderBytes + kIpv4HeaderBytes, request.size());
  std::copy(request.begin(), request.end(), echo.begin());
  write16(echo, 0, 0);  // type: echo reply
  write16(echo, 2, 0);
  write16(echo, 2, checksum(add_words(echo)));
  ++counters_.echo_replies;
  return {UdpEvent::kReply, reply.first(pad(reply, frame_size)), {}};
}

void UdpEndpoint::write_headers(const MacAddress& to_mac, const Ipv4Address& to, std::uint8_t protocol,
                                std::size_t payload_size, MutableBytes out) {
  constexpr std::size_t kDontFragment = 0x4000;
  constexpr std::uint8_t kTimeToLive = 64;
  write_bytes(out, 0, to_mac);
  write_bytes(out, 6, mac_);
  write16(out, 12, kTypeIpv4);
  const MutableBytes header = out.subspan(kEthernetHeaderBytes, kIpv4HeaderBytes);
  header[0] = 0x45;
  header[1] = 0;
  write16(header, 2, kIpv4HeaderBytes + payload_size);
  write16(header, 4, identification_++);
  write16(header, 6, kDontFragment);
  header[8] = kTimeToLive;
  header[9] = protocol;
  write16(header, 10, 0);
  write_bytes(header, 12, address_);
  write_bytes(header, 16, to);
  write16(header, 10, checksum(add_words(header)));
}

fsw::Result<std::size_t> UdpEndpoint::write_datagram(const UdpPeer& to, Bytes payload, MutableBytes out) {
  const std::size_t frame_size = kUdpOverheadBytes + payload.size();
  if (payload.size() > kMaxDatagramBytes || out.size() < std::max(frame_size, kMinEthernetFrameBytes)) {
    return fsw::Status::kTooLong;
  }
  const std::size_t udp_size = kUdpHeaderBytes + payload.size();
  write_headers(to.mac, to.address, kProtocolUdp, udp_size, out);
  const MutableBytes datagram = out.subspan(kEthernetHeaderBytes + kIpv4HeaderBytes, udp_size);
  write16(datagram, 0, port_);
  write16(datagram, 2, to.port);
  write16(datagram, 4, udp_size);
  write16(datagram, 6, 0);
  std::copy(payload.begin(), payload.end(), datagram.begin() + kUdpHeaderBytes);
  const std::uint16_t sum = checksum(add_words(datagram, pseudo_header(address_, to.address, udp_size)));
  constexpr std::uint16_t kZeroStandsForNone = 0xFFFF;
  write16(datagram, 6, sum == 0 ? kZeroStandsForNone : sum);
  return pad(out, frame_size);
}

}  // namespace vbar::boards::zynq7000
