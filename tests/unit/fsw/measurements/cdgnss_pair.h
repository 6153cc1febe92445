#pragma once
// The cooperating pair of tests/unit/fsw/navigation, whose observations the filter receives through its aids.

#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>

#include "fsw/filter/relative_orbit.h"
#include "fsw/measurements/cdgnss/cdgnss_aiding.h"
#include "fsw/measurements/gnss_absolute_source.h"
#include "tests/unit/fsw/gnss/synthetic_receivers.h"

namespace vbar::fsw::measurements::test {

using gnss::test::kEarth;
using gnss::test::start_time;

/// Motion in the filter's own gravity field, of degree 20.
inline orbit::CartesianState fly_in_full_gravity(const orbit::CartesianState& start, double seconds) {
  const filter::Propagation propagation(start_time(), kEarth, Vector3::UnitX());
  return propagation.coast(start, seconds);
}

struct FilterPair : gnss::test::CooperatingPair {
  explicit FilterPair(unsigned seed, double offset_m = 0.0, double jitter_m = 0.0)
      : CooperatingPair(seed, offset_m, jitter_m) {
    servicer.motion = target.motion = fly_in_full_gravity;
    filter_settings.earth = kEarth;
    // The empirical acceleration, and nothing else, drives the pair apart.
    filter_settings.relative_orbit.acceleration = {.psd = 1e-18, .psd_min = 1e-18, .psd_max = 1e-18};
    filter_settings.relative_orbit.drag.sigma = 1e-12;
    filter_settings.relative_orbit.from_sun.sigma = 1e-12;
    filter_settings.burn_sigma_relative = 2e-3;
    carrier_settings.servicer_antenna_body_m = carrier_settings.target_antenna_body_m = nominal_antenna_m;
    for (const gnss::Ephemeris& ephemeris : satellites) {
      if (store.put(ephemeris) != Status::kOk) throw std::logic_error("an ephemeris of the test is not stored");
    }
    begin_filter();
  }

  /// The truth is the filter's own model.
  void expect_no_acceleration() {
    filter_settings.relative_orbit.empirical.sigma = 1e-10;
    begin_filter();
  }

  void begin_filter() {
    estimator = std::make_unique<filter::RelativeNavigationFilter>();
    estimator->configure(filter_settings);
    own = std::make_unique<GnssAbsoluteAiding>();
    own->set_antenna(nominal_antenna_m);
    carrier = std::make_unique<CdgnssAiding>();
    carrier->configure(carrier_settings);
  }

  /// An epoch of both receivers at `tag`, or of the servicer alone.
  void step(const gnss::ObservationEpoch& ours, const gnss::ObservationEpoch* theirs,
            std::span<const filter::Burn> burns = {}) {
    estimator->advance_to(tag, burns);
    const auto frame = gnss::EarthFrame::at(tag, kEarth);
    const Matrix3 R_eci_servicer = servicer.R_eci_body_at(tag);
    const Matrix3 R_eci_target = target.R_eci_body_at(tag);
    carrier->watch(tag, *estimator);
    const auto point = own->process(ours, R_eci_servicer, store, frame, *estimator);
    if (point.ok() && theirs != nullptr) {
      carrier->process({.ours = ours,
                        .theirs = *theirs,
                        .servicer_clock_m = point.value().clock_m,
                        .R_eci_servicer = R_eci_servicer,
                        .R_eci_target = R_eci_target,
                        .ephemerides = store,
                        .frame = frame},
                       *estimator);
    }
  }
  void step(std::span<const filter::Burn> burns = {}) {
    const gnss::ObservationEpoch ours = servicer.observe(tag, satellites, kEarth);
    const gnss::ObservationEpoch theirs = target.observe(tag, satellites, kEarth);
    step(ours, &theirs, burns);
  }
  void fly_filter(int epochs, int period_s = 10) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(period_s)) step();
  }
  void fly_alone(int epochs, int period_s = 10) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(period_s)) {
      step(servicer.observe(tag, satellites, kEarth), nullptr);
    }
  }

  /// Estimated minus true relative state in RTN at the filter's epoch, m and m/s.
  [[nodiscard]] Vector6 filter_error() const {
    const auto estimated = estimator->target();
    if (!estimated.ok()) return Vector6::Constant(1e9);
    return error_of(estimator->servicer(), estimated.value(), estimator->epoch());
  }
  [[nodiscard]] Vector6 error_of(const orbit::CartesianState& own_state, const orbit::CartesianState& target_state,
                                 GpsTime time) const {
    const orbit::RelativeState truth = orbit::relative_state_rtn(servicer.state_at(time), target.state_at(time));
    const orbit::RelativeState estimate = orbit::relative_state_rtn(own_state, target_state);
    Vector6 error;
    error << estimate.position_rtn - truth.position_rtn, estimate.velocity_rtn - truth.velocity_rtn;
    return error;
  }
  [[nodiscard]] double filter_position_error() const { return filter_error().head<3>().norm(); }
  [[nodiscard]] Matrix6 filter_covariance() const {
    return filter::covariance_rtn(estimator->estimate(), estimator->servicer());
  }

  /// Whether every integer held in the filter is the true one.
  [[nodiscard]] bool filter_integers_are_true() const {
    const PhaseChannels& channels = carrier->filter().channels();
    for (std::size_t a = 0; a < kPhaseChannels; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const PhaseChannel& one = channels[a];
        const PhaseChannel& other = channels[b];
        if (!one.fixed || !other.fixed || one.signal != other.signal) continue;
        const double held = (estimator->estimate().mean(CarrierFilter::ambiguity_index(a)) -
                             estimator->estimate().mean(CarrierFilter::ambiguity_index(b))) /
                            gnss::wavelength(one.signal);
        if (!(std::abs(held - (cycles_of(one) - cycles_of(other))) <= 0.1)) return false;
      }
    }
    return true;
  }
  [[nodiscard]] double cycles_of(const PhaseChannel& channel) const {
    const std::size_t place = 2U * (channel.satellite.prn - 1U) + static_cast<std::size_t>(channel.signal);
    return target.cycles[place] - servicer.cycles[place];
  }

  filter::FilterSettings filter_settings;
  CarrierSettings carrier_settings;
  gnss::EphemerisStore store;
  std::unique_ptr<filter::RelativeNavigationFilter> estimator;
  std::unique_ptr<GnssAbsoluteAiding> own;
  std::unique_ptr<CdgnssAiding> carrier;
};

}  // namespace vbar::fsw::measurements::test
