#pragma once
// Assignment of the filter's ambiguities to signals and satellites, and whether each carrier was tracked without
// a break. A channel is assigned at first sight, kept through short gaps, and released after long ones.

#include <array>
#include <cstddef>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/observation.h"
#include "fsw/navigation/differential.h"
#include "fsw/sources/carrier_pair/carrier_blocks.h"

namespace vbar::fsw::sources {

inline constexpr std::size_t kPhaseChannels = kPhaseChannelCount;

struct PhaseChannel {
  bool in_use = false;
  gnss::SatelliteId satellite;
  gnss::Signal signal = gnss::Signal::kGpsL1;
  GpsTime last_seen;
  double servicer_lock_s = 0.0;
  double target_lock_s = 0.0;
  int epochs = 0;      ///< tracked without a break
  bool fixed = false;  ///< its differences to the other fixed ones of its signal are integers, held by the filter
};

class PhaseChannels {
 public:
  /// Indices of the channels whose signal has not been seen for kKeptUnseen: released, to be deactivated by the
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

  /// A free channel for the signal, not yet tracked; no value when all are assigned.
  std::optional<std::size_t> take(gnss::SatelliteId satellite, gnss::Signal signal);

  /// Whether the receiver's lock time shows a loss of lock since the channel was last seen.
  [[nodiscard]] bool lost_lock(std::size_t place, const navigation::DifferentialObservation& observation,
                               GpsTime now) const;

  /// The carrier was tracked, or its tracking restarts.
  void see(std::size_t place, const navigation::DifferentialObservation& observation, GpsTime now);
  void restart(std::size_t place);

  [[nodiscard]] const PhaseChannel& operator[](std::size_t place) const { return channels_[place]; }
  void set_fixed(std::size_t place, bool fixed) { channels_[place].fixed = fixed; }
  void clear() { channels_ = {}; }
  [[nodiscard]] bool is_any_tracked() const {
    for (const PhaseChannel& channel : channels_) {
      if (channel.epochs > 0) return true;
    }
    return false;
  }

  static constexpr Duration kKeptUnseen = duration_of_seconds(120);

 private:
  std::array<PhaseChannel, kPhaseChannels> channels_{};
};

}  // namespace vbar::fsw::sources
