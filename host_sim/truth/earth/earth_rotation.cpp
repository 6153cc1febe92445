#include "host_sim/truth/earth/earth_rotation.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <erfa.h>

namespace vbar::truth {

void fit_node_polynomial(const double (&values)[kNodePoints], double (&coefficients)[kNodePoints]) {
  // Newton's forward differences.
  double difference[kNodePoints];
  for (int i = 0; i < kNodePoints; ++i) difference[i] = values[i];
  for (int order = 1; order < kNodePoints; ++order) {
    for (int i = kNodePoints - 1; i >= order; --i) difference[i] = (difference[i] - difference[i - 1]) / order;
  }
  // Horner on the Newton form: multiply by (t - node) and add the next difference.
  for (double& c : coefficients) c = 0.0;
  for (int k = kNodePoints - 1; k >= 0; --k) {
    const double node = kFirstNode + k;
    for (int power = kNodePoints - 1; power > 0; --power) {
      coefficients[power] = coefficients[power - 1] - node * coefficients[power];
    }
    coefficients[0] = difference[k] - node * coefficients[0];
  }
}

namespace {

constexpr double kJ2000 = 2451545.0;
constexpr double kNodesPerDay = 4.0;

}  // namespace

CelestialPole celestial_pole_iau2006a(JulianDate tt) {
  CelestialPole pole;
  eraXy06(tt.day, tt.fraction, &pole.x, &pole.y);
  pole.s = eraS06(tt.day, tt.fraction, pole.x, pole.y);
  return pole;
}

CelestialPole CelestialPoleInterpolator::at(JulianDate tt) {
  const double position = ((tt.day - kJ2000) + tt.fraction) * kNodesPerDay;
  const double floor = std::floor(position);
  const auto interval = static_cast<std::int64_t>(floor);
  if (!ready_ || interval != interval_) enter_interval(interval);
  const double t = position - floor;
  return {node_polynomial(x_, t), node_polynomial(y_, t), node_polynomial(s_, t)};
}

void CelestialPoleInterpolator::enter_interval(std::int64_t interval) {
  double x[kNodePoints], y[kNodePoints], s[kNodePoints];
  for (int i = 0; i < kNodePoints; ++i) {
    const CelestialPole& pole = node(interval + kFirstNode + i);
    x[i] = pole.x;
    y[i] = pole.y;
    s[i] = pole.s;
  }
  fit_node_polynomial(x, x_);
  fit_node_polynomial(y, y_);
  fit_node_polynomial(s, s_);
  interval_ = interval;
  ready_ = true;
}

const CelestialPole& CelestialPoleInterpolator::node(std::int64_t index) {
  const auto found = nodes_.find(index);
  if (found != nodes_.end()) return found->second;
  return nodes_.emplace(index, celestial_pole_iau2006a({kJ2000, static_cast<double>(index) / kNodesPerDay}))
      .first->second;
}

fsw::Matrix3 R_itrf_gcrf(const CelestialPole& pole, double era, double pole_x, double pole_y, double sp) {
  // IERS Conventions 2010, eq. 5.10: to CIRS from GCRS = R3(-s) Q^T; R3(-s) joins the Earth rotation angle.
  const double x = pole.x, y = pole.y;
  const double z = std::sqrt(1.0 - x * x - y * y);
  const double a = 1.0 / (1.0 + z);
  fsw::Matrix3 intermediate_gcrf;
  intermediate_gcrf << 1.0 - a * x * x, -a * x * y, -x,  //
      -a * x * y, 1.0 - a * y * y, -y,                   //
      x, y, z;
  const double c = std::cos(era - pole.s), s = std::sin(era - pole.s);
  fsw::Matrix3 terrestrial_gcrf;
  terrestrial_gcrf.row(0) = c * intermediate_gcrf.row(0) + s * intermediate_gcrf.row(1);
  terrestrial_gcrf.row(1) = c * intermediate_gcrf.row(1) - s * intermediate_gcrf.row(0);
  terrestrial_gcrf.row(2) = intermediate_gcrf.row(2);

  double polar_motion[3][3];
  eraPom00(pole_x, pole_y, sp, polar_motion);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&polar_motion[0][0]) * terrestrial_gcrf;
}

EarthRotation::EarthRotation(std::shared_ptr<const EarthOrientationSeries> orientation, fsw::GpsTime epoch)
    : orientation_(std::move(orientation)), epoch_(epoch) {
  if (!orientation_) throw std::invalid_argument("Earth rotation needs Earth orientation data");
}

fsw::Matrix3 EarthRotation::R_itrf_gcrf_at(double seconds) {
  const EarthOrientation orientation = orientation_->at(epoch_, seconds);
  const JulianDate tt = tt_of(epoch_, seconds);
  const JulianDate ut1 = ut1_of(tai_of(epoch_, seconds), orientation.ut1_minus_tai_s);
  CelestialPole pole = pole_.at(tt);
  pole.x += orientation.cip_dx;
  pole.y += orientation.cip_dy;
  return R_itrf_gcrf(pole, eraEra00(ut1.day, ut1.fraction), orientation.pole_x, orientation.pole_y,
                     eraSp00(tt.day, tt.fraction));
}

// GeographicLib's conversion differs in the last bit, which drag carries into the truth: the output hashes of
// experiment 3 would change. The test compares this one with that library.

namespace {

constexpr double kEquatorialRadius = 6378137.0;  // m
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kPolarRadius = kEquatorialRadius * (1.0 - kFlattening);
constexpr double kE2 = kFlattening * (2.0 - kFlattening);                   // first eccentricity squared
constexpr double kEp2 = kE2 / ((1.0 - kFlattening) * (1.0 - kFlattening));  // second

/// An angle in the meridian, by sine and cosine.
struct Direction {
  double sin, cos;

  Direction(double rise, double run) {
    const double length = std::sqrt(rise * rise + run * run);
    sin = rise / length;
    cos = run / length;
  }
};

}  // namespace

GeodeticPosition geodetic_from_itrf(const fsw::Vector3& position_itrf) {
  const double z = position_itrf.z();
  const double axis_distance = std::hypot(position_itrf.x(), position_itrf.y());
  const double distance = std::hypot(axis_distance, z);

  // Reduced latitude, from the geocentric one for a point near the ellipsoid at first.
  Direction reduced((1.0 - kFlattening) * (1.0 + kEp2 * kPolarRadius / distance) * z, axis_distance);
  Direction latitude(0.0, 1.0);
  for (int pass = 0; pass < 2; ++pass) {
    const double sin3 = reduced.sin * reduced.sin * reduced.sin;
    const double cos3 = reduced.cos * reduced.cos * reduced.cos;
    latitude = Direction(z + kEp2 * kPolarRadius * sin3, axis_distance - kE2 * kEquatorialRadius * cos3);
    reduced = Direction((1.0 - kFlattening) * latitude.sin, latitude.cos);
  }

  GeodeticPosition geodetic;
  geodetic.latitude = std::atan2(latitude.sin, latitude.cos);
  geodetic.longitude = std::atan2(position_itrf.y(), position_itrf.x());
  geodetic.altitude = axis_distance * latitude.cos + z * latitude.sin -
                      kEquatorialRadius * std::sqrt(1.0 - kE2 * latitude.sin * latitude.sin);
  return geodetic;
}

}  // namespace vbar::truth
