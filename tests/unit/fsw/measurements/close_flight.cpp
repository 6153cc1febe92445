#include "tests/unit/fsw/measurements/close_flight.h"

#include <cmath>
#include <memory>
#include <stdexcept>

#include <Eigen/Dense>

#include "fsw/filter/propagation.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "host_sim/truth/attitude/torques.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"
#include "tests/support/tango_view.h"

namespace vbar::test {

namespace {

using fsw::Vector3;
using fsw::Vector6;
namespace orbit = fsw::orbit;

constexpr double kDegree = fsw::math::kDegree;
constexpr double kA = 7078138.944;

template <class T>
T must(const fsw::Result<T>& result) {
  if (!result.ok()) throw std::runtime_error("no orbit");
  return result.value();
}

Vector6 metres(double da, double dl, double dex, double dey, double dix, double diy) {
  return (Vector6() << da, dl, dex, dey, dix, diy).finished();
}

/// From one waypoint to the next by burns at equal times: of all that lead there, those of the least sum of squares.
void plan_leg(const orbit::QnsElements& servicer_mean, double from_s, double to_s, const Vector6& start,
              const Vector6& goal, fsw::GpsTime epoch, std::vector<fsw::filter::Burn>& burns) {
  constexpr int kBurns = 5;
  Eigen::MatrixXd reach(6, 3 * kBurns);
  const auto at = [&](double t) { return orbit::propagate_secular(servicer_mean, t); };
  const auto moved = [&](double t) { return orbit::roe_transition_j2(at(t), to_s - t); };
  std::array<double, kBurns> times{};
  for (int k = 0; k < kBurns; ++k) {
    times[static_cast<std::size_t>(k)] = from_s + (k + 0.37) / kBurns * (to_s - from_s);
    const double t = times[static_cast<std::size_t>(k)];
    reach.middleCols<3>(3 * k) = -moved(t) * orbit::roe_control_matrix_near_circular(at(t));
  }
  const Vector6 needed = (goal - moved(from_s) * start) / kA;
  const Eigen::VectorXd dv = reach.completeOrthogonalDecomposition().solve(needed);
  for (int k = 0; k < kBurns; ++k) {
    const double t = std::round(times[static_cast<std::size_t>(k)]);
    burns.push_back({epoch + fsw::nearest_duration(t), dv.segment<3>(3 * k)});
  }
}

truth::TruthSettings truth_settings(double hours) {
  truth::TruthSettings settings;
  settings.epoch = truth::gps_from_utc("2011-07-19T16:00:00Z");
  settings.end = settings.epoch + fsw::nearest_duration(hours * 3600.0 + 600.0);
  settings.data_directory = vbar::tests::source_path("data");
  settings.forces = {.drag = true,
                     .geomagnetic_index = truth::GeomagneticIndex::kThreeHourly,
                     .radiation_pressure = true,
                     .shadow = truth::Shadow::kConical,
                     .sun = true,
                     .moon = true,
                     .solid_tides = true,
                     .relativity = true};
  return settings;
}

fsw::Matrix3 tango_inertia() {
  fsw::Matrix3 inertia;
  inertia << 2.685703125, 0.0, 0.0, 0.0, 3.410185625, -0.1206, 0.0, -0.1206, 3.154350833333333;
  return inertia;
}

class ConstantTorque final : public truth::Torque {
 public:
  explicit ConstantTorque(const Vector3& torque) : torque_(torque) {}
  [[nodiscard]] std::string_view name() const override { return "constant"; }
  [[nodiscard]] Vector3 torque_body(const truth::ForceInput& /*orbit*/, const truth::AttitudeState& /*a*/) override {
    return torque_;
  }

 private:
  Vector3 torque_;
};

}  // namespace

CloseFlight fly_closely(double hours) {
  const truth::TruthSettings settings = truth_settings(hours);
  truth::TruthModel model(settings);
  const orbit::QnsElements servicer{7087300.0, 0.0015, 0.0, 98.18 * kDegree, 207.0 * kDegree, -122.38 * kDegree};
  const orbit::QnsElements servicer_mean = must(orbit::mean_from_osculating(servicer));
  const Vector6 eight = metres(-0.5, -10.0, 0.0, 2.0, 0.0, 1.0);
  const orbit::QnsElements target_mean = orbit::qns_from_roe(servicer_mean, eight / kA);
  truth::SpacecraftSettings first{"servicer",
                                  {},
                                  {.mass_kg = 154.0,
                                   .drag_area_m2 = 1.3,
                                   .drag_coefficient = 2.5,
                                   .radiation_area_m2 = 2.5,
                                   .radiation_coefficient = 1.32}};
  truth::SpacecraftSettings second{"target",
                                   {},
                                   {.mass_kg = 40.0,
                                    .drag_area_m2 = 0.38,
                                    .drag_coefficient = 2.25,
                                    .radiation_area_m2 = 0.55,
                                    .radiation_coefficient = 1.2}};
  first.osculating = must(orbit::cartesian_from_qns(servicer));
  second.osculating = must(orbit::cartesian_from_qns(must(orbit::osculating_from_mean(target_mean))));
  model.add_spacecraft(first);
  model.add_spacecraft(second);

  CloseFlight flight;
  const Vector6 nine = metres(0.0, -7.0, 1.0, 0.0, 2.0, 0.0);
  const Vector6 ten = metres(0.0, -8.5, 1.0, 0.0, 1.0, 0.0);
  plan_leg(servicer_mean, 0.0, 3600.0, eight, nine, settings.epoch, flight.burns);
  plan_leg(servicer_mean, 3600.0, 8100.0, nine, ten, settings.epoch, flight.burns);
  const auto now = model.data().earth_orientation->at(settings.epoch);
  const auto later = model.data().earth_orientation->at(settings.epoch, 86400.0);
  flight.earth = {.epoch = settings.epoch,
                  .ut1_minus_gps_s = now.ut1_minus_tai_s + 19.0,
                  .ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / 86400.0,
                  .pole_x = now.pole_x,
                  .pole_y = now.pole_y};

  truth::SunMoonInterpolator ephemeris;
  std::size_t next_burn = 0;
  const auto count = static_cast<std::size_t>(hours * 3600.0 / kImagePeriod_s + 1.5);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) * kImagePeriod_s;
    CloseEpoch epoch;
    epoch.time = settings.epoch + fsw::nearest_duration(t);
    for (; next_burn < flight.burns.size() && flight.burns[next_burn].time < epoch.time; ++next_burn) {
      model.advance_to(flight.burns[next_burn].time);
      model.apply_impulse_rtn(0, flight.burns[next_burn].dv_rtn);
    }
    model.advance_to(epoch.time);
    epoch.servicer = model.state(0);
    epoch.target = model.state(1);
    epoch.sun_eci = ephemeris.at(truth::tt_of(settings.epoch, t)).sun_eci.normalized();
    epoch.is_target_lit = fsw::filter::is_sunlit(epoch.target.position_eci, epoch.sun_eci);
    flight.epochs.push_back(epoch);
  }
  return flight;
}

std::vector<fsw::filter::AttitudeState> tumble(const CloseFlight& flight, double rate_deg_s, unsigned seed,
                                               double torque_nm) {
  std::mt19937 random(seed + 1000);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  truth::AttitudeState start;
  start.q_body_eci.coeffs() << draw(), draw(), draw(), draw();
  start.q_body_eci.normalize();
  Vector3 axis;
  axis << draw(), draw(), draw();
  start.rate_body = rate_deg_s * kDegree * axis.normalized();

  const auto orbit_at = [&flight](double seconds) {
    const double place = std::max(seconds, 0.0) / kImagePeriod_s;
    const auto k = std::min(static_cast<std::size_t>(place), flight.epochs.size() - 1);
    const double past = seconds - kImagePeriod_s * static_cast<double>(k);
    const orbit::CartesianState& state = flight.epochs[k].target;
    truth::ForceInput input{};
    input.position_eci = state.position_eci + past * state.velocity_eci;
    input.velocity_eci = state.velocity_eci;
    return input;
  };
  std::vector<std::unique_ptr<truth::Torque>> torques;
  torques.push_back(std::make_unique<truth::GravityGradientTorque>(3.986004415e14, tango_inertia()));
  const Vector3 direction(draw(), draw(), draw());
  torques.push_back(std::make_unique<ConstantTorque>(torque_nm * direction.normalized()));
  truth::RigidBody body(tango_inertia(), std::move(torques), orbit_at, 1e-9, 0.0, start);
  std::vector<fsw::filter::AttitudeState> attitudes;
  for (std::size_t k = 0; k < flight.epochs.size(); ++k) {
    const double t = kImagePeriod_s * static_cast<double>(k);
    body.advance_to(t);
    const truth::AttitudeState state = body.state_at(t);
    attitudes.push_back({state.q_body_eci.conjugate(), state.rate_body});
  }
  return attitudes;
}

CloseFlightCamera close_flight_camera() {
  CloseFlightCamera camera;
  camera.optics.focal_length_px = {1450.5, 1450.5};
  camera.optics.principal_point_px = {479.5, 299.5};
  camera.optics.distortion = {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243};
  camera.position_camera_m = {0.1, -0.05, 0.35};
  camera.inertia = must(fsw::filter::inertia_of(tango_inertia()));
  camera.shape = tango_shape();
  return camera;
}

Vector6 mean_a_roe_m(const orbit::CartesianState& servicer, const orbit::CartesianState& target) {
  const auto mean_of = [](const orbit::CartesianState& state) {
    return must(orbit::mean_from_osculating(must(orbit::qns_from_cartesian(state))));
  };
  const orbit::QnsElements chief = mean_of(servicer);
  return chief.a * orbit::roe_from_qns(chief, mean_of(target));
}

namespace {

using fsw::Matrix3;
using fsw::Vector2;
namespace pose = fsw::pose;

constexpr double kArcsec = kDegree / 3600.0;

Matrix3 turn(const Vector3& by) {
  const double angle = by.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() : Matrix3(Matrix3::Identity());
}

/// z to the target, turned about it by the orbit's normal, off by a little.
Matrix3 camera_to(const fsw::orbit::CartesianState& servicer, const fsw::orbit::CartesianState& target) {
  const Vector3 z = (target.position_eci - servicer.position_eci).normalized();
  const Vector3 x = z.cross(servicer.position_eci).normalized();
  Matrix3 R_camera_eci;
  R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_camera_eci;
}

}  // namespace

SimulatedNetwork::SimulatedNetwork(const CloseFlight& flight, const std::vector<fsw::filter::AttitudeState>& attitudes,
                                   const KeypointErrors& errors, unsigned seed)
    : flight_(flight), attitudes_(attitudes), errors_(errors), random_(seed) {
  attitude_bias_ = 0.7 * errors.attitude_arcsec * kArcsec * normal3();
  gnss_slow_ = normal3();
  for (Vector2& lasting : lasting_) lasting = normal3().head<2>();
  for (fsw::filter::Burn burn : flight.burns) {
    burn.dv_rtn += errors.burn_relative * burn.dv_rtn.norm() * normal3();
    known_burns_.push_back(burn);
  }
}

const MeasuredEpoch& SimulatedNetwork::measure(std::size_t index, const Eigen::Quaterniond& turned) {
  const CloseEpoch& truth = flight_.epochs[index];
  epoch_ = {};
  epoch_.time = truth.time;
  epoch_.sun_eci = truth.sun_eci;
  const double keep = std::exp(-kImagePeriod_s / 600.0);
  gnss_slow_ = keep * gnss_slow_ + std::sqrt(1.0 - keep * keep) * normal3();
  epoch_.servicer_position_eci = truth.servicer.position_eci + gnss_slow_ + 0.5 * normal3();

  const Matrix3 R_camera_eci =
      turn(errors_.pointing_deg * kDegree * normal3()) * camera_to(truth.servicer, truth.target);
  epoch_.R_camera_eci = turn(attitude_bias_ + 0.7 * errors_.attitude_arcsec * kArcsec * normal3()) * R_camera_eci;
  pose::TargetPose seen;
  seen.R_camera_body = R_camera_eci * (attitudes_[index].q_eci_body * turned).toRotationMatrix();
  seen.position_camera_m =
      R_camera_eci * (truth.target.position_eci - truth.servicer.position_eci) - camera_.position_camera_m;
  see_keypoints(seen);
  if (errors_.has_dark && !truth.is_target_lit) return epoch_;
  epoch_.keypoints = &keypoints_;
  solve_pose(seen);
  return epoch_;
}

void SimulatedNetwork::see_keypoints(const pose::TargetPose& seen) {
  const double keep = std::exp(-kImagePeriod_s / errors_.lasting_time_s);
  const double lasting_sigma = errors_.sigma_px * std::sqrt(errors_.lasting_share);
  const double white_sigma = errors_.sigma_px * std::sqrt(1.0 - errors_.lasting_share);
  const auto& camera = camera_.optics;
  const auto centre = fsw::imaging::pixel_of(camera, seen.position_camera_m);
  for (std::size_t k = 0; k < keypoints_.size(); ++k) {
    const Vector2 renewed = normal3().head<2>();
    const Vector2 white = normal3().head<2>();
    const Vector2 stray(uniform() - 0.5, uniform() - 0.5);
    const double chance = uniform();
    lasting_[k] = keep * lasting_[k] + std::sqrt(1.0 - keep * keep) * renewed;
    const auto pixel = fsw::imaging::pixel_of(camera, seen.position_camera_m + seen.R_camera_body * camera_.shape[k]);
    pose::Keypoint& keypoint = keypoints_[k];
    keypoint.is_usable = pixel.ok() && centre.ok() && chance > errors_.unseen_share;
    if (!keypoint.is_usable) continue;
    is_stray_[k] = chance > 1.0 - errors_.outlier_share;
    keypoint.pixel = pixel.value() + lasting_sigma * lasting_[k] + white_sigma * white +
                     errors_.stretch * (pixel.value() - centre.value());
    if (is_stray_[k]) keypoint.pixel = centre.value() + 250.0 * stray;
    keypoint.covariance_px2 = errors_.told_px * errors_.told_px * fsw::Matrix2::Identity();
    keypoint.peak = 0.5;
  }
}

/// As perspective n points would: the pose of least squares of the keypoints that are none of the strays, from the
/// truth on; at times turned half about.
void SimulatedNetwork::solve_pose(const pose::TargetPose& truth) {
  constexpr double kStep = 1e-6;
  const auto& camera = camera_.optics;
  pose::TargetPose pose = truth;
  pose::PnpSolution solution;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for (int round = 0; round < 4; ++round) {
    normal.setZero();
    Vector6 right = Vector6::Zero();
    solution.inliers = 0;
    for (std::size_t k = 0; k < keypoints_.size(); ++k) {
      solution.is_inlier[k] = keypoints_[k].is_usable && !is_stray_[k];
      if (!solution.is_inlier[k]) continue;
      ++solution.inliers;
      const auto predicted = [&](const Vector6& change) -> Vector2 {
        const Vector3 point =
            turn(change.head<3>()) * pose.R_camera_body * camera_.shape[k] + pose.position_camera_m + change.tail<3>();
        return fsw::imaging::pixel_of(camera, point).value();
      };
      Eigen::Matrix<double, 2, 6> slope;
      for (int i = 0; i < 6; ++i) {
        slope.col(i) = (predicted(kStep * Vector6::Unit(i)) - predicted(-kStep * Vector6::Unit(i))) / (2.0 * kStep);
      }
      normal += slope.transpose() * slope;
      right += slope.transpose() * (keypoints_[k].pixel - predicted(Vector6::Zero()));
    }
    if (solution.inliers < 6) return;
    const Vector6 change = normal.ldlt().solve(right);
    pose.R_camera_body = turn(change.head<3>()) * pose.R_camera_body;
    pose.position_camera_m += change.tail<3>();
  }
  if (uniform() < errors_.flip_share) {
    const int axis = static_cast<int>(3.0 * uniform());
    pose.R_camera_body = pose.R_camera_body * turn(M_PI * Vector3::Unit(axis));
  }
  solution.pose = pose;
  solution.covariance = errors_.told_px * errors_.told_px * normal.inverse();
  solution.mean_square = 1.0;
  epoch_.pnp = solution;
}

}  // namespace vbar::test
