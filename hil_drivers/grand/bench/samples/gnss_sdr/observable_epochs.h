#pragma once
// Collection of the observables of channels, which come one by one, into epochs.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "hil_drivers/grand/bench/samples/gnss_sdr/monitor_datagrams.h"

namespace vbar::grand::bench {

/// Epoch of the receiver's clock with all its valid observables, in order of satellite.
struct ObservableEpoch {
  std::int64_t rx_time_ms = 0;  ///< time of the GPS week
  struct Satellite {
    Observable observable;
    std::int64_t locked_ms = 0;         ///< begin of the lock without interruption
    double carrier_phase_cycles = 0.0;  ///< near the pseudorange: a whole number of cycles has been added at lock
  };
  std::vector<Satellite> satellites;
};

class ObservableEpochs {
 public:
  /// `channels` send an observable each, every `interval_ms` of the receiver's clock.
  ObservableEpochs(int channels, int interval_ms) : channels_(channels), interval_ms_(interval_ms) {}

  void take(const Observable& observable);
  /// Returns the next epoch that is complete: every channel has sent, or half a second of later epochs has come. Epochs
  /// come in order; observables of an epoch that has passed are ignored.
  std::optional<ObservableEpoch> next();

 private:
  struct Pending {
    int received = 0;
    std::map<int, Observable> by_satellite;
  };
  struct Lock {
    std::int64_t since_ms = 0, last_ms = 0;
    int channel = 0;
    double added_cycles = 0.0;
  };
  ObservableEpoch finished(std::int64_t rx_time_ms, const Pending& pending);

  int channels_;
  int interval_ms_;
  std::map<std::int64_t, Pending> pending_;
  std::map<int, Lock> locks_;
  std::int64_t newest_ms_ = 0;
  std::int64_t last_ms_ = 0;
};

}  // namespace vbar::grand::bench
