#include "fsw/sources/carrier_pair/phase_channels.h"

namespace vbar::fsw::sources {
namespace {

// Lock times have a resolution of a fraction of a second and are counted by the receiver clock.
constexpr double kLockTolerance_s = 0.6;
// The longest lock time that the compressed log can represent; it saturates there.
constexpr double kLongestLock_s = 65000.0;

bool fell(double lock_s, double before_s, double elapsed_s) {
  return before_s < kLongestLock_s && lock_s < before_s + elapsed_s - kLockTolerance_s;
}

}  // namespace

std::optional<std::size_t> PhaseChannels::find(gnss::SatelliteId satellite, gnss::Signal signal) const {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const PhaseChannel& channel = channels_[k];
    if (channel.in_use && channel.satellite == satellite && channel.signal == signal) return k;
  }
  return std::nullopt;
}

std::optional<std::size_t> PhaseChannels::take(gnss::SatelliteId satellite, gnss::Signal signal) {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    if (channels_[k].in_use) continue;
    channels_[k] = PhaseChannel{};
    channels_[k].in_use = true;
    channels_[k].satellite = satellite;
    channels_[k].signal = signal;
    return k;
  }
  return std::nullopt;
}

bool PhaseChannels::lost_lock(std::size_t place, const navigation::DifferentialObservation& observation,
                              GpsTime now) const {
  const PhaseChannel& channel = channels_[place];
  if (channel.epochs == 0) return false;
  const double elapsed_s = seconds(now - channel.last_seen);
  return fell(observation.servicer_lock_s, channel.servicer_lock_s, elapsed_s) ||
         fell(observation.target_lock_s, channel.target_lock_s, elapsed_s);
}

void PhaseChannels::see(std::size_t place, const navigation::DifferentialObservation& observation, GpsTime now) {
  PhaseChannel& channel = channels_[place];
  channel.last_seen = now;
  channel.servicer_lock_s = observation.servicer_lock_s;
  channel.target_lock_s = observation.target_lock_s;
  ++channel.epochs;
}

void PhaseChannels::restart(std::size_t place) {
  channels_[place].epochs = 0;
  channels_[place].fixed = false;
}

}  // namespace vbar::fsw::sources
