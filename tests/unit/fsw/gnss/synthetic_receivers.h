#pragma once
// Two receivers in low orbit under a plain constellation, without anything that flight code does not model but noise:
// what a filter must get right before it meets an emulator.

#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/filter/propagation.h"
#include "fsw/gnss/differential.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/orbit/elements.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnss::test {

inline GpsTime start_time() {
  return GpsTime{994986015LL * kNanosecondsPerSecond};  // 2011-07-18 01:00:00 UTC
}

/// Thirty satellites in six planes.
inline std::vector<gnss::Ephemeris> constellation(GpsTime toe) {
  std::vector<gnss::Ephemeris> all;
  for (int k = 0; k < 30; ++k) {
    gnss::Ephemeris e;
    e.satellite = {gnss::Constellation::kGps, static_cast<std::uint8_t>(k + 1)};
    e.issue = 1;
    e.healthy = true;
    e.toe = e.toc = toe;
    e.toe_of_week_s = std::fmod(seconds(toe - GpsTime{}), 604800.0);
    e.sqrt_a = 5153.6;
    e.e = 0.005 + 0.0002 * k;
    e.m0 = 2.0 * M_PI * ((k % 5) / 5.0 + (k / 5) / 30.0) - M_PI;
    e.omega0 = 2.0 * M_PI * (k / 5) / 6.0 - M_PI;
    e.omega_dot = -8e-9;
    e.i0 = 0.96;
    e.omega = 0.3;
    e.af0 = 1e-5 * (k - 15);
    all.push_back(e);
  }
  return all;
}

struct SyntheticReceiver {
  orbit::CartesianState start;               ///< of the centre of mass, at start_time()
  Vector3 antenna_body_m = Vector3::Zero();  ///< the true one
  double clock_s = 0.0;                      ///< advance
  double code_sigma_m = 0.4;
  double phase_sigma_m = 0.7e-3;
  double jitter_m = 0.0;
  double wander_sigma_m = 0.0;  ///< Gauss-Markov error of each phase
  double wander_time_s = 60.0;
  std::mt19937_64 random{1};
  std::vector<double> cycles = std::vector<double>(80, 0.0);  ///< ambiguities
  std::vector<double> lock_start_s = std::vector<double>(80, 0.0);
  std::vector<double> wander_m = std::vector<double>(80, 0.0);
  std::optional<GpsTime> wander_time;
  /// Motion from `start` over a time in seconds; without it, that of point mass and J2.
  std::function<orbit::CartesianState(const orbit::CartesianState&, double)> motion;

  orbit::CartesianState state_at(GpsTime time) const {
    if (motion) return motion(start, seconds(time - start_time()));
    return filter::propagate_accelerated(start, Vector3::Zero(), seconds(time - start_time()));
  }

  /// Zenith pointing: body z up, x along-track.
  Matrix3 R_eci_body_at(GpsTime time) const {
    const Matrix3 R_rtn = orbit::R_rtn_eci(state_at(time));
    Matrix3 R_rtn_body;
    R_rtn_body << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    return R_rtn.transpose() * R_rtn_body;
  }

  /// The wander of all phases at `tag`, whether they are in view or not.
  void advance_wander(GpsTime tag) {
    if (wander_sigma_m == 0.0) return;
    std::normal_distribution<double> normal;
    const double decay = wander_time ? std::exp(-seconds(tag - *wander_time) / wander_time_s) : 0.0;
    for (double& wander : wander_m)
      wander = decay * wander + std::sqrt(1.0 - decay * decay) * wander_sigma_m * normal(random);
    wander_time = tag;
  }

  gnss::ObservationEpoch observe(GpsTime tag, const std::vector<gnss::Ephemeris>& satellites,
                                 const orbit::EarthOrientation& earth) {
    std::normal_distribution<double> normal;
    gnss::ObservationEpoch epoch;
    epoch.receiver_time = tag;
    advance_wander(tag);
    const EarthFrame frame = EarthFrame::at(tag, earth);
    const orbit::CartesianState at_tag = state_at(tag);
    const Vector3 gravity = -3.986004415e14 / std::pow(at_tag.position_eci.norm(), 3) * at_tag.position_eci;
    const Vector3 jitter(jitter_m * normal(random), jitter_m * normal(random), jitter_m * normal(random));
    const Vector3 antenna = at_tag.position_eci - clock_s * at_tag.velocity_eci + 0.5 * clock_s * clock_s * gravity +
                            R_eci_body_at(tag) * antenna_body_m + jitter;
    for (std::size_t k = 0; k < satellites.size(); ++k) {
      double range = 2.2e7;
      double satellite_clock = 0.0;
      Vector3 line = Vector3::Zero();
      for (int iteration = 0; iteration < 6; ++iteration) {
        // The time of transmission to the nanosecond, the rest by the satellite's velocity: a nanosecond is 4 um.
        const double back_s = clock_s + range / gnss::kSpeedOfLight;
        const Duration whole = nearest_duration(back_s);
        const auto state = gnss::satellite_state(satellites[k], tag - whole);
        const double rest_s = back_s - seconds(whole);
        const Vector3 ecef = state.value().position_ecef - rest_s * state.value().velocity_ecef;
        line = frame.eci_from_itrf(ecef, -back_s) - antenna;
        range = line.norm();
        satellite_clock = state.value().clock_s;
      }
      if (line.normalized().dot(antenna.normalized()) < -0.1) continue;  // 6 degrees below the horizontal
      for (const gnss::Signal signal : {gnss::Signal::kGpsL1, gnss::Signal::kGpsL2}) {
        const double true_m = range + gnss::kSpeedOfLight * (clock_s - satellite_clock);
        const std::size_t channel = 2 * k + static_cast<std::size_t>(signal);
        gnss::Observation o;
        o.satellite = satellites[k].satellite;
        o.signal = signal;
        o.phase_usable = true;
        o.pseudorange_m = true_m + code_sigma_m * normal(random);
        o.carrier_phase_cycles =
            (true_m + wander_m[channel] + phase_sigma_m * normal(random)) / gnss::wavelength(signal) + cycles[channel];
        o.pseudorange_sigma_m = code_sigma_m;
        o.phase_sigma_cycles = phase_sigma_m / gnss::wavelength(signal);
        o.lock_time_s = 1000.0 + seconds(tag - start_time()) - lock_start_s[channel];
        epoch.observations[epoch.count++] = o;
      }
    }
    return epoch;
  }
};

// A servicer and a target ten metres apart, each with a receiver.

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
  }

  const Vector3 nominal_antenna_m{0.0, 0.1, 0.4};
  std::mt19937_64 random;
  SyntheticReceiver servicer, target;
  std::vector<gnss::Ephemeris> satellites = constellation(start_time() + duration_of_seconds(3600));
  GpsTime tag = start_time() + duration_of_seconds(10);
};

}  // namespace vbar::fsw::gnss::test
