#include "fsw/navigation/gnss_navigation.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/navigation/single_point.h"
#include "tests/unit/fsw/navigation/synthetic_receivers.h"

namespace vbar::fsw::navigation {
namespace {

using test::start_time;
using test::SyntheticReceiver;

const orbit::EarthOrientation kEarth{.epoch = start_time(), .ut1_minus_gps_s = -15.3, .ut1_rate = 0.0, .pole_x = 0.0, .pole_y = 0.0};

orbit::CartesianState servicer_start() {
  const double degree = M_PI / 180.0;
  return orbit::cartesian_from_qns({7087300.0, 0.0015, 0.0, 98.18 * degree, -90.0 * degree, -0.69 * degree}).value();
}

/// Servicer and target at waypoint distance, with unknown antenna offsets if asked for.
struct Pair {
  explicit Pair(unsigned seed, double offset_m = 0.0, double jitter_m = 0.0) {
    random.seed(seed);
    servicer.start = servicer_start();
    target.start = servicer.start;
    const Matrix3 R = orbit::R_rtn_eci(servicer.start).transpose();
    target.start.position_eci += R * Vector3(-0.5, -9.0, 1.0);
    target.start.velocity_eci += R * Vector3(0.0005, 0.0011, 0.0007) +
                                 servicer.start.position_eci.cross(servicer.start.velocity_eci).cross(R * Vector3(-0.5, -9.0, 1.0)) /
                                     servicer.start.position_eci.squaredNorm();
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> whole(-1000000, 1000000);
    for (SyntheticReceiver* r : {&servicer, &target}) {
      r->random.seed(seed * 2 + (r == &target ? 1 : 0));
      for (double& n : r->cycles) n = whole(random);
      r->jitter_m = jitter_m;
      const Vector3 direction = Vector3(normal(random), normal(random), normal(random)).normalized();
      r->antenna_body_m = Vector3(0.0, 0.1, 0.4) + offset_m * direction;
    }
    servicer.clock_s = 0.3e-3;
    target.clock_s = -0.45e-3;
    settings.earth = kEarth;
    settings.servicer_antenna_body_m = settings.target_antenna_body_m = Vector3(0.0, 0.1, 0.4);
    navigation = std::make_unique<GnssNavigation>(settings);
    for (const gnss::Ephemeris& e : satellites) navigation->take(e);
  }

  void fly(int epochs, int period_s = 10) {
    for (int k = 0; k < epochs; ++k, tag = tag + duration_of_seconds(period_s)) {
      for (const Receiver r : {Receiver::kServicer, Receiver::kTarget}) {
        SyntheticReceiver& receiver = r == Receiver::kServicer ? servicer : target;
        navigation->take(r, AttitudeSample{.time = tag, .R_eci_body = receiver.R_eci_body_at(tag), .rate_body = Vector3::Zero()});
        navigation->take(r, receiver.observe(tag, satellites, kEarth));
      }
      navigation->update(tag, {});
    }
  }

  Vector6 error() const {
    const GpsTime t = navigation->epoch();
    const orbit::CartesianState s = servicer.state_at(t), g = target.state_at(t);
    const orbit::RelativeState truth = orbit::relative_state_rtn(s, g);
    const orbit::RelativeState estimate = orbit::relative_state_rtn(navigation->servicer(), navigation->target());
    Vector6 e;
    e << estimate.position_rtn - truth.position_rtn, estimate.velocity_rtn - truth.velocity_rtn;
    return e;
  }

  std::mt19937_64 random;
  SyntheticReceiver servicer, target;
  std::vector<gnss::Ephemeris> satellites = test::constellation(start_time() + duration_of_seconds(3600));
  GnssNavigationSettings settings;
  std::unique_ptr<GnssNavigation> navigation;
  GpsTime tag = start_time() + duration_of_seconds(10);
};

TEST(SinglePoint, WithoutNoiseIsExact) {
  Pair pair(1);
  pair.servicer.code_sigma_m = 0.0;
  EphemerisStore store;
  for (const auto& e : pair.satellites) ASSERT_EQ(store.put(e), Status::kOk);
  const EarthFrame frame = EarthFrame::at(pair.tag, kEarth);
  const auto point = single_point(pair.servicer.observe(pair.tag, pair.satellites, kEarth), store, frame);
  ASSERT_TRUE(point.ok());
  EXPECT_NEAR(point.value().clock_m, 0.3e-3 * gnss::kSpeedOfLight, 1e-3);
  const orbit::CartesianState s = pair.servicer.state_at(pair.tag);
  const Vector3 antenna = s.position_eci - 0.3e-3 * s.velocity_eci + pair.servicer.R_eci_body_at(pair.tag) * pair.servicer.antenna_body_m;
  EXPECT_LT((point.value().position_eci - antenna).norm(), 2e-3);
}

TEST(GnssNavigation, LooksSane) {
  Pair pair(3, 0.0, 0.0);
  for (int k = 0; k < 30; ++k) {
    pair.fly(6);
    const Vector6 e = pair.error();
    const Matrix6 p = pair.navigation->covariance_rtn();
    const auto& a = pair.navigation->ambiguities().report();
    const auto& u = pair.navigation->last_update();
    std::printf("%5d s  err %8.2f %8.2f %8.2f mm  %7.4f %7.4f %7.4f mm/s  sig %7.2f %7.2f %7.2f  trk %d fix %d obst %d sr %.4f ratio %.1f  codes %d/%d nis %.2f phases %d/%d nis %.2f slips %d\n",
                60 * (k + 1), 1e3 * e(0), 1e3 * e(1), 1e3 * e(2), 1e3 * e(3), 1e3 * e(4), 1e3 * e(5), 1e3 * std::sqrt(p(0, 0)),
                1e3 * std::sqrt(p(1, 1)), 1e3 * std::sqrt(p(2, 2)), a.tracked, a.fixed, static_cast<int>(a.obstacle), a.success_rate, a.ratio,
                u.codes_used, u.codes_refused, u.code_nis / u.codes_used, u.phases_used, u.phases_refused, u.phase_nis / u.phases_used, u.slips);
  }
}

}  // namespace
}  // namespace vbar::fsw::navigation
