#include "fsw/vision/target_tracking/relative_motion.h"

#include "fsw/math/math.h"

namespace vbar::fsw::target_tracking {
namespace {

using Row5 = Eigen::Matrix<double, 1, 5>;

// Beyond these the range would change by more than that of a target that stays in the field of a camera along T.
constexpr double kMinStretch = 0.2;
constexpr double kMaxStretch = 5.0;

/// Rows that multiply s, and their derivatives with respect to u.
struct Regressors {
  Row5 radial;     ///< numerator of y
  Row5 normal;     ///< numerator of z
  Row5 along;      ///< den - 1
  Row5 radial_du;  ///< d/du
  Row5 normal_du;
  Row5 along_du;
};

Regressors regressors(double latitude) {
  const double s = math::sin(latitude);
  const double c = math::cos(latitude);
  Regressors rows;
  rows.radial << 1.0, -c, -s, 0.0, 0.0;
  rows.normal << 0.0, 0.0, 0.0, s, -c;
  rows.along << 0.0, 2.0 * s, -2.0 * c, 0.0, 0.0;
  rows.radial_du << 0.0, s, -c, 0.0, 0.0;
  rows.normal_du << 0.0, 0.0, 0.0, c, s;
  rows.along_du << 0.0, 2.0 * c, 2.0 * s, 0.0, 0.0;
  return rows;
}

double limited(double den) {
  return den > kMinStretch ? den : kMinStretch;
}

void symmetrise(Matrix5& p) {
  for (int r = 0; r < 5; ++r) {
    for (int c = 0; c < r; ++c) p(r, c) = p(c, r) = 0.5 * (p(r, c) + p(c, r));
  }
}

}  // namespace

Result<SlopeMeasurement> slope_measurement(const Vector3& direction_rtn, double sigma, const MotionSettings& settings) {
  const Result<Vector2> slopes = slopes_of(direction_rtn);
  if (!slopes.ok()) return slopes.status();
  if (!math::is_finite(sigma)) return Status::kNotFinite;
  if (!(sigma > 0.0)) return Status::kOutOfRange;
  const double y = slopes.value().x();
  const double z = slopes.value().y();
  const double variance = (sigma * sigma + settings.model_sigma * settings.model_sigma) * (1.0 + y * y + z * z);
  return SlopeMeasurement{slopes.value(), Vector2(variance * (1.0 + y * y), variance * (1.0 + z * z))};
}

RelativeMotion unknown_motion(const MotionSettings& settings) {
  RelativeMotion motion;
  motion.covariance = Matrix5::Identity() * (settings.shape_sigma * settings.shape_sigma);
  return motion;
}

bool propagate(RelativeMotion& motion, const ServicerView& view, double dt, const MotionSettings& settings) {
  const double rate = view.drift_rate * dt;
  const double stretch = 1.0 - rate * motion.shape[0];  // factor of dlambda
  if (!(stretch > kMinStretch && stretch < kMaxStretch)) return false;
  const double inverse = 1.0 / stretch;
  motion.shape *= inverse;
  Matrix5 transition = Matrix5::Identity() * inverse;
  transition.col(0) += motion.shape * (rate * inverse);
  motion.covariance = Matrix5(transition * motion.covariance) * transition.transpose();
  const double size = settings.drift_fraction * settings.drift_fraction * motion.shape.squaredNorm();
  const double variance =
      (settings.drift_sigma * settings.drift_sigma + size) * math::abs(dt) * view.mean_motion / math::kTwoPi;
  motion.covariance.diagonal().array() += variance;
  symmetrise(motion.covariance);
  return true;
}

void apply_burn(RelativeMotion& motion, const OwnBurn& burn, double latitude, const ServicerView& view,
                const Prediction& prediction, const MotionSettings& settings) {
  if (prediction.along_track_m == 0.0) {
    motion.covariance.diagonal().array() += settings.shape_sigma * settings.shape_sigma;
    return;
  }
  const Regressors rows = regressors(latitude);
  const double a_dlambda = prediction.along_track_m / limited(1.0 + rows.along.dot(motion.shape));
  // Near-circular control matrix (D'Amico 2010), with the sign of a burn of the chief.
  const double per_speed = -1.0 / (view.mean_motion * a_dlambda);
  const double s = math::sin(latitude);
  const double c = math::cos(latitude);
  Eigen::Matrix<double, 5, 3> control;
  control << 0.0, 2.0, 0.0,  //
      s, 2.0 * c, 0.0,       //
      -c, 2.0 * s, 0.0,      //
      0.0, 0.0, c,           //
      0.0, 0.0, s;
  control *= per_speed;
  const double stretch = limited(1.0 - 2.0 * per_speed * burn.dv_rtn.x());
  const double fraction = prediction.along_track_sigma_fraction;
  Matrix3 spread = burn.dv_rtn * burn.dv_rtn.transpose() * (fraction * fraction);
  spread.diagonal().array() += burn.sigma * burn.sigma;
  motion.shape = (motion.shape + control * burn.dv_rtn) / stretch;
  motion.covariance += control * spread * control.transpose();
  motion.covariance /= stretch * stretch;
  symmetrise(motion.covariance);
}

Innovation innovation_of(const RelativeMotion& motion, const ServicerView& view, double bend,
                         const SlopeMeasurement& measurement) {
  const Regressors rows = regressors(view.latitude);
  const double inverse = 1.0 / limited(1.0 + rows.along.dot(motion.shape));
  const double y = measurement.slopes.x() - view.path_slope - bend;
  const double z = measurement.slopes.y();
  Innovation innovation;
  innovation.jacobian.row(0) = (rows.radial - y * rows.along) * inverse;
  innovation.jacobian.row(1) = (rows.normal - z * rows.along) * inverse;
  innovation.residual = Vector2(y, z) * inverse - innovation.jacobian * motion.shape;
  const Matrix25 spread = innovation.jacobian * motion.covariance;
  innovation.covariance = spread * innovation.jacobian.transpose();
  innovation.covariance.diagonal() += measurement.variance;
  const Matrix2& s = innovation.covariance;
  const Vector2& r = innovation.residual;
  innovation.determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
  innovation.distance =
      (s(1, 1) * r.x() * r.x() - 2.0 * s(0, 1) * r.x() * r.y() + s(0, 0) * r.y() * r.y()) / innovation.determinant;
  return innovation;
}

void update(RelativeMotion& motion, const Innovation& innovation) {
  const Matrix2& s = innovation.covariance;
  Matrix2 inverse;
  inverse << s(1, 1), -s(0, 1), -s(1, 0), s(0, 0);
  inverse /= innovation.determinant;
  const Eigen::Matrix<double, 5, 2> spread = motion.covariance * innovation.jacobian.transpose();
  const Eigen::Matrix<double, 5, 2> gain = spread * inverse;
  motion.shape += gain * innovation.residual;
  motion.covariance -= gain * spread.transpose();
  symmetrise(motion.covariance);
}

SlopeState slope_state(const RelativeMotion& motion, const ServicerView& view, double bend, double bend_rate) {
  const Regressors rows = regressors(view.latitude);
  const Vector5& shape = motion.shape;
  const double drift = view.drift_rate;  // drift of s: ds/dt = drift s0 s
  const double inverse = 1.0 / limited(1.0 + rows.along.dot(shape));
  const double along = rows.along.dot(shape);
  const double along_rate = view.latitude_rate * rows.along_du.dot(shape) + drift * shape[0] * along;
  Row5 along_rate_row = view.latitude_rate * rows.along_du + drift * shape[0] * rows.along;
  along_rate_row[0] += drift * along;

  SlopeState state;
  Matrix5& jacobian = state.jacobian;
  const auto fill = [&](int k, const Row5& row, const Row5& row_du) {
    const double numerator = row.dot(shape);
    const double slope = numerator * inverse;
    const double numerator_rate = view.latitude_rate * row_du.dot(shape) + drift * shape[0] * numerator;
    const double rate = (numerator_rate - slope * along_rate) * inverse;
    Row5 numerator_rate_row = view.latitude_rate * row_du + drift * shape[0] * row;
    numerator_rate_row[0] += drift * numerator;
    jacobian.row(k) = (row - slope * rows.along) * inverse;
    jacobian.row(k + 2) =
        (numerator_rate_row - slope * along_rate_row - along_rate * jacobian.row(k) - rate * rows.along) * inverse;
    state.slopes[k] = slope;
    state.slopes[k + 2] = rate;
  };
  fill(0, rows.radial, rows.radial_du);
  fill(1, rows.normal, rows.normal_du);
  state.slopes[4] = along_rate * inverse - drift * shape[0];
  jacobian.row(4) = (along_rate_row - along_rate * inverse * rows.along) * inverse;
  jacobian(4, 0) -= drift;
  state.slopes[0] += view.path_slope + bend;
  state.slopes[2] += view.path_slope_rate + bend_rate;
  state.slopes[3] += view.plane_rotation_rate;
  state.slopes[4] += view.path_stretch_rate;
  const Matrix5 spread = jacobian * motion.covariance;
  state.covariance = spread * jacobian.transpose();
  return state;
}

SlopeDistance slope_distance(const Vector5& difference, const Matrix5& covariance, const SlopeFloors& floors) {
  constexpr double kVeryFar = 1e9;
  // Rates in units of 1e-3 1/s, so that the matrix is well conditioned; then Cholesky, L w = difference.
  constexpr double kRateUnit = 1e3;
  const Vector5 unit(1.0, 1.0, kRateUnit, kRateUnit, kRateUnit);
  const Vector5 scaled = difference.cwiseProduct(unit);
  Matrix5 sum = unit.asDiagonal() * covariance * unit.asDiagonal();
  for (int k = 0; k < 5; ++k) {
    const double floor = k < 2 ? floors.slope : kRateUnit * floors.rate;
    sum(k, k) += floor * floor;
  }
  Matrix5 lower = Matrix5::Zero();
  Vector5 w = Vector5::Zero();
  SlopeDistance distance;
  for (int r = 0; r < 5; ++r) {
    double rest = scaled[r];
    for (int c = 0; c < r; ++c) {
      double entry = sum(r, c);
      for (int k = 0; k < c; ++k) entry -= lower(r, k) * lower(c, k);
      lower(r, c) = entry / lower(c, c);
      rest -= lower(r, c) * w[c];
    }
    double pivot = sum(r, r);
    for (int k = 0; k < r; ++k) pivot -= lower(r, k) * lower(r, k);
    if (!(pivot > 0.0)) return {kVeryFar, kVeryFar};
    lower(r, r) = math::sqrt(pivot);
    w[r] = rest / lower(r, r);
    distance.square += w[r] * w[r];
    distance.log_determinant += math::log(pivot);
  }
  return math::is_finite(distance.square) ? distance : SlopeDistance{kVeryFar, kVeryFar};
}

}  // namespace vbar::fsw::target_tracking
