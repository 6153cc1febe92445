#pragma once
// Radio field of one vehicle: the signals at its antenna, and their ranges block by block.
//
// Geometric range and satellite clock are exact at the nodes every 100 ms, with their first and second derivative; a
// quintic Hermite curve joins them (within 0.01 mm of the exact range, verified by its test), so that phase and Doppler
// are continuous through a satellite's pass. Ionosphere, relativistic delay, power and visibility change over minutes:
// they are evaluated once a second, one and two seconds ahead by extrapolated motion, and a cubic joins them.

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "hil_drivers/grand/bench/generator/box_errors.h"
#include "hil_drivers/grand/bench/generator/satellite_orbits.h"
#include "hil_drivers/grand/bench/generator/vehicle_motion.h"
#include "hil_drivers/grand/bench/rf_block.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/signal_noise.h"

namespace vbar::grand::bench {

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
