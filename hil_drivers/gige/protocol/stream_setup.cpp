#include "hil_drivers/gige/protocol/stream_setup.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hil_drivers/gige/protocol/gvcp.h"
#include "hil_drivers/gige/protocol/gvsp.h"

namespace vbar::gige {

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr std::uint32_t kControlPrivilege = 0xA00;  // readable by all, whoever owns the camera

udp::socket connected(asio::io_context& context, const std::string& address) {
  error_code error;
  const auto peer = asio::ip::make_address_v4(address, error);
  if (error) throw std::invalid_argument("this is not an IPv4 address");
  udp::socket socket(context, udp::v4());
  socket.connect(udp::endpoint(peer, wire::kGvcpPort), error);
  if (error) throw std::runtime_error("no network interface routes to it: " + error.message());
  return socket;
}

bool is_answer(wire::ByteSpan datagram, std::uint16_t id) {
  try {
    return wire::decode_acknowledge(datagram).id == id;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

}  // namespace

std::string routing_address(const std::string& address) {
  asio::io_context context;
  return connected(context, address).local_endpoint().address().to_string();
}

bool camera_answers(const std::string& address, int tries, std::chrono::milliseconds wait) {
  asio::io_context context;
  udp::socket socket = connected(context, address);
  socket.non_blocking(true);
  std::array<std::uint8_t, 1024> buffer{};
  for (int attempt = 1; attempt <= tries; ++attempt) {
    const auto id = static_cast<std::uint16_t>(attempt);
    error_code error;
    socket.send(asio::buffer(wire::encode_command({true, id, wire::ReadRegisters{{kControlPrivilege}}})), 0, error);
    const auto deadline = std::chrono::steady_clock::now() + wait;
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) break;
      pollfd ready{socket.native_handle(), POLLIN, 0};
      if (::poll(&ready, 1, static_cast<int>(left.count())) <= 0) break;
      const std::size_t n = socket.receive(asio::buffer(buffer), 0, error);
      // A port without a program reports itself as an error: the next attempt waits for a camera that starts.
      if (!error && is_answer(wire::ByteSpan(buffer).first(n), id)) return true;
    }
  }
  return false;
}

namespace {

/// A receiver on a busy computer is not run for this long.
constexpr double kReceiverPauseNs = 10e6;
/// Share of the buffer that is usable while the receiver reads: the kernel gives back what was read only when it is a
/// quarter of the buffer or the queue is empty (Linux, net/ipv4/udp.c, udp_rmem_release; measured: 0.75 of the packets
/// at 416 KiB to 8 MiB).
constexpr double kUsableShare = 0.75;
constexpr std::size_t kSharedInfoBytes = 320, kDescriptorBytes = 256, kHeadroomBytes = 64;  // Linux, 64 bits

}  // namespace

SocketBuffer granted_socket_buffer(std::size_t bytes) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "a UDP socket");
  const int wanted = static_cast<int>(bytes);
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  int granted = 0;
  socklen_t size = sizeof granted;
  const int result = ::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  const int error = errno;
  ::close(fd);
  if (result != 0) throw std::system_error(error, std::generic_category(), "the buffer of a UDP socket");
  return {bytes, static_cast<std::size_t>(granted)};
}

std::size_t bytes_in_buffer(std::size_t packet_size) {
  return std::bit_ceil(packet_size + kHeadroomBytes + kSharedInfoBytes) + kDescriptorBytes;
}

std::size_t packets_of_image(std::size_t image_bytes, std::size_t packet_size) {
  const std::size_t data_bytes = packet_size - wire::kPacketOverheadBytes;
  return (image_bytes + data_bytes - 1) / data_bytes + 2;  // leader and trailer
}

std::size_t wanted_socket_buffer(std::size_t image_bytes, std::size_t packet_size) {
  const auto bytes = static_cast<double>(packets_of_image(image_bytes, packet_size) * bytes_in_buffer(packet_size));
  return static_cast<std::size_t>(std::ceil(bytes / kUsableShare / 2.0));
}

double packet_delay_ns(const SocketBuffer& buffer, std::size_t image_bytes, std::size_t packet_size) {
  const std::size_t packets = packets_of_image(image_bytes, packet_size);
  const double capacity =
      kUsableShare * static_cast<double>(buffer.granted_bytes) / static_cast<double>(bytes_in_buffer(packet_size));
  if (capacity >= static_cast<double>(packets)) return 0.0;
  return kReceiverPauseNs / std::max(capacity, 1.0);
}

std::string description(const SocketBuffer& buffer, double delay_ns, std::size_t packet_size) {
  const std::string got = fmt::format("the socket buffer is {} KiB ({} KiB requested)", buffer.granted_bytes / 1024,
                                      buffer.requested_bytes / 1024);
  if (delay_ns == 0.0) return got + ", which holds an image: packets follow without a pause";
  return got + fmt::format(": a packet every {:.0f} us, {:.0f} MB/s (net.core.rmem_max limits the buffer)",
                           1e-3 * delay_ns, 1e3 * static_cast<double>(packet_size) / delay_ns);
}

PixelPadding::PixelPadding(int expected_bits) : expected_bits_(expected_bits) {}

void PixelPadding::observe(std::span<const std::uint16_t> pixels) {
  std::uint16_t set_bits = set_bits_;
  for (const std::uint16_t pixel : pixels) set_bits |= pixel;
  set_bits_ = set_bits;
  for (std::size_t k = 0; k < pixels.size() && !is_decided(); ++k) {
    if (seen_.test(pixels[k])) continue;
    seen_.set(pixels[k]);
    ++values_;
  }
}

int PixelPadding::shift() const {
  const int expected = 16 - expected_bits_;
  const int zeros = std::countr_zero(set_bits_);  // 16 if no bit was ever set
  // Bits below the expected padding are real, whatever the number of values.
  if (zeros < expected) {
    // Numbers of the expected converter that are right-aligned.
    if (set_bits_ < (1U << expected_bits_)) return 0;
    return zeros / 2 * 2;
  }
  if (!is_decided()) return expected;
  // Converters have an even number of bits, 8 or more.
  return std::min(zeros, 8) / 2 * 2;
}

int PixelPadding::bits() const {
  const int found = shift();
  if (found == 0 && set_bits_ < (1U << expected_bits_)) return expected_bits_;
  return 16 - found;
}

}  // namespace vbar::gige
