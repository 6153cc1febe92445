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

/// 1 sigma of mean ROE times the reference semi-major axis, m: of a, lambda, each component of e, each of i.
struct RoeSigmas {
  double a, lambda, e, i;
};
// The mission's choice: a relative state of two-line-element quality, 1 km along track and 200 m across.
constexpr RoeSigmas kTwoLineElements{30.0, 1000.0, 200.0, 200.0};
// What angles-only navigation has reached at 100 m.
constexpr RoeSigmas kAfterAnglesOnly{0.05, 0.5, 0.1, 0.1};

/// <prefix>sigma_a_da_m and so on.
fsw::Vector6 read_roe_sigmas(const TableReader& section, const std::string& prefix, const RoeSigmas& default_value) {
  const Range sigma = above_to(0.0, 1e5);
  const double a = section.number(prefix + "sigma_a_da_m", sigma, default_value.a);
  const double lambda = section.number(prefix + "sigma_a_dlambda_m", sigma, default_value.lambda);
  const double e = section.number(prefix + "sigma_a_de_m", sigma, default_value.e);
  const double i = section.number(prefix + "sigma_a_di_m", sigma, default_value.i);
  return {a, lambda, e, e, i, i};
}

/// The keys that both messages have.
template <class Configuration>
void read_process_noise(const TableReader& section, double psd_default, double psd_min_default,
                        Configuration& configuration) {
  const Range psd = above_to(0.0, 1e-3);
  configuration.acceleration_psd = section.number("acceleration_psd", psd, psd_default);
  configuration.acceleration_psd_least = section.number("acceleration_psd_min", psd, psd_min_default);
  configuration.acceleration_psd_most = section.number("acceleration_psd_max", psd, 1e-11);
  configuration.maneuver_sigma = 1e-3 * section.number("maneuver_sigma_mmps", above_to(0.0, 1e3), 0.002);
  configuration.maneuver_sigma_relative = 1e-2 * section.number("maneuver_sigma_percent", from_to(0.0, 100.0), 0.2);
}

template <class Configuration>
void check_process_noise(const TableReader& section, const Configuration& configuration) {
  if (configuration.acceleration_psd < configuration.acceleration_psd_least ||
      configuration.acceleration_psd > configuration.acceleration_psd_most)
    section.refuse("acceleration_psd", "an initial value outside its limits",
                   "a number from acceleration_psd_min to acceleration_psd_max");
}

void read_angles_only(const TableReader& section, CameraShared& shared) {
  vbar::angles_only_configuration& navigation = shared.angles_only;
  navigation.detection_sigmas = section.number("detection_threshold_sigma", from_to(2.0, 100.0), 5.0);
  navigation.centroid_floor_px = section.number("centroid_floor_px", above_to(0.0, 10.0), 0.05);
  navigation.pointing_tolerance =
      kArcsecond * section.number("pointing_tolerance_arcsec", above_to(0.0, 36000.0), 600.0);
  read_process_noise(section, 1e-14, 1e-15, navigation);
  navigation.brightness_offset_m = section.number("brightness_offset_m", from_to(0.0, 100.0), 0.15);
  navigation.centroid_noise_m = section.number("centroid_noise_m", from_to(0.0, 100.0), 0.08);
  navigation.bearing_bias = kArcsecond * section.number("bearing_bias_arcsec", above_to(0.0, 3600.0), 3.0);
  navigation.batch_images = static_cast<std::int32_t>(section.integer("batch_images", 3, 1000, 30));
  shared.angles_only_apriori_sigma_a_roe_m = read_roe_sigmas(section.table("apriori"), "", kTwoLineElements);
  section.finish();
  check_process_noise(section, navigation);
}

void read_pose(const TableReader& section, vbar::pose_configuration& navigation) {
  navigation.keypoint_sigma_scale = section.number("keypoint_sigma_scale", above_to(0.0, 100.0), 1.0);
  navigation.keypoint_floor_px = section.number("keypoint_floor_px", from_to(0.0, 100.0), 0.2);
  read_process_noise(section, 1e-13, 1e-14, navigation);
  navigation.angular_acceleration_psd = section.number("angular_acceleration_psd", above_to(0.0, 1e-3), 1e-11);
  std::ranges::copy(read_roe_sigmas(section, "initial_", {1.0, 100.0, 5.0, 5.0}), navigation.start_sigma_a_roe_m);
  if (section.has("apriori"))
    std::ranges::copy(read_roe_sigmas(section.table("apriori"), "", kAfterAnglesOnly),
                      navigation.apriori_sigma_a_roe_m);
  navigation.start_images = static_cast<std::int32_t>(section.integer("initial_poses", 1, 12, 3));
  section.finish();
  check_process_noise(section, navigation);
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
