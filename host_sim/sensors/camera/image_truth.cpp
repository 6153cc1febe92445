#include "host_sim/sensors/camera/image_truth.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/sun.h"
#include "host_sim/sensors/camera/true_camera.h"
#include "host_sim/twins/camera/exposure_of_truth.h"

namespace vbar::sensors {
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

}  // namespace vbar::sensors
