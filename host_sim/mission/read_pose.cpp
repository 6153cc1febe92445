#include "host_sim/mission/read_apriori.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

// From what navigation by angles only leaves at 100 m.
const fsw::Vector6 kHandedOver{0.05, 0.5, 0.1, 0.1, 0.1, 0.1};

}  // namespace

void read_pose(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("pose");
  section.accept_only({"keypoint_sigma_scale", "keypoint_floor_px", "acceleration_psd", "acceleration_psd_least",
                       "acceleration_psd_most", "angular_acceleration_psd", "maneuver_sigma_mmps",
                       "maneuver_sigma_percent", "start_images", "start_sigma_a_da_m", "start_sigma_a_dlambda_m",
                       "start_sigma_a_de_m", "start_sigma_a_di_m", "apriori"});
  PoseNavigation& navigation = mission.pose;
  navigation.keypoint_sigma_scale = section.number("keypoint_sigma_scale", above_to(0.0, 100.0), 1.0);
  navigation.keypoint_floor_px = section.number("keypoint_floor_px", from_to(0.0, 100.0), 0.2);
  const Range psd = above_to(0.0, 1e-3);
  navigation.acceleration_psd = section.number("acceleration_psd", psd, 1e-13);
  navigation.acceleration_psd_least = section.number("acceleration_psd_least", psd, 1e-14);
  navigation.acceleration_psd_most = section.number("acceleration_psd_most", psd, 1e-11);
  if (navigation.acceleration_psd < navigation.acceleration_psd_least ||
      navigation.acceleration_psd > navigation.acceleration_psd_most)
    section.refuse("acceleration_psd", "a start outside its limits",
                   "a number from acceleration_psd_least to acceleration_psd_most");
  navigation.angular_acceleration_psd = section.number("angular_acceleration_psd", psd, 1e-11);
  navigation.maneuver_sigma = 1e-3 * section.number("maneuver_sigma_mmps", above_to(0.0, 1e3), 0.002);
  navigation.maneuver_sigma_relative = 1e-2 * section.number("maneuver_sigma_percent", from_to(0.0, 100.0), 0.2);
  const Range sigma = above_to(0.0, 1e5);
  const double e = section.number("start_sigma_a_de_m", sigma, 5.0),
               i = section.number("start_sigma_a_di_m", sigma, 5.0);
  navigation.start_sigma_a_roe_m << section.number("start_sigma_a_da_m", sigma, 1.0),
      section.number("start_sigma_a_dlambda_m", sigma, 100.0), e, e, i, i;
  navigation.apriori_sigma_a_roe_m.setZero();
  if (section.has("apriori")) navigation.apriori_sigma_a_roe_m = read_apriori(section.table("apriori"), kHandedOver);
  navigation.start_images = static_cast<int>(section.integer("start_images", 1, 12, 3));
}

}  // namespace vbar::mission
