#pragma once
// Delay between packets with which the receiving socket's buffer does not overflow.

#include <cstddef>
#include <string>

namespace vbar::gige {

struct SocketBuffer {
  std::size_t requested_bytes = 0;
  std::size_t granted_bytes = 0;  ///< as the kernel counts: payload and its own overhead
};

/// Returns what the kernel of this computer grants a UDP socket that asks for `bytes` (net.core.rmem_max limits it).
/// Throws std::system_error if there is no socket.
[[nodiscard]] SocketBuffer granted_socket_buffer(std::size_t bytes);

/// Returns the size of a packet in the buffer, as the kernel counts: data and headers in a power of two, and the
/// descriptor.
[[nodiscard]] std::size_t bytes_in_buffer(std::size_t packet_size);

[[nodiscard]] std::size_t packets_of_image(std::size_t image_bytes, std::size_t packet_size);

/// Returns the size to ask the kernel for, which doubles it, so that images need no pauses.
[[nodiscard]] std::size_t wanted_socket_buffer(std::size_t image_bytes, std::size_t packet_size);

/// Returns nanoseconds between packets of `packet_size`: zero if the buffer holds the whole image although the receiver
/// has just read another, otherwise such that it holds what arrives while the receiver does not run for 10 ms.
[[nodiscard]] double packet_delay_ns(const SocketBuffer& buffer, std::size_t image_bytes, std::size_t packet_size);

/// Returns one sentence for the log.
[[nodiscard]] std::string description(const SocketBuffer& buffer, double delay_ns, std::size_t packet_size);

}  // namespace vbar::gige
