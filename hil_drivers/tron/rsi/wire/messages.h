#pragma once
// Documents of KUKA's RobotSensorInterface, one a datagram: <Rob> from the controller every cycle of 4 ms, <Sen> back.
// Values as on the wire: degrees, millimetres, milliseconds.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace vbar::tron::rsi {

inline constexpr std::size_t kWireAxes = 6;
inline constexpr double kCycle_s = 0.004;  ///< #IPO_FAST
inline constexpr std::uint64_t kCycle_ms = 4;
/// Number of bytes of a datagram that a decoder accepts; answers have less than 1,024 bytes.
inline constexpr std::size_t kMaxDatagramBytes = 65536;
inline constexpr std::size_t kMaxAnswerBytes = 1023;

using SixValues = std::array<double, kWireAxes>;

/// Holds the time stamp that the controller gives to a cycle. The answer repeats its text; only the controller makes
/// one.
struct Ipoc {
  std::string text = "0";
  std::uint64_t value = 0;
};

/// Holds the state of the robot in one cycle.
struct Rob {
  SixValues cartesian{};    ///< RIst: X Y Z in mm, A B C in deg (about z, y', x''), of the flange in the base
  SixValues axes_deg{};     ///< AIPos: A1 to A6 as measured by the motors
  SixValues external_mm{};  ///< EIPos: E1 to E6
  std::uint64_t delay = 0;  ///< cycles since RSI_ON without a valid answer
  Ipoc ipoc;
};

/// Holds the answer of the computer. A value that it leaves out keeps its last value (HOLDON 1) or falls to zero
/// (HOLDON 0).
struct Sen {
  std::string type;
  std::optional<bool> stop;
  std::array<std::optional<double>, kWireAxes> axes_deg{};  ///< corrections, absolute to the pose at RSI_ON
  std::optional<double> track_mm;
  std::string ipoc;  ///< as received
};

}  // namespace vbar::tron::rsi
