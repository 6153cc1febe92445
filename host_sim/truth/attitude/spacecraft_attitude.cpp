#include "host_sim/truth/attitude/spacecraft_attitude.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/attitude/torques.h"

namespace vbar::truth {
namespace {

const std::vector<Facet>& surface_of(const Body& body) {
  if (body.facets.empty()) {
    throw std::invalid_argument(
        fmt::format("torques of air and light need a surface; body \"{}\" has none", body.name));
  }
  return body.facets;
}

std::unique_ptr<Torque> make_torque(TorqueKind kind, const TumbleSettings& settings,
                                    AttitudeSurroundings& surroundings) {
  switch (kind) {
    case TorqueKind::kGravityGradient:
      return std::make_unique<GravityGradientTorque>(surroundings.gm, settings.body.inertia_kgm2);
    case TorqueKind::kAerodynamic:
      return std::make_unique<AerodynamicTorque>(surface_of(settings.body), settings.drag_coefficient,
                                                 std::move(surroundings.air));
    case TorqueKind::kRadiation:
      return std::make_unique<RadiationTorque>(surface_of(settings.body), std::move(surroundings.sunlight));
  }
  throw std::invalid_argument("not a torque");
}

std::unique_ptr<AttitudeMotion> make(const TumbleSettings& settings, AttitudeSurroundings& surroundings) {
  std::vector<std::unique_ptr<Torque>> torques;
  for (const TorqueKind kind : settings.torques) torques.push_back(make_torque(kind, settings, surroundings));
  return std::make_unique<RigidBody>(settings.body.inertia_kgm2, std::move(torques), surroundings.orbit,
                                     surroundings.tolerance, surroundings.seconds, settings.start);
}

std::unique_ptr<AttitudeMotion> make(const InertialSettings& settings, AttitudeSurroundings& /*surroundings*/) {
  return std::make_unique<InertialAttitude>(settings.q_body_eci);
}

std::unique_ptr<AttitudeMotion> make(const PointedSettings& settings, AttitudeSurroundings& surroundings) {
  return std::make_unique<PointingProfile>(settings.pointing, surroundings.own, surroundings.other, surroundings.sun);
}

std::unique_ptr<AttitudeMotion> make(const CommandedSettings& settings, AttitudeSurroundings& surroundings) {
  return std::make_unique<CommandedAttitude>(settings.axes, settings.control_error, surroundings.own);
}

}  // namespace

std::unique_ptr<AttitudeMotion> make_attitude(const AttitudeSettings& settings, AttitudeSurroundings surroundings) {
  return std::visit([&](const auto& some) { return make(some, surroundings); }, settings);
}

}  // namespace vbar::truth
