#pragma once
// A servicer and a target ten metres apart, each with a receiver, and the flight code's navigation listening.

#include <memory>
#include <random>
#include <set>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/navigation/gnss_navigation.h"
#include "tests/unit/fsw/navigation/synthetic_receivers.h"

namespace vbar::fsw::navigation::test {

inline const orbit::EarthOrientation kEarth{
    .epoch = start_time(), .ut1_minus_gps_s = -15.3, .ut1_rate = 0.0, .pole_x = 0.0, .pole_y = 0.0};

inline orbit::CartesianState servicer_start() {
  const double degree = M_PI / 180.0;
  return orbit::cartesian_from_qns({7087300.0, 0.0015, 0.0, 98.18 * degree, -90.0 * degree, -0.69 * degree}).value();
}

struct CooperatingPair {
  /// `offset_m`: length of each antenna's unknown displacement; `jitter_m`: of its phase centre, each axis.
  explicit CooperatingPair(unsigned seed, double offset_m = 0.0, double jitter_m = 0.0) : random(seed) {
    servicer.start = servicer_start();
    const Vector3 separation_rtn(-0.5, -9.0, 1.0);
    const Matrix3 R = orbit::R_rtn_eci(servicer.start).transpose();
    const Vector3& r = servicer.start.position_eci;
    const Vector3 rate = r.cross(servicer.start.velocity_eci) / r.squaredNorm();
    target.start.position_eci = r + R * separation_rtn;
    target.start.velocity_eci =
        servicer.start.velocity_eci + R * Vector3(0.0005, 0.0011, 0.0007) + rate.cross(R * separation_rtn);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> whole(-1000000, 1000000);
    for (SyntheticReceiver* receiver : {&servicer, &target}) {
      receiver->random.seed(2 * seed + (receiver == &target ? 1 : 0));
      for (double& cycles : receiver->cycles) cycles = whole(random);
      receiver->jitter_m = jitter_m;
      const Vector3 direction = Vector3(normal(random), normal(random), normal(random)).normalized();
      receiver->antenna_body_m = nominal_antenna_m + offset_m * direction;
    }
    servicer.clock_s = 0.3e-3;
    target.clock_s = -0.45e-3;
    settings.earth = kEarth;
    settings.servicer_antenna_body_m = settings.target_antenna_body_m = nominal_antenna_m;
    begin();
  }

  /// Navigation anew, with the settings as they are.
  void begin() {
    navigation = std::make_unique<GnssNavigation>(settings);
    for (const gnss::Ephemeris& ephemeris : satellites) navigation->take(ephemeris);
  }

  void take(Receiver which) {
    SyntheticReceiver& receiver = which == Receiver::kServicer ? servicer : target;
    AttitudeSample attitude;
    attitude.time = tag;
    attitude.R_eci_body = receiver.R_eci_body_at(tag);
    navigation->take(which, attitude);
    navigation->take(which, receiver.observe(tag, satellites, kEarth));
  }

  void fly(int epochs, int period_s = 10) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(period_s)) {
      take(Receiver::kServicer);
      take(Receiver::kTarget);
      navigation->update(tag, {});
    }
  }

  /// Estimated minus true relative state in RTN at the navigation's epoch, m and m/s.
  [[nodiscard]] Vector6 error() const {
    const GpsTime time = navigation->epoch();
    const orbit::RelativeState truth = orbit::relative_state_rtn(servicer.state_at(time), target.state_at(time));
    const orbit::RelativeState estimate = orbit::relative_state_rtn(navigation->servicer(), navigation->target());
    Vector6 error;
    error << estimate.position_rtn - truth.position_rtn, estimate.velocity_rtn - truth.velocity_rtn;
    return error;
  }
  [[nodiscard]] double position_error() const { return error().head<3>().norm(); }

  /// Whether every held integer is the true one.
  [[nodiscard]] bool integers_are_true() const {
    const PhaseChannels& channels = navigation->relative().channels();
    const RelativeFilter::Estimate& estimate = navigation->relative().estimate();
    for (std::size_t a = 0; a < kPhaseChannels; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const PhaseChannel& one = channels[a];
        const PhaseChannel& other = channels[b];
        if (!one.fixed || !other.fixed || one.signal != other.signal) continue;
        const double held =
            (estimate.mean(RelativeFilter::ambiguity_index(a)) - estimate.mean(RelativeFilter::ambiguity_index(b))) /
            gnss::wavelength(one.signal);
        if (!(std::abs(held - (true_cycles(one) - true_cycles(other))) <= 0.1)) return false;
      }
    }
    return true;
  }
  [[nodiscard]] double true_cycles(const PhaseChannel& channel) const {
    const std::size_t place = 2U * (channel.satellite.prn - 1U) + static_cast<std::size_t>(channel.signal);
    return target.cycles[place] - servicer.cycles[place];
  }

  const Vector3 nominal_antenna_m{0.0, 0.1, 0.4};
  std::mt19937_64 random;
  SyntheticReceiver servicer, target;
  std::vector<gnss::Ephemeris> satellites = constellation(start_time() + duration_of_seconds(3600));
  GnssNavigationSettings settings;
  std::unique_ptr<GnssNavigation> navigation;
  GpsTime tag = start_time() + duration_of_seconds(10);
};

}  // namespace vbar::fsw::navigation::test
