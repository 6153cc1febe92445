#pragma once
// Search for satellites: engines that each sweep the Doppler of one satellite after the other. The available
// information decides which satellites are searched and how far the sweep goes; a satellite that cannot be found costs
// the whole sweep. So cold and warm starts differ.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

/// Information that limits the search.
struct SearchKnowledge {
  std::optional<fsw::Vector3> position_ecef;      ///< with almanac and time: satellites below are not searched
  bool velocity = false;                          ///< the Doppler is predicted
  double elevation_cutoff = -1.5707963267948966;  ///< rad
};

class SignalSearch {
 public:
  SignalSearch(const SearchSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
               std::uint64_t seed, std::string_view vehicle);

  void restart();

  /// Records that the first signal of a satellite was lost, at this range rate.
  void lost(std::size_t satellite, double range_rate_mps);

  /// Searches during 100 ms from `time` on. `signals` are the first signal of each satellite as radiated, or null;
  /// `range_rate_mps` adds the oscillator's; `tracked` satellites are not searched. `found` receives the satellites
  /// found in this block.
  void advance(fsw::GpsTime time, const std::vector<const RfSignal*>& signals, double oscillator_rate_mps,
               double cn0_offset_db, const std::vector<bool>& tracked, const SearchKnowledge& knowledge,
               std::vector<std::size_t>& found);

  [[nodiscard]] int busy_engines() const;

 private:
  struct Sweep {
    std::size_t satellite = 0;
    int blocks_left = 0;  ///< 0: the engine is free
    bool will_be_found = false;
  };
  struct Memory {
    int blocks_since_lost = -1;  ///< -1: never tracked
    double range_rate_mps = 0.0;
  };
  enum class Above : std::uint8_t { kUnknown, kYes, kNo };
  bool worth_searching(std::size_t satellite, fsw::GpsTime time, const SearchKnowledge& knowledge);
  Sweep sweep(std::size_t satellite, const RfSignal* signal, double oscillator_rate_mps, double cn0_offset_db,
              bool velocity_known);
  [[nodiscard]] bool is_searched(std::size_t satellite) const;

  SearchSettings settings_;
  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  engine::RandomStream stream_;
  std::vector<Sweep> engines_;
  std::vector<Memory> memory_;
  std::vector<Above> above_;  ///< by almanac, one satellite a block is predicted again
  std::size_t next_ = 0;
  std::size_t next_predicted_ = 0;
};

}  // namespace vbar::grand::bench
