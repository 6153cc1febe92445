#pragma once
// A servicer and a target ten metres apart, each with a receiver.

#include <random>
#include <vector>

#include <Eigen/Geometry>

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
  }

  const Vector3 nominal_antenna_m{0.0, 0.1, 0.4};
  std::mt19937_64 random;
  SyntheticReceiver servicer, target;
  std::vector<gnss::Ephemeris> satellites = constellation(start_time() + duration_of_seconds(3600));
  GpsTime tag = start_time() + duration_of_seconds(10);
};

}  // namespace vbar::fsw::navigation::test
