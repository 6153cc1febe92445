#pragma once
// The pause between packets that the receiving socket's buffer stands.

#include <cstddef>
#include <string>

namespace vbar::gige {

struct SocketBuffer {
  std::size_t requested_bytes = 0;
  std::size_t granted_bytes = 0;  ///< as the kernel counts: payload and its own overhead
};

/// What the kernel of this computer grants a UDP socket that asks for `bytes` (net.core.rmem_max limits it). Throws
/// std::system_error if there is no socket.
[[nodiscard]] SocketBuffer granted_socket_buffer(std::size_t bytes);

/// Returns the size of a packet in the buffer, as the kernel counts: data and headers in a power of two, and the
/// descriptor.
[[nodiscard]] std::size_t bytes_in_buffer(std::size_t packet_size);

[[nodiscard]] std::size_t packets_of_image(std::size_t image_bytes, std::size_t packet_size);

/// What the kernel, which doubles it, is to be asked for so that images need no pauses.
[[nodiscard]] std::size_t wanted_socket_buffer(std::size_t image_bytes, std::size_t packet_size);

/// Nanoseconds between packets of `packet_size`: none if the buffer holds the whole image although the receiver has
/// just read another, otherwise such that it holds what arrives while the receiver does not run for 10 ms.
[[nodiscard]] double packet_delay_ns(const SocketBuffer& buffer, std::size_t image_bytes, std::size_t packet_size);

/// One sentence for the log.
[[nodiscard]] std::string description(const SocketBuffer& buffer, double delay_ns, std::size_t packet_size);

}  // namespace vbar::gige
