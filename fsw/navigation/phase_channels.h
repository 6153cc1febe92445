#pragma once
// Which ambiguity of the filter belongs to which signal of which satellite, and whether its carrier was tracked without
// a break. A channel is taken at first sight, kept through short gaps, given back after long ones.

#include <array>
#include <cstddef>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/observation.h"
#include "fsw/navigation/differential.h"

namespace vbar::fsw::navigation {

inline constexpr std::size_t kPhaseChannels = 56;

struct PhaseChannel {
  bool in_use = false;
  gnss::SatelliteId satellite;
  gnss::Signal signal = gnss::Signal::kGpsL1;
  GpsTime last_seen;
  double servicer_lock_s = 0.0;
  double target_lock_s = 0.0;
  int epochs = 0;      ///< tracked without a break
  bool fixed = false;  ///< its differences to the other fixed ones of its signal are whole numbers, held by the filter
};

class PhaseChannels {
 public:
  /// Places of the channels whose signal has not been seen for kKeptUnseen: given back, to be put to rest by the
  /// caller. Calls `given_back(place)` for each.
  template <class Visitor>
  void give_back_unseen(GpsTime now, Visitor&& given_back) {
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (channels_[k].in_use && now - channels_[k].last_seen > kKeptUnseen) {
        channels_[k] = PhaseChannel{};
        given_back(k);
      }
    }
  }

  [[nodiscard]] std::optional<std::size_t> find(gnss::SatelliteId satellite, gnss::Signal signal) const;

  /// A free channel for the signal, not yet tracked; none when all are taken.
  std::optional<std::size_t> take(gnss::SatelliteId satellite, gnss::Signal signal);

  /// Whether a receiver's own lock time shows that it lost the carrier since the channel was last seen.
  [[nodiscard]] bool lost_lock(std::size_t place, const DifferentialObservation& observation, GpsTime now) const;

  /// The carrier was tracked, or begins anew.
  void see(std::size_t place, const DifferentialObservation& observation, GpsTime now);
  void restart(std::size_t place);

  [[nodiscard]] const PhaseChannel& operator[](std::size_t place) const { return channels_[place]; }
  void set_fixed(std::size_t place, bool fixed) { channels_[place].fixed = fixed; }
  void clear() { channels_ = {}; }

  static constexpr Duration kKeptUnseen = duration_of_seconds(120);

 private:
  std::array<PhaseChannel, kPhaseChannels> channels_{};
};

}  // namespace vbar::fsw::navigation
