#include "host_sim/flown_gnss/given_orbit.h"

#include <utility>

#include <Eigen/Geometry>

namespace vbar::flown_gnss {

using fsw::Matrix3;
using fsw::Vector3;

GivenOrbit::GivenOrbit(const std::filesystem::path& orbit, const std::string& object,
                       std::shared_ptr<const truth::EarthOrientationSeries> earth_orientation)
    : file_(orbit_files::tracks_of(orbit_files::load_orbits(orbit), object)),
      series_(std::move(earth_orientation)),
      earth_(series_, first()) {}

twins::gnss::BodyTruth GivenOrbit::at(fsw::GpsTime time) {
  const orbit_files::FramedState framed = orbit_files::state_at(file_, time);
  twins::gnss::BodyTruth body;
  body.time = time;
  body.R_ecef_eci = earth_.R_itrf_gcrf_at(fsw::seconds(time - earth_.epoch()));
  Vector3 position = framed.state.position_eci, velocity = framed.state.velocity_eci;
  if (framed.frame == orbit_files::Frame::kItrf) {
    velocity += fsw::orbit::kEarthRotationRate * Vector3::UnitZ().cross(position);
    position = body.R_ecef_eci.transpose() * position;
    velocity = body.R_ecef_eci.transpose() * velocity;
  }
  body.position_eci = position;
  body.velocity_eci = velocity;
  const Vector3 momentum = position.cross(velocity);
  const Vector3 up = position.normalized(), across = momentum.normalized();
  Matrix3 R_body_eci;
  R_body_eci << across.cross(up).transpose(), across.transpose(), up.transpose();
  body.q_body_eci = Eigen::Quaterniond(R_body_eci);
  body.rate_body_eci = momentum / position.squaredNorm();
  return body;
}

fsw::orbit::EarthOrientation GivenOrbit::on_board() const {
  constexpr double kGpsMinusTai_s = -19.0, kLookAhead_s = 3600.0;
  const truth::EarthOrientation now = series_->at(first()), later = series_->at(first(), kLookAhead_s);
  return {.epoch = first(),
          .ut1_minus_gps_s = now.ut1_minus_tai_s - kGpsMinusTai_s,
          .ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / kLookAhead_s,
          .pole_x = now.pole_x,
          .pole_y = now.pole_y};
}

}  // namespace vbar::flown_gnss
