#include "hil_drivers/grand/trajectory/antenna_trajectory.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "fsw/gnss/constants.h"
#include "hil_drivers/grand/trajectory/antenna_attitude.h"

namespace vbar::grand {

namespace {

using fsw::Vector3;

/// Value and derivatives of the blend 10 u^3 - 15 u^4 + 6 u^5 with respect to u.
std::array<double, 4> quintic_blend(double u) {
  const double u2 = u * u;
  return {u2 * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u2 * (1.0 + u * (-2.0 + u)),
          60.0 * u * (1.0 + u * (-3.0 + 2.0 * u)), 60.0 * (1.0 + u * (-6.0 + 6.0 * u))};
}

std::int64_t floor_quotient(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

}  // namespace

PhaseCentreNoise::PhaseCentreNoise(double sigma_m, const ReceiverEpochs& epochs, std::uint64_t seed,
                                   std::string_view spacecraft)
    : sigma_m_(sigma_m), epochs_(epochs), stream_(seed, "gnss/" + std::string(spacecraft) + "/antenna_noise") {
  if (epochs.period.ns <= 0)
    throw std::invalid_argument("phase centre noise: the period of the epochs is not positive");
}

Vector3 PhaseCentreNoise::value_of(std::int64_t epoch) {
  constexpr std::uint64_t kNumbersPerEpoch = 3;
  stream_.seek(kNumbersPerEpoch * static_cast<std::uint64_t>(epoch));
  const double x = stream_.normal();
  const double y = stream_.normal();
  const double z = stream_.normal();
  return sigma_m_ * Vector3(x, y, z);
}

std::array<Vector3, 4> PhaseCentreNoise::at(fsw::GpsTime time) {
  const std::int64_t since_offset_ns = time.ns - epochs_.offset.ns;
  const std::int64_t epoch = floor_quotient(since_offset_ns, epochs_.period.ns);
  if (epoch != epoch_) {
    ends_[0] = epoch == epoch_ + 1 ? ends_[1] : value_of(epoch);
    ends_[1] = value_of(epoch + 1);
    epoch_ = epoch;
  }
  const double period_s = fsw::seconds(epochs_.period);
  const double u = fsw::seconds({since_offset_ns - epoch * epochs_.period.ns}) / period_s;
  const std::array<double, 4> blend = quintic_blend(u);
  const Vector3 step = ends_[1] - ends_[0];
  return {ends_[0] + blend[0] * step, blend[1] / period_s * step, blend[2] / (period_s * period_s) * step,
          blend[3] / (period_s * period_s * period_s) * step};
}

namespace {

using fsw::Matrix3;
using twins::gnss::BodyTruth;

/// A vector and its first three derivatives with respect to time.
using Motion = std::array<Vector3, 4>;

/// -z along the boresight; x as near to the body's x as possible, or to its y if that is along the boresight.
Matrix3 antenna_axes(const Vector3& boresight_body) {
  constexpr double kNearlyParallel = 0.9;
  const Vector3 z = -boresight_body;
  const Vector3 reference = std::abs(z.x()) < kNearlyParallel ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 x = (reference - reference.dot(z) * z).normalized();
  Matrix3 R_antenna_body;
  R_antenna_body << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_antenna_body;
}

void check(const BodyTruth& truth, fsw::GpsTime start) {
  const auto fail = [](const std::string& problem) { throw std::invalid_argument("antenna trajectory: " + problem); };
  if (!truth.acceleration_eci) fail("the truth holds no acceleration");
  const bool is_finite = truth.position_eci.allFinite() && truth.velocity_eci.allFinite() &&
                         truth.acceleration_eci->allFinite() && truth.q_body_eci.coeffs().allFinite() &&
                         truth.rate_body_eci.allFinite() && truth.R_ecef_eci.allFinite() &&
                         truth.angular_acceleration_body.value_or(Vector3::Zero()).allFinite();
  if (!is_finite) fail("the truth holds a number that is not finite");
  if (truth.time < start) fail("the truth lies before the start");
}

/// In inertial axes, of a vector given with its derivatives in axes that turn at `rate` (body axes) with a constant
/// angular acceleration.
Motion turned(const Matrix3& R_eci_body, const Vector3& rate, const Vector3& angular_acceleration, const Motion& b) {
  // d/dt (R x) = R (rate x x + dx/dt), applied three times.
  const Vector3 x1 = rate.cross(b[0]) + b[1];
  const Vector3 x1_dot = angular_acceleration.cross(b[0]) + rate.cross(b[1]) + b[2];
  const Vector3 x1_ddot = 2.0 * angular_acceleration.cross(b[1]) + rate.cross(b[2]) + b[3];
  const Vector3 x2 = rate.cross(x1) + x1_dot;
  const Vector3 x2_dot = angular_acceleration.cross(x1) + rate.cross(x1_dot) + x1_ddot;
  const Vector3 x3 = rate.cross(x2) + x2_dot;
  return {R_eci_body * b[0], R_eci_body * x1, R_eci_body * x2, R_eci_body * x3};
}

/// Jerk of the two-body problem at this motion.
Vector3 two_body_jerk(const Vector3& position, const Vector3& velocity) {
  const double r2 = position.squaredNorm();
  const double gm_r3 = fsw::gnss::kGmGps / (r2 * std::sqrt(r2));
  return -gm_r3 * (velocity - 3.0 * position.dot(velocity) / r2 * position);
}

/// Returns the motion as an observer in the rotating Earth-fixed frame sees it.
Motion earth_fixed(const Matrix3& R_ecef_eci, const Vector3& earth_rate_ecef, const Motion& eci) {
  const auto w = [&](const Vector3& v) { return Vector3(earth_rate_ecef.cross(v)); };
  const Vector3 r = R_ecef_eci * eci[0];
  const Vector3 v = R_ecef_eci * eci[1];
  const Vector3 a = R_ecef_eci * eci[2];
  const Vector3 j = R_ecef_eci * eci[3];
  return {r, v - w(r), a - 2.0 * w(v) + w(w(r)), j - 3.0 * w(a) + 3.0 * w(w(v)) - w(w(w(r)))};
}

}  // namespace

AntennaTrajectory::AntennaTrajectory(const twins::gnss::BodyFrameSettings& settings, const ReceiverEpochs& epochs,
                                     fsw::GpsTime start, std::uint64_t seed, std::string_view spacecraft)
    : settings_(settings),
      errors_(twins::gnss::draw_body_frame(settings, seed, spacecraft)),
      antenna_body_m_(twins::gnss::antenna_from_com(settings, errors_)),
      R_antenna_body_(antenna_axes(twins::gnss::true_boresight(settings, errors_))),
      noise_(settings.pco_noise_mm * 1e-3, epochs, seed, spacecraft),
      start_(start),
      earth_rate_ecef_(0.0, 0.0, fsw::gnss::kEarthRateGps) {}

// Over at most this span the mean rate is that of its ends to 1e-14 rad/s, 1e-7 m/s in an orbit: the axis of precession
// and nutation (1e-11 rad/s) turns once a day in the Earth-fixed frame.
void AntennaTrajectory::observe_earth(fsw::GpsTime time, const Matrix3& R_ecef_eci) {
  constexpr double kLongest_s = 10.0;
  constexpr double kRounding = 2e-15;  // of the rotation between two times: below it the rate remains
  if (earth_) {
    const double s = fsw::seconds(time - earth_->time);
    if (s == 0.0) return;
    const Matrix3 R_now_before = R_ecef_eci * earth_->R_ecef_eci.transpose();
    // The rotation angle is at most a milliradian: its sine times the axis is the antisymmetric part.
    const Vector3 sine = 0.5 * Vector3(R_now_before(1, 2) - R_now_before(2, 1), R_now_before(2, 0) - R_now_before(0, 2),
                                       R_now_before(0, 1) - R_now_before(1, 0));
    const double norm = sine.norm();
    if (std::abs(s) <= kLongest_s && norm > 0.0) {
      const Vector3 rate = std::asin(norm) / (norm * s) * sine;
      if ((rate - earth_rate_ecef_).norm() * std::abs(s) > kRounding) earth_rate_ecef_ = rate;
    }
  }
  earth_ = {time, R_ecef_eci};
}

TrajectorySample AntennaTrajectory::at(const BodyTruth& truth) {
  check(truth, start_);
  const Matrix3 R_body_eci = truth.q_body_eci.toRotationMatrix();
  const Vector3 rate = R_body_eci * truth.rate_body_eci;
  const Vector3 angular_acceleration = truth.angular_acceleration_body.value_or(Vector3::Zero());

  Motion arm = noise_.at(truth.time);
  arm[0] += antenna_body_m_;
  Motion motion = turned(R_body_eci.transpose(), rate, angular_acceleration, arm);
  motion[0] += truth.position_eci;
  motion[1] += truth.velocity_eci;
  motion[2] += *truth.acceleration_eci;
  motion[3] += two_body_jerk(truth.position_eci, truth.velocity_eci);
  observe_earth(truth.time, truth.R_ecef_eci);
  const Motion fixed = earth_fixed(truth.R_ecef_eci, earth_rate_ecef_, motion);

  TrajectorySample sample;
  sample.time = truth.time - start_;
  sample.position_ecef_m = fixed[0];
  sample.velocity_ecef_mps = fixed[1];
  sample.acceleration_ecef_mps2 = fixed[2];
  sample.jerk_ecef_mps3 = fixed[3];

  const LocalFrame local = local_frame(fixed[0], fixed[1], fixed[2]);
  const Matrix3 R_antenna_ecef = R_antenna_body_ * R_body_eci * truth.R_ecef_eci.transpose();
  const Matrix3 R_antenna_ned = R_antenna_ecef * local.R_ned_ecef.transpose();
  sample.yaw_pitch_roll = yaw_pitch_roll(R_antenna_ned.transpose());

  // Against the local frame: that of the body less those of the Earth and of the local frame on it.
  const Vector3 earth = R_antenna_ecef * earth_rate_ecef_;
  const Vector3 frame = R_antenna_ned * local.rate_ned;
  const Vector3 against_earth = R_antenna_body_ * rate - earth;
  sample.angular_rate = against_earth - frame;
  sample.angular_acceleration = R_antenna_body_ * angular_acceleration + against_earth.cross(earth) +
                                sample.angular_rate.cross(frame) - R_antenna_ned * local.angular_acceleration_ned;
  return sample;
}

}  // namespace vbar::grand
