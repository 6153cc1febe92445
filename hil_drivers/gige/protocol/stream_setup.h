#pragma once
// Check that a camera answers at all, faster than by the repeated commands of Aravis (2.5 s each).

#include <bitset>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace vbar::gige {

/// Returns the address of this computer that routes to `address` (IPv4); nothing is sent. Throws std::invalid_argument
/// for a text that is not an address, std::runtime_error without a route.
[[nodiscard]] std::string routing_address(const std::string& address);

/// Asks for a register (GVCP, to this address only), `tries` times with `wait` for an acknowledge, whatever its status.
[[nodiscard]] bool camera_answers(const std::string& address, int tries, std::chrono::milliseconds wait);

// Delay between packets with which the receiving socket's buffer does not overflow.

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

// Place of a converter's numbers in 16-bit pixels. Cameras put them left-aligned (12 bits: FFF0h), and the number of
// bits the converter has depends on the camera's mode: the padding is found in the data.

class PixelPadding {
 public:
  /// Starts with a converter of `expected_bits`, left-aligned, until the data decide.
  explicit PixelPadding(int expected_bits);

  /// Takes the raw pixels of an image into account.
  void observe(std::span<const std::uint16_t> pixels);

  /// Returns the number of bits of the converter.
  [[nodiscard]] int bits() const;
  /// Returns the shift: right-aligned number = pixel >> shift().
  [[nodiscard]] int shift() const;
  /// Returns false while the pixels seen have too few values to exclude an accident.
  [[nodiscard]] bool is_decided() const { return values_ >= kDecidingValues; }

 private:
  // Number of different values. That all of them are multiples of four by accident has a probability of 4^-16.
  static constexpr std::size_t kDecidingValues = 16;

  int expected_bits_;
  std::uint16_t set_bits_ = 0;
  std::bitset<65536> seen_;
  std::size_t values_ = 0;
};

}  // namespace vbar::gige
