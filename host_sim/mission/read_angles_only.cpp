#include "fsw/math/math.h"
#include "host_sim/mission/read_apriori.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

constexpr double kArcsecond = fsw::math::kDegree / 3600.0;

// The mission's choice: a relative state of two-line-element quality, 1 km along track and 200 m across.
const fsw::Vector6 kTwoLineElements{30.0, 1000.0, 200.0, 200.0, 200.0, 200.0};

}  // namespace

void read_angles_only(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("angles_only");
  section.accept_only({"detection_sigmas", "centroid_floor_px", "pointing_tolerance_arcsec", "acceleration_psd",
                       "acceleration_psd_least", "acceleration_psd_most", "brightness_offset_m", "maneuver_sigma_mmps",
                       "maneuver_sigma_percent", "batch_images", "apriori"});
  AnglesOnly& navigation = mission.angles_only;
  navigation.detection_sigmas = section.number("detection_sigmas", from_to(2.0, 100.0), 5.0);
  navigation.centroid_floor_px = section.number("centroid_floor_px", above_to(0.0, 10.0), 0.05);
  navigation.pointing_tolerance =
      kArcsecond * section.number("pointing_tolerance_arcsec", above_to(0.0, 36000.0), 600.0);
  const Range psd = above_to(0.0, 1e-3);
  navigation.acceleration_psd = section.number("acceleration_psd", psd, 1e-14);
  navigation.acceleration_psd_least = section.number("acceleration_psd_least", psd, 1e-15);
  navigation.acceleration_psd_most = section.number("acceleration_psd_most", psd, 1e-11);
  if (navigation.acceleration_psd < navigation.acceleration_psd_least ||
      navigation.acceleration_psd > navigation.acceleration_psd_most)
    section.refuse("acceleration_psd", "a start outside its limits",
                   "a number from acceleration_psd_least to acceleration_psd_most");
  navigation.brightness_offset_m = section.number("brightness_offset_m", from_to(0.0, 100.0), 0.15);
  navigation.maneuver_sigma = 1e-3 * section.number("maneuver_sigma_mmps", above_to(0.0, 1e3), 0.002);
  navigation.maneuver_sigma_relative = 1e-2 * section.number("maneuver_sigma_percent", from_to(0.0, 100.0), 0.2);
  navigation.batch_images = static_cast<int>(section.integer("batch_images", 3, 1000, 30));
  navigation.apriori_sigma_a_roe_m = read_apriori(section.table("apriori"), kTwoLineElements);
}

}  // namespace vbar::mission
