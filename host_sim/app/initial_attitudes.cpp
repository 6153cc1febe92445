#include "host_sim/app/initial_attitudes.h"

#include <stdexcept>
#include <vector>

#include "host_sim/mission/body_file.h"

namespace vbar::app {
namespace {

/// Converts the attitude of one spacecraft from the mission file to the settings of the truth.
struct SettingsOf {
  const mission::Mission& mission;
  const mission::Spacecraft& spacecraft;
  const std::filesystem::path& data_directory;

  truth::AttitudeSettings operator()(const mission::Tumble& tumble) const {
    truth::TumbleSettings settings;
    settings.body = mission::load_body(mission::body_file_of(data_directory, tumble.body));
    if (tumble.inertia_kgm2) settings.body.inertia_kgm2 = *tumble.inertia_kgm2;
    settings.torques = tumble.torques;
    settings.drag_coefficient = spacecraft.surface.drag_coefficient;
    settings.start = mission::start_of(tumble, mission.seed, spacecraft.name);
    return settings;
  }

  truth::InertialSettings operator()(const mission::Inertial& inertial) const {
    return truth::InertialSettings{inertial.q_body_eci ? *inertial.q_body_eci
                                                       : mission::drawn_attitude(mission.seed, spacecraft.name)};
  }

  truth::PointedSettings operator()(const truth::PointedSettings& pointed) const { return pointed; }

  truth::AttitudeSettings operator()(const mission::Commanded& commanded) const {
    return truth::CommandedSettings{
        commanded.axes, mission::drawn_control_error(mission.seed, spacecraft.name, commanded.control_error)};
  }
};

}  // namespace

void set_attitudes(const mission::Mission& mission, const std::filesystem::path& data_directory,
                   truth::TruthModel& truth) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (!spacecraft.attitude) continue;
    const SettingsOf settings_of{mission, spacecraft, data_directory};
    const auto settings =
        std::visit([&](const auto& one) { return truth::AttitudeSettings(settings_of(one)); }, *spacecraft.attitude);
    std::vector<truth::LaterAttitudeSettings> later;
    for (const mission::LaterAttitude& one : spacecraft.later_attitudes) {
      truth::LaterAttitudeSettings& added = later.emplace_back();
      added.from_s = one.from_s;
      added.slew_s = one.slew_s;
      std::visit([&](const auto& profile) { added.attitude = settings_of(profile); }, one.profile);
    }
    try {
      truth.set_attitude(truth.index_of(spacecraft.name), settings, later);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("spacecraft \"" + spacecraft.name + "\", attitude: " + error.what());
    }
  }
}

}  // namespace vbar::app
