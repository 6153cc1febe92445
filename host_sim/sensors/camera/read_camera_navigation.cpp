#include <algorithm>

#include "fsw/math/math.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {
namespace {

using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr double kArcsecond = fsw::math::kDegree / 3600.0;

/// initial_sigma_a_da_m and so on: 1 sigma of the mean ROE of an unknown formation, times the reference semi-major
/// axis.
fsw::Vector6 read_initial_sigmas(const TableReader& section) {
  const Range sigma_m = above_to(0.0, 1e5);
  const double a = section.number("initial_sigma_a_da_m", sigma_m, 1.0);
  const double lambda = section.number("initial_sigma_a_dlambda_m", sigma_m, 100.0);
  const double e = section.number("initial_sigma_a_de_m", sigma_m, 5.0);
  const double i = section.number("initial_sigma_a_di_m", sigma_m, 5.0);
  return {a, lambda, e, e, i, i};
}

void read_angles_only(const TableReader& section, CameraShared& shared) {
  vbar::angles_only_configuration& navigation = shared.angles_only;
  navigation.detection_sigmas = section.number("detection_threshold_sigma", from_to(2.0, 100.0), 5.0);
  navigation.centroid_floor_px = section.number("centroid_floor_px", above_to(0.0, 10.0), 0.05);
  navigation.pointing_tolerance =
      kArcsecond * section.number("pointing_tolerance_arcsec", above_to(0.0, 36000.0), 600.0);
  navigation.brightness_offset_m = section.number("brightness_offset_m", from_to(0.0, 100.0), 0.15);
  navigation.centroid_noise_m = section.number("centroid_noise_m", from_to(0.0, 100.0), 0.08);
  navigation.bearing_bias = kArcsecond * section.number("bearing_bias_arcsec", above_to(0.0, 3600.0), 3.0);
  navigation.batch_images = static_cast<std::int32_t>(section.integer("batch_images", 3, 1000, 30));
  section.finish();
}

void read_pose(const TableReader& section, vbar::pose_configuration& navigation) {
  navigation.keypoint_sigma_scale = section.number("keypoint_sigma_scale", above_to(0.0, 100.0), 1.0);
  navigation.keypoint_floor_px = section.number("keypoint_floor_px", from_to(0.0, 100.0), 0.2);
  std::ranges::copy(read_initial_sigmas(section), navigation.start_sigma_a_roe_m);
  navigation.start_images = static_cast<std::int32_t>(section.integer("initial_poses", 1, 12, 3));
  section.finish();
}

}  // namespace

std::shared_ptr<const mission::SharedSettings> read_camera_shared(const TableReader& document,
                                                                  const mission::Mission& /*mission*/) {
  auto shared = std::make_shared<CameraShared>();
  const TableReader navigation = document.table("navigation");
  read_angles_only(navigation.table("angles_only"), *shared);
  read_pose(navigation.table("pose"), shared->pose);
  return shared;
}

}  // namespace vbar::sensors
