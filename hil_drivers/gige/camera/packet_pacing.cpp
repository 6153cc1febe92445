#include "hil_drivers/gige/camera/packet_pacing.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hil_drivers/gige/wire/gvsp.h"

namespace vbar::gige {
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

}  // namespace vbar::gige
