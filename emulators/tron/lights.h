#pragma once
// Lamp and boxes of the emulator as they really are: the light of each at a value, and the place of the lamp
// on its arc.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/sacn.h"

namespace vbar::tron::bench {

// Choice of the source of sACN that controls the lights, by the rules of ANSI E1.31-2018: priority (6.2.3), sequence
// (6.7.2), termination (6.2.6) and loss of a source (6.7.1). Of sources of the same priority the one that was first
// controls. Time is bench time.

struct SourceCounts {
  std::uint64_t accepted = 0;
  std::uint64_t unreadable = 0;
  std::uint64_t of_other_universes = 0;
  std::uint64_t previews = 0;
  std::uint64_t of_other_start_codes = 0;
  std::uint64_t out_of_sequence = 0;
  std::uint64_t refused_sources = 0;  ///< packets of sources beyond kMaxSources
  std::uint64_t terminations = 0;
  std::uint64_t losses = 0;  ///< sources that fell silent
};

class SourceArbiter {
 public:
  static constexpr double kLossSeconds = 2.5;
  static constexpr std::size_t kMaxSources = 16;

  explicit SourceArbiter(std::uint16_t universe) : universe_(universe) {}

  void accept(const sacn::DataPacket& packet, double bench_s);
  void count_unreadable() { ++counts_.unreadable; }
  /// Drops sources that are silent.
  void advance(double bench_s);

  /// Returns the slots of the source that controls; empty if there is none.
  [[nodiscard]] std::span<const std::uint8_t> slots() const;
  [[nodiscard]] bool is_controlled() const { return !sources_.empty(); }
  [[nodiscard]] const SourceCounts& counts() const { return counts_; }

 private:
  struct Source {
    sacn::Cid cid{};
    std::uint8_t priority = 0, sequence = 0;
    double heard_s = 0.0;
    std::vector<std::uint8_t> slots = {};
  };
  [[nodiscard]] bool is_for_us(const sacn::DataPacket& packet);

  std::uint16_t universe_;
  std::vector<Source> sources_;  ///< in the order of their first packets
  SourceCounts counts_;
};

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

// Lights of the emulator on the network: a UDP port that the emulator empties at the beginning of each robot
// cycle, so that a packet sent before an answer acts before the cycle of that answer.

class LightReceiver {
 public:
  /// Listens at `settings.address`, `port` (0: any free one). Throws std::runtime_error.
  LightReceiver(boost::asio::io_context& context, const SacnSettings& settings, std::uint16_t port, LightRig& rig);
  ~LightReceiver();
  LightReceiver(const LightReceiver&) = delete;
  LightReceiver& operator=(const LightReceiver&) = delete;

  /// Processes what has arrived, drops silent sources and moves the lamp. Without a source the lights are off.
  void begin_cycle(double bench_s);

  [[nodiscard]] std::uint16_t port() const;
  /// Returns the address for addresses.json: "127.0.20.4:40001".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] const SourceCounts& counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::bench
