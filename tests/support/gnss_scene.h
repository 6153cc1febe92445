#pragma once
// Where the emulated GNSS receivers of tests, peers and benchmarks fly: a circular orbit of the missions' size over an
// Earth that turns uniformly.

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include <Eigen/Geometry>

#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss/system_time.h"
#include "tests/support/paths.h"

namespace vbar::test {

using twins::gnss::BodyTruth;

/// 2011-07-19 16:00:00 GPS, near the start of the third experiment.
inline constexpr fsw::GpsTime kGnssStart = twins::gnss::gps_time_of(twins::gnss::System::kGps, 1645, 2 * 86400 + 57600);

inline std::filesystem::path data_directory() {
  return std::filesystem::path(vbar::tests::source_path("data"));
}

/// The truth about a body with this motion (ECI) `t_s` after kGnssStart; body z to the zenith, x ahead.
inline BodyTruth zenith_pointing(const fsw::Vector3& position_eci, const fsw::Vector3& velocity_eci, double t_s) {
  using fsw::Vector3;
  BodyTruth truth;
  truth.time = kGnssStart + fsw::nearest_duration(t_s);
  truth.position_eci = position_eci;
  truth.velocity_eci = velocity_eci;
  truth.R_ecef_eci = Eigen::AngleAxisd(-fsw::gnss::kEarthRateGps * t_s, Vector3::UnitZ()).toRotationMatrix();
  const Vector3 z = position_eci.normalized();
  const Vector3 y = z.cross(velocity_eci).normalized();
  fsw::Matrix3 R_eci_body;
  R_eci_body << y.cross(z), y, z;
  truth.q_body_eci = Eigen::Quaterniond(fsw::Matrix3(R_eci_body.transpose()));
  truth.rate_body_eci = position_eci.cross(velocity_eci) / position_eci.squaredNorm();
  return truth;
}

/// On a circular orbit, 7087.3 km, 98.18 deg; `offset_rtn_m` beside it (a few metres), without relative motion.
inline BodyTruth in_orbit(double t_s, const fsw::Vector3& offset_rtn_m = fsw::Vector3::Zero()) {
  using fsw::Vector3;
  constexpr double kRadius_m = 7087.3e3;
  constexpr double kInclination = 98.18 * std::numbers::pi / 180.0;
  const double rate = std::sqrt(fsw::gnss::kGmGps / (kRadius_m * kRadius_m * kRadius_m));
  const double u = rate * t_s + offset_rtn_m.y() / kRadius_m;
  const Vector3 radial(std::cos(u), std::sin(u) * std::cos(kInclination), std::sin(u) * std::sin(kInclination));
  const Vector3 ahead(-std::sin(u), std::cos(u) * std::cos(kInclination), std::cos(u) * std::sin(kInclination));
  const double radius_m = kRadius_m + offset_rtn_m.x();
  return zenith_pointing(radius_m * radial + offset_rtn_m.z() * radial.cross(ahead), radius_m * rate * ahead, t_s);
}

inline std::shared_ptr<const twins::gnss::Constellation> constellation(
    std::uint64_t seed, const twins::gnss::ConstellationSettings& settings = {}) {
  return std::make_shared<const twins::gnss::Constellation>(data_directory(), settings, kGnssStart, seed);
}

}  // namespace vbar::test
