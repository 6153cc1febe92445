#include "hil_drivers/optical_stimulator/self_check/day_correction.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

namespace vbar::optical_stimulator {

using fsw::Vector2;

FittedDay fit_day(std::span<const DotPair> dots, const Vector2& middle) {
  if (dots.size() < 2) throw std::invalid_argument("a rotation needs two dots");
  Vector2 from = Vector2::Zero(), to = Vector2::Zero();
  for (const DotPair& dot : dots) {
    from += dot.by_map - middle;
    to += dot.shown - middle;
  }
  from /= static_cast<double>(dots.size());
  to /= static_cast<double>(dots.size());
  // As complex numbers: to = factor from + shift.
  double squares = 0.0, along = 0.0, across = 0.0;
  for (const DotPair& dot : dots) {
    const Vector2 a = dot.by_map - middle - from, b = dot.shown - middle - to;
    squares += a.squaredNorm();
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  if (!(squares > 0.0)) throw std::invalid_argument("a rotation needs two places");
  FittedDay day;
  day.correction.scale = std::hypot(along, across) / squares;
  day.correction.rotation_rad = std::atan2(across, along);
  const fsw::Matrix2 turn = day.correction.scale * Eigen::Rotation2Dd(day.correction.rotation_rad).toRotationMatrix();
  day.correction.shift_px = to - turn * from;
  for (const DotPair& dot : dots)
    day.residuals_px.push_back((middle + turn * (dot.by_map - middle) + day.correction.shift_px - dot.shown).norm());
  return day;
}

}  // namespace vbar::optical_stimulator
