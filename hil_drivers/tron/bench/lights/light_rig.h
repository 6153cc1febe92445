#pragma once
// Lamp and boxes of the emulator as they really are: the light of each at a value, and the place of the lamp
// on its arc.

#include <array>
#include <cstdint>
#include <string_view>

#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

/// Holds values in the order of the slots: lamp power, lamp place, boxes.
using LightValues = std::array<std::uint16_t, 2 + kBoxes>;

/// Describes the light of a source at a share v of its largest value: gain v^gamma, relative to full power as designed.
struct LightErrorSizes {
  double gamma = 2.2;          ///< mean over the sources
  double gamma_spread = 0.15;  ///< standard deviation over the sources
  double gain_spread = 0.03;

  /// Returns sizes with light proportional to the value.
  [[nodiscard]] static LightErrorSizes none() { return {1.0, 0.0, 0.0}; }
};

/// Describes a key of the table [lights] of the emulator.
struct LightErrorKey {
  std::string_view key;
  double LightErrorSizes::*size;
  double smallest, largest;
};

inline constexpr std::array<LightErrorKey, 3> kLightErrorKeys{{
    {"gamma", &LightErrorSizes::gamma, 0.2, 5.0},
    {"gamma_spread", &LightErrorSizes::gamma_spread, 0.0, 1.0},
    {"gain_spread", &LightErrorSizes::gain_spread, 0.0, 0.3},
}};

struct TrueLights {
  double lamp_power = 0.0;  ///< light, not the DMX value; relative to full power as designed
  double lamp_azimuth_rad = 0.0;
  std::array<double, kBoxes> box_power{};
};

class LightRig {
 public:
  /// Begins with the lamp in the middle of its arc and all lights off.
  LightRig(const Lamp& lamp, const LightErrorSizes& sizes, std::uint64_t seed);

  /// Sets values: powers take effect at once; the lamp begins to move.
  void command(const LightValues& values);
  /// Sets all powers to zero; the lamp stays where it is.
  void switch_off();
  /// Moves the lamp until that time.
  void advance(double bench_s);

  // Set faults, until they are reset.
  void set_lamp_out(bool is_out) { is_lamp_out_ = is_out; }
  void set_box_out(std::size_t box, bool is_out) { is_box_out_.at(box) = is_out; }

  [[nodiscard]] TrueLights lights() const;

 private:
  struct Response {
    double gain = 1.0, gamma = 1.0;
    [[nodiscard]] double light(std::uint16_t value) const;
  };
  static constexpr std::size_t kLamp = 0, kPlace = 1, kFirstBox = 2;

  Lamp lamp_;
  std::array<Response, 1 + kBoxes> responses_;  ///< lamp, boxes
  LightValues values_{};
  double azimuth_rad_, wanted_azimuth_rad_;
  double time_s_ = 0.0;
  bool is_lamp_out_ = false;
  std::array<bool, kBoxes> is_box_out_{};
};

}  // namespace vbar::tron::bench
