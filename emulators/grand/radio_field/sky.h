#pragma once
// True motion and clock of the satellites as polynomials over 16 s, which several vehicles share: a hundred times
// cheaper than the elements themselves, and within 1e-6 m of them (verified by its test).

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/radio_field/vehicle_motion.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/satellite.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::grand::bench {

/// Motion in the Earth-fixed frame of the same instant; derivatives relative to that rotating frame.
struct SatelliteMotion {
  fsw::Vector3 position = fsw::Vector3::Zero();
  fsw::Vector3 velocity = fsw::Vector3::Zero();
  fsw::Vector3 acceleration = fsw::Vector3::Zero();
  double clock_m = 0.0;  ///< satellite clock minus GPS time, times c
  double clock_rate_mps = 0.0;
};

class SatelliteOrbits {
 public:
  /// `start` is the origin of the times below.
  SatelliteOrbits(std::shared_ptr<const twins::gnss::Constellation> constellation, fsw::GpsTime start);

  [[nodiscard]] std::size_t size() const { return constellation_->size(); }
  [[nodiscard]] const twins::gnss::Constellation& constellation() const { return *constellation_; }
  [[nodiscard]] fsw::GpsTime start() const { return start_; }

  /// Returns the motion at `time_s` since start, which may be negative. A pure function of its arguments.
  [[nodiscard]] SatelliteMotion at(std::size_t index, double time_s);

 private:
  static constexpr double kInterval_s = 16.0;
  static constexpr std::size_t kQuantities = 4;  ///< x, y, z, clock
  static constexpr std::int64_t kNever = INT64_MIN;

  using Node = std::array<double, kQuantities>;
  struct Piece {
    std::int64_t interval = kNever;
    double coefficients[kQuantities][truth::kNodePoints] = {};
  };
  /// Polynomials in use. Vehicles are moved at slightly different times, so that two neighbouring intervals are in use
  /// at once.
  struct Satellite {
    std::array<Piece, 2> pieces;  ///< by the parity of the interval
    std::array<Node, 8> nodes{};  ///< by the lowest bits of the node's number
    std::array<std::int64_t, 8> node_numbers = empty_numbers();
  };
  static constexpr std::array<std::int64_t, 8> empty_numbers() {
    return {kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever};
  }

  const Piece& piece(std::size_t index, std::int64_t interval);
  const Node& node(std::size_t index, std::int64_t number);

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  fsw::GpsTime start_;
  std::vector<Satellite> satellites_;
};

// Errors that an RF generator adds to an ideal signal: constant misalignment of its channels, and a slow wander of each
// channel's carrier phase. Its 10 MHz is common to all outputs and causes no error.

/// Alignments: interchannel figures of a commercial simulator's data sheet. Channel phase: first-order Gauss-Markov.
struct BoxErrorSettings {
  double carrier_alignment_mm = 0.27;  ///< one sigma per vehicle, satellite and signal
  double code_alignment_mm = 20.0;     ///< the same of the code
  double channel_phase_mm = 0.5;       ///< one sigma
  double channel_phase_time_s = 60.0;
  friend bool operator==(const BoxErrorSettings&, const BoxErrorSettings&) = default;
};

/// Errors of one channel of one vehicle: a satellite's signal. Streams:
/// "grand/box/<vehicle>/<satellite>/<signal>/alignment" and ".../channel_phase".
class ChannelErrors {
 public:
  ChannelErrors(const BoxErrorSettings& settings, std::uint64_t seed, std::string_view vehicle,
                twins::gnss::SatelliteId satellite, twins::gnss::Signal signal);

  [[nodiscard]] double carrier_alignment_m() const { return carrier_alignment_m_; }
  [[nodiscard]] double code_alignment_m() const { return code_alignment_m_; }

  /// Channel phase at the beginning and the end of block `number` (of 100 ms, rising), m. The process continues over
  /// blocks that are left out.
  struct Wander {
    double begin_m = 0.0, end_m = 0.0;
  };
  Wander wander(std::int64_t number);

 private:
  void step_to(std::int64_t node);

  double sigma_m_;
  double blocks_per_time_constant_;
  double decay_;  ///< decay over one block
  double carrier_alignment_m_ = 0.0;
  double code_alignment_m_ = 0.0;
  engine::RandomStream stream_;
  bool started_ = false;
  std::int64_t node_ = 0;
  double phase_m_ = 0.0;
};

// Radio field of one vehicle: the signals at its antenna, and their ranges block by block.
//
// Geometric range and satellite clock are exact at the nodes every 100 ms, with their first and second derivative; a
// quintic Hermite curve joins them (within 0.01 mm of the exact range, verified by its test), so that phase and Doppler
// are continuous through a satellite's pass. Ionosphere, relativistic delay, power and visibility change over minutes:
// they are evaluated once a second, one and two seconds ahead by extrapolated motion, and a cubic joins them.

struct SkySettings {
  twins::gnss::VisibilitySettings visibility;
  twins::gnss::LinkBudgetSettings link_budget;
  bool ionosphere = true;
  BoxErrorSettings box;
};

class Sky {
 public:
  /// The orbits are shared by the vehicles; all references of the RF generator's time are to their start.
  Sky(const SkySettings& settings, std::shared_ptr<SatelliteOrbits> orbits, twins::gnss::AntennaPattern pattern,
      std::uint64_t seed, std::string_view vehicle);

  /// Fills the block `number` (from 100 ms * number since start on) of a vehicle whose motion has been advanced to the
  /// block's end. Blocks are requested in rising order. `is_radiated` false: no signals.
  void fill(VehicleMotion& motion, std::int64_t number, bool is_radiated, RfBlock& block);

 private:
  static constexpr std::size_t kMaxSignals = 2;  ///< signals of one satellite
  static constexpr std::int64_t kNever = INT64_MIN;

  /// Range plus satellite clock, and derivatives.
  struct RangeNode {
    double value_m = 0.0, rate_mps = 0.0, acceleration_mps2 = 0.0;
    double travel_s = 0.0, travel_rate = 0.0;
  };
  /// Quantities that change over minutes, at a whole second.
  struct SlowNode {
    bool is_visible = false;
    double ionosphere_l1_m = 0.0;
    double shapiro_m = 0.0;
    std::array<double, kMaxSignals> cn0_dbhz{};
  };
  /// Antenna at one of the whole seconds around the present.
  struct SlowAntenna {
    double time_s = 0.0;
    double seconds_of_week = 0.0;
    fsw::Vector3 position = fsw::Vector3::Zero();
    fsw::Vector3 velocity = fsw::Vector3::Zero();
    fsw::Vector3 boresight = fsw::Vector3::UnitZ();
  };
  struct Channel {
    twins::gnss::Signal signal;
    double ionosphere_scale;
    double group_delay_m;
    ChannelErrors errors;
  };
  struct Satellite {
    std::vector<Channel> channels;
    std::array<SlowNode, 4> slow;       ///< nodes at second - 1, second, second + 1, second + 2
    std::int64_t slow_second = kNever;  ///< second of slow[1]
    RangeNode node;
    std::int64_t node_number = kNever;  ///< number of the block at whose beginning `node` is
  };
  using Cubic = std::array<double, 4>;

  void begin_second(const VehicleMotion& motion, std::int64_t second);
  void update_slow(std::size_t index, std::int64_t second);
  [[nodiscard]] SlowNode slow_node(std::size_t index, const SlowAntenna& antenna);
  [[nodiscard]] RangeNode range_node(std::size_t index, double time_s, const MotionState& antenna, double travel_s,
                                     int passes);
  void fill_satellite(std::size_t index, std::int64_t number, const MotionState& begin, const MotionState& end,
                      RfBlock& block);

  SkySettings settings_;
  std::shared_ptr<SatelliteOrbits> orbits_;
  twins::gnss::AntennaPattern pattern_;
  std::vector<Satellite> satellites_;
  std::array<SlowAntenna, 4> slow_antenna_{};
  std::int64_t second_ = kNever;
  std::int64_t state_number_ = kNever;  ///< number of the block at whose beginning `state_` is
  MotionState state_;
};

}  // namespace vbar::grand::bench
