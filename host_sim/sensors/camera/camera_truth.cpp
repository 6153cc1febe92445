#include "host_sim/sensors/camera/camera_truth.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/sun.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::sensors {

TrueCamera true_camera(const CameraSensor& camera, const twins::SpacecraftTruth& servicer) {
  const Eigen::Quaterniond& q_body_eci = servicer.attitude->q_body_eci;
  return {servicer.orbit.position_eci + q_body_eci.conjugate() * camera.position_body_m,
          camera.q_camera_body * q_body_eci};
}

std::optional<Eigen::Vector2d> pixel_of(const twins::camera::CameraSettings& settings, const fsw::Vector3& los_camera) {
  if (!(los_camera.z() > 0.1 * los_camera.norm())) return std::nullopt;
  const auto& [k1, k2, p1, p2, k3] = settings.optics.distortion;
  const double x = los_camera.x() / los_camera.z(), y = los_camera.y() / los_camera.z(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double f = settings.focal_length_px();
  return Eigen::Vector2d(
      settings.optics.principal_point_px[0] + f * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)),
      settings.optics.principal_point_px[1] + f * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y));
}

fsw::Matrix6 symmetric(const double (&lower_triangle)[21]) {
  fsw::Matrix6 matrix;
  std::size_t place = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column) matrix(row, column) = matrix(column, row) = lower_triangle[place++];
  return matrix;
}

std::optional<double> normalised_square(const fsw::Vector6& error, const fsw::Matrix6& covariance) {
  const Eigen::LLT<fsw::Matrix6> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return factor.matrixL().solve(error).squaredNorm();
}

std::optional<double> nees_of_roe(const double (&a_roe_m)[6], const double (&covariance_m2)[21],
                                  const fsw::orbit::CartesianState& servicer,
                                  const fsw::orbit::CartesianState& target) {
  const auto chief = fsw::orbit::qns_from_cartesian(servicer), deputy = fsw::orbit::qns_from_cartesian(target);
  if (!chief.ok() || !deputy.ok()) return std::nullopt;
  const fsw::Vector6 error = Eigen::Map<const fsw::Vector6>(a_roe_m) -
                             chief.value().a * fsw::orbit::roe_from_qns(chief.value(), deputy.value());
  return normalised_square(error, symmetric(covariance_m2));
}

namespace {

using Eigen::Quaterniond;
using fsw::Vector3;

using fsw::math::kArcsecond;
/// A bearing farther off than this from all of a spacecraft is the bearing of another object.
constexpr double kSameObject_px = 3.0;

Vector3 vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How far from the direction to a spacecraft's centre of mass a bearing may be that is the spacecraft's, rad.
double same_object(const twins::camera::CameraSettings& settings, double range_m) {
  return kSameObject_px / settings.focal_length_px() + kSpacecraftRadius_m / range_m;
}

/// The object nearest to where the target really is, if it is near enough to be it; -1: none.
int true_object(const telemetry_objects& objects, const Eigen::Vector2d& target_px, double tolerance_px) {
  int nearest = -1;
  double least = tolerance_px;
  const int count = std::min<int>(objects.count, std::size(objects.x_px));
  for (int k = 0; k < count; ++k) {
    const double distance = (Eigen::Vector2d(objects.x_px[k], objects.y_px[k]) - target_px).norm();
    if (!(distance <= least)) continue;
    least = distance;
    nearest = k;
  }
  return nearest;
}

/// The spacecraft in the direction of a bearing, nearest first by what its size allows.
std::string spacecraft_at(const Vector3& bearing_eci, const TrueCamera& camera, const std::string& servicer,
                          const twins::camera::CameraSettings& settings, const twins::TruthSnapshot& truth) {
  std::string found = "nothing";
  double least = 1.0;
  for (const twins::SpacecraftTruth& other : truth.spacecraft) {
    if (other.name == servicer) continue;
    const Vector3 los = camera.towards(other);
    const double share = angle_between(bearing_eci, los) / same_object(settings, los.norm());
    if (!(share <= least)) continue;
    least = share;
    found = other.name;
  }
  return found;
}

void add_bearing_error(ImageRow& row, const Vector3& bearing_eci, const Vector3& los_eci,
                       const Quaterniond& q_camera_eci) {
  const Vector3 los = (q_camera_eci * los_eci).normalized(), bearing = q_camera_eci * bearing_eci;
  const Vector3 x = Vector3::UnitY().cross(los).normalized(), y = los.cross(x);
  row.bearing_error_x_arcsec = std::atan2(bearing.dot(x), bearing.dot(los)) / kArcsecond;
  row.bearing_error_y_arcsec = std::atan2(bearing.dot(y), bearing.dot(los)) / kArcsecond;
}

void add_attitude_error(ImageRow& row, const Quaterniond& q_eci_camera, const Quaterniond& q_camera_eci) {
  const Eigen::AngleAxisd turn(q_camera_eci * q_eci_camera.normalized());
  const Vector3 error = turn.angle() * turn.axis();
  row.attitude_error_across_arcsec = std::hypot(error.x(), error.y()) / kArcsecond;
  row.attitude_error_roll_arcsec = std::abs(error.z()) / kArcsecond;
}

}  // namespace

void add_truth(ImageRow& row, const telemetry_image& image, const telemetry_objects* objects, const CameraSensor& known,
               const mission::Spacecraft& servicer, const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const own = truth.find(servicer.name);
  const twins::SpacecraftTruth* const target = truth.find(servicer.observes());
  if (own == nullptr || target == nullptr || !own->attitude) return;
  const TrueCamera camera = true_camera(known, *own);
  const Vector3 los_eci = camera.towards(*target);
  row.range_m = los_eci.norm();
  row.sunlit = twins::camera::sunlit_fraction(target->orbit.position_eci, fsw::orbit::sun_position_gcrf(truth.time));
  const Vector3 bearing_eci = vector(image.bearing_eci);
  if (image.status == telemetry_image::kStatusBearing && bearing_eci.norm() > 0.5) {
    add_bearing_error(row, bearing_eci, los_eci, camera.q_camera_eci);
    row.chosen = spacecraft_at(bearing_eci, camera, servicer.name, known.settings, truth);
  }
  if (image.star_method != telemetry_image::kStarMethodNone) {
    const double(&q)[4] = image.q_eci_camera;
    add_attitude_error(row, {q[0], q[1], q[2], q[3]}, camera.q_camera_eci);
  }
  const twins::camera::CameraSettings& settings = known.settings;
  const auto target_px = pixel_of(settings, camera.q_camera_eci * los_eci);
  if (objects != nullptr && target_px) {
    const double tolerance_px = settings.focal_length_px() * same_object(settings, *row.range_m);
    row.true_object = true_object(*objects, *target_px, tolerance_px);
  }
  if (image.fate == telemetry_image::kEditFilter)
    row.nees = nees_of_roe(image.a_roe_osculating_m, image.covariance_a_roe, own->orbit, target->orbit);
}

namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr int kKeypoints = 11;

Quaterniond quaternion(const double (&q)[4]) {
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

/// Rotation vector from one attitude to the other, in the axes of `from`'s right-hand frame: to = from * exp(turn).
Vector3 turn_between(const Quaterniond& from, const Quaterniond& to) {
  const Eigen::AngleAxisd turn(from.conjugate() * to);
  const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
  return angle * turn.axis();
}

void add_pnp_error(PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
                   const Vector3& position_camera) {
  const Vector3 error = Eigen::Map<const Vector3>(pose.pnp_position_camera_m) - position_camera;
  row.pnp_error_x_m = error.x();
  row.pnp_error_y_m = error.y();
  row.pnp_error_z_m = error.z();
  row.pnp_error_deg = q_camera_body.angularDistance(quaternion(pose.pnp_q_camera_body)) / kDegree;
}

void add_attitude_error(PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
                        const Vector3& rate_body) {
  const Vector3 turn = turn_between(q_camera_body, quaternion(pose.q_camera_body));
  row.attitude_error_deg = turn.norm() / kDegree;
  row.attitude_error_x_deg = turn.x() / kDegree;
  row.attitude_error_y_deg = turn.y() / kDegree;
  row.attitude_error_z_deg = turn.z() / kDegree;
  const Vector3 rate = Eigen::Map<const Vector3>(pose.rate_body) - rate_body;
  row.rate_error_radps = rate.norm();
  fsw::Vector6 error;
  error << turn, rate;
  row.attitude_nees = normalised_square(error, symmetric(pose.covariance_attitude));
}

}  // namespace

void append_keypoints(double exposure_s, const telemetry_pose& m, std::vector<KeypointRow>& rows) {
  for (int k = 0; k < kKeypoints; ++k) {
    KeypointRow row;
    row.time_s = exposure_s;
    row.image = m.image;
    row.keypoint = k;
    row.fate = m.keypoint_fate[k];
    row.peak = m.peak[k];
    row.x_px = m.x_px[k];
    row.y_px = m.y_px[k];
    row.covariance_xx_px2 = m.covariance_px2[3 * k];
    row.covariance_xy_px2 = m.covariance_px2[3 * k + 1];
    row.covariance_yy_px2 = m.covariance_px2[3 * k + 2];
    rows.push_back(row);
  }
}

void add_truth(PoseRow& row, std::vector<KeypointRow>& keypoints, const telemetry_pose& pose,
               const double (&keypoints_body_m)[33], const CameraSensor& known, const mission::Spacecraft& servicer,
               const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const own = truth.find(servicer.name);
  const twins::SpacecraftTruth* const target = truth.find(servicer.observes());
  if (own == nullptr || target == nullptr || !own->attitude || !target->attitude) return;
  const TrueCamera camera = true_camera(known, *own);
  const Vector3 position_camera = camera.q_camera_eci * camera.towards(*target);
  const Quaterniond q_camera_body = camera.q_camera_eci * target->attitude->q_body_eci.conjugate();
  row.range_m = position_camera.norm();
  row.sunlit = twins::camera::sunlit_fraction(target->orbit.position_eci, fsw::orbit::sun_position_gcrf(truth.time));
  if (pose.pnp_inliers > 0) add_pnp_error(row, pose, q_camera_body, position_camera);
  if (pose.filter_runs != 0 && row.images_used > 0) {
    if (pose.has_attitude != 0) add_attitude_error(row, pose, q_camera_body, target->attitude->rate_body);
    if (pose.fate == telemetry_pose::kEditKeypoints)
      row.nees = nees_of_roe(pose.a_roe_osculating_m, pose.covariance_a_roe, own->orbit, target->orbit);
  }
  for (int k = 0; k < kKeypoints; ++k) {
    KeypointRow& keypoint = keypoints[keypoints.size() - kKeypoints + static_cast<std::size_t>(k)];
    const Vector3 at_body = Eigen::Map<const Vector3>(keypoints_body_m + 3 * k);
    const auto pixel = pixel_of(known.settings, position_camera + q_camera_body * at_body);
    if (keypoint.fate == telemetry_pose::kKeypointUnusable || !pixel) continue;
    keypoint.error_x_px = static_cast<double>(keypoint.x_px) - pixel->x();
    keypoint.error_y_px = static_cast<double>(keypoint.y_px) - pixel->y();
  }
}

}  // namespace vbar::sensors
