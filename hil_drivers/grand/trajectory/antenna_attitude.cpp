#include "hil_drivers/grand/trajectory/antenna_attitude.h"

#include <cmath>

#include <Eigen/Geometry>

#include "host_sim/truth/earth/earth_rotation.h"

namespace vbar::grand {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kEquatorialRadius_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricitySquared = kFlattening * (2.0 - kFlattening);

Matrix3 R_ned_ecef(const truth::GeodeticPosition& position) {
  const double sin_lat = std::sin(position.latitude);
  const double cos_lat = std::cos(position.latitude);
  const double sin_lon = std::sin(position.longitude);
  const double cos_lon = std::cos(position.longitude);
  Matrix3 R;
  R << -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat,  //
      -sin_lon, cos_lon, 0.0,                            //
      -cos_lat * cos_lon, -cos_lat * sin_lon, -sin_lat;
  return R;
}

}  // namespace

// Rates of latitude and longitude follow from the radii of curvature of the ellipsoid (Torge and Mueller 2012, 4.1.3).
LocalFrame local_frame(const Vector3& position_ecef_m, const Vector3& velocity_ecef_mps,
                       const Vector3& acceleration_ecef_mps2) {
  const truth::GeodeticPosition position = truth::geodetic_from_itrf(position_ecef_m);
  LocalFrame frame;
  frame.R_ned_ecef = R_ned_ecef(position);

  const double sin_lat = std::sin(position.latitude);
  const double cos_lat = std::cos(position.latitude);
  const double w2 = 1.0 - kEccentricitySquared * sin_lat * sin_lat;
  const double w = std::sqrt(w2);
  const double prime_vertical = kEquatorialRadius_m / w;
  const double meridian = kEquatorialRadius_m * (1.0 - kEccentricitySquared) / (w2 * w);
  const double curvature_change = kEccentricitySquared * sin_lat * cos_lat / w2;  // d ln(prime_vertical) / d latitude

  const Vector3 v = frame.R_ned_ecef * velocity_ecef_mps;
  const double lat_radius = meridian + position.altitude;
  const double lon_radius = prime_vertical + position.altitude;
  const double lat_rate = v.x() / lat_radius;
  const double lon_rate = v.y() / (lon_radius * cos_lat);
  frame.rate_ned = {lon_rate * cos_lat, -lat_rate, -lon_rate * sin_lat};

  const Vector3 a = frame.R_ned_ecef * acceleration_ecef_mps2 - frame.rate_ned.cross(v);
  const double lat_radius_rate = 3.0 * meridian * curvature_change * lat_rate - v.z();
  const double lon_radius_rate = prime_vertical * curvature_change * lat_rate - v.z();
  const double lat_acceleration = (a.x() - lat_rate * lat_radius_rate) / lat_radius;
  const double lon_acceleration =
      (a.y() - lon_rate * (lon_radius_rate * cos_lat - lon_radius * sin_lat * lat_rate)) / (lon_radius * cos_lat);
  frame.angular_acceleration_ned = {lon_acceleration * cos_lat - lon_rate * lat_rate * sin_lat, -lat_acceleration,
                                    -lon_acceleration * sin_lat - lon_rate * lat_rate * cos_lat};
  return frame;
}

Matrix3 R_ned_antenna(const Vector3& yaw_pitch_roll) {
  return (Eigen::AngleAxisd(yaw_pitch_roll.x(), Vector3::UnitZ()) *
          Eigen::AngleAxisd(yaw_pitch_roll.y(), Vector3::UnitY()) *
          Eigen::AngleAxisd(yaw_pitch_roll.z(), Vector3::UnitX()))
      .toRotationMatrix();
}

Vector3 yaw_pitch_roll(const Matrix3& R_ned_antenna) {
  const double across = std::hypot(R_ned_antenna(2, 1), R_ned_antenna(2, 2));
  return {std::atan2(R_ned_antenna(1, 0), R_ned_antenna(0, 0)), std::atan2(-R_ned_antenna(2, 0), across),
          std::atan2(R_ned_antenna(2, 1), R_ned_antenna(2, 2))};
}

Vector3 boresight_ecef(const TrajectorySample& sample) {
  const Matrix3 R = R_ned_ecef(truth::geodetic_from_itrf(sample.position_ecef_m));
  return R.transpose() * (R_ned_antenna(sample.yaw_pitch_roll) * Vector3(0.0, 0.0, -1.0));
}

}  // namespace vbar::grand
