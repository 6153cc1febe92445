#pragma once
// Gigabit Ethernet controller 0 (Cadence GEM, UG585 chapter 16): complete frames in and out of buffer rings that its
// DMA shares with the processor in uncached memory.
//
// Receive ring full: the controller drops the newest frames and counts them. Transmit ring full: a frame is dropped
// after a bounded wait, and counted. Frames in a ring are never overwritten.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "boards/zynq7000/phy.h"
#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::boards::zynq7000 {

class Ethernet {
 public:
  /// Initialises the controller and detects the PHY. Without a PHY, no frame is ever received.
  void open(const MacAddress& mac);

  /// Returns true if there is a PHY that had no link at the last check: `link_came_up` must then be called repeatedly.
  [[nodiscard]] bool waits_for_link() const { return phy_.has_value() && !link_.has_value(); }
  /// Reads the PHY, and sets the rate of the controller once there is a link. The rate is kept until the next start.
  bool link_came_up();

  /// Copies the oldest received frame to `frame` and returns its length; 0 if there is none.
  std::size_t receive(std::span<std::uint8_t> frame);
  [[nodiscard]] bool has_input() const;

  void send(std::span<const std::uint8_t> frame);

  /// Number of receive-ring overruns; of corrupted or too long frames; of frames not sent.
  [[nodiscard]] std::uint32_t receive_overruns() const { return receive_overruns_; }
  [[nodiscard]] std::uint32_t frames_broken() const { return frames_broken_; }
  [[nodiscard]] std::uint32_t sends_dropped() const { return sends_dropped_; }

 private:
  static void on_interrupt(void* self);
  void release_received();

  std::optional<Phy> phy_;
  std::optional<PhyLink> link_;
  std::size_t next_receive_ = 0;
  std::size_t next_send_ = 0;
  std::uint32_t receive_overruns_ = 0;
  std::uint32_t frames_broken_ = 0;
  std::uint32_t sends_dropped_ = 0;
};

}  // namespace vbar::boards::zynq7000
