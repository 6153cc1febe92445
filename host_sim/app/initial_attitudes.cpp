#include "host_sim/app/initial_attitudes.h"

#include <stdexcept>

#include "host_sim/mission/body_file.h"

namespace vbar::app {
namespace {

/// From what a mission file says of one spacecraft's attitude to what the truth takes.
struct SettingsOf {
  const mission::Mission& mission;
  const mission::Spacecraft& spacecraft;
  const std::filesystem::path& data_directory;

  truth::AttitudeSettings operator()(const mission::Tumble& tumble) const {
    truth::TumbleSettings settings;
    settings.body = mission::load_body(data_directory / "bodies" / (tumble.body + ".toml"));
    if (tumble.inertia_kgm2) settings.body.inertia_kgm2 = *tumble.inertia_kgm2;
    settings.torques = tumble.torques;
    settings.drag_coefficient = spacecraft.surface.drag_coefficient;
    settings.start = mission::start_of(tumble, mission.seed, spacecraft.name);
    return settings;
  }

  truth::AttitudeSettings operator()(const mission::Inertial& inertial) const {
    return truth::InertialSettings{inertial.q_body_eci ? *inertial.q_body_eci
                                                       : mission::drawn_attitude(mission.seed, spacecraft.name)};
  }

  truth::AttitudeSettings operator()(const truth::PointedSettings& pointed) const { return pointed; }

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
    const truth::AttitudeSettings settings =
        std::visit(SettingsOf{mission, spacecraft, data_directory}, *spacecraft.attitude);
    try {
      truth.set_attitude(truth.index_of(spacecraft.name), settings);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("spacecraft \"" + spacecraft.name + "\", attitude: " + error.what());
    }
  }
}

}  // namespace vbar::app
