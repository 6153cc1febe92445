// The attitudes of the truth model, with inputs from the spacecraft's own orbit and forces.

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/attitude/air_and_light.h"
#include "host_sim/truth/attitude/attitude_sequence.h"
#include "host_sim/truth/attitude/spacecraft_attitude.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::truth {
namespace {

/// Air and light on facets do not depend on the sphere that represents a spacecraft in the forces on its orbit.
constexpr SurfaceProperties kAnySphere{1.0, 1.0, 1.0, 1.0, 1.0};

bool has_torque(const AttitudeSettings& settings, TorqueKind kind) {
  const auto* tumble = std::get_if<TumbleSettings>(&settings);
  return tumble != nullptr && std::ranges::find(tumble->torques, kind) != tumble->torques.end();
}

}  // namespace

std::unique_ptr<AttitudeMotion> TruthModel::attitude_motion(std::size_t index, const AttitudeSettings& settings) {
  SpacecraftPropagator* const own = spacecraft_.at(index).get();
  AttitudeSurroundings surroundings;
  surroundings.gm = own->dynamics().gm();
  surroundings.tolerance = settings_.tolerance;
  surroundings.seconds = seconds_after_epoch(time_);
  surroundings.orbit = [own](double seconds) { return own->surroundings_at(seconds); };
  surroundings.own = [own](double seconds) { return own->motion_at(seconds); };
  surroundings.sun = [own](double seconds) { return own->dynamics().sun_eci_at(seconds); };
  if (const auto* pointed = std::get_if<PointedSettings>(&settings);
      pointed != nullptr && !pointed->spacecraft.empty()) {
    const SpacecraftPropagator* const other = spacecraft_[index_of(pointed->spacecraft)].get();
    if (other == own) {
      throw std::invalid_argument(fmt::format("spacecraft \"{}\" cannot point at itself", own->name()));
    }
    surroundings.other = [other](double seconds) { return other->motion_at(seconds); };
  }
  if (has_torque(settings, TorqueKind::kRadiation)) {
    own->dynamics().provide_sun_and_moon();
    surroundings.sunlight = std::make_unique<SunlightOfRadiationPressure>(
        std::make_unique<RadiationPressureForce>(kAnySphere, settings_.forces.shadow));
  }
  if (has_torque(settings, TorqueKind::kAerodynamic)) {
    load_atmosphere(settings_, data_);
    surroundings.air = std::make_unique<AirOfDrag>(std::make_unique<DragForce>(
        kAnySphere, data_.atmosphere, data_.space_weather, settings_.forces.geomagnetic_index, settings_.epoch));
  }
  return make_attitude(settings, std::move(surroundings));
}

void TruthModel::set_attitude(std::size_t index, const AttitudeSettings& settings,
                              const std::vector<LaterAttitudeSettings>& later) {
  std::unique_ptr<AttitudeMotion> first = attitude_motion(index, settings);
  std::vector<AttitudeSequence::Later> following;
  for (const LaterAttitudeSettings& one : later) {
    const auto* const pointed = std::get_if<PointedSettings>(&one.attitude);
    if (pointed != nullptr && !pointed->spacecraft.empty()) {
      throw std::invalid_argument("an attitude that follows another one cannot point at a spacecraft");
    }
    auto motion = attitude_motion(
        index, std::visit([](const auto& settings_of_one) { return AttitudeSettings(settings_of_one); }, one.attitude));
    if (one.from_s <= seconds_after_epoch(time_)) {
      first = std::move(motion);
    } else {
      following.push_back({one.from_s, one.slew_s, std::move(motion)});
    }
  }
  if (!following.empty()) first = std::make_unique<AttitudeSequence>(std::move(first), std::move(following));
  spacecraft_.at(index)->set_attitude(std::move(first));
}

bool TruthModel::command_pointing(std::size_t index, fsw::GpsTime time, const fsw::Vector3& boresight_rtn,
                                  const fsw::Vector3& boresight_rate_rtn) {
  SpacecraftPropagator& spacecraft = *spacecraft_.at(index);
  auto* const attitude = dynamic_cast<CommandedAttitude*>(spacecraft.attitude());
  if (attitude == nullptr) {
    throw std::logic_error(fmt::format("the attitude of spacecraft \"{}\" is not commanded", spacecraft.name()));
  }
  const fsw::GpsTime from = std::max(time, time_);
  const double led_s = std::min(fsw::seconds(from - time), kLongestLine_s);
  return attitude->take({seconds_after_epoch(from), boresight_rtn + led_s * boresight_rate_rtn, boresight_rate_rtn});
}

AttitudeState TruthModel::attitude_at(std::size_t index, fsw::GpsTime time) const {
  return spacecraft_.at(index)->attitude_at(seconds_after_epoch(time));
}

}  // namespace vbar::truth
