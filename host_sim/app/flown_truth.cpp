#include "host_sim/app/flown_truth.h"

#include <stdexcept>
#include <variant>

#include "host_sim/app/initial_attitudes.h"
#include "host_sim/app/initial_orbits.h"
#include "host_sim/truth/extrapolation.h"

namespace vbar::app {

FlownTruth::FlownTruth(const mission::Mission& mission, const mission::Spacecraft& servicer,
                       const std::filesystem::path& data_directory)
    : epoch_(mission.epoch),
      truth_(truth_settings(mission, data_directory)),
      earth_rotation_(truth_.data().earth_orientation, mission.epoch),
      is_pointed_(servicer.attitude && std::holds_alternative<mission::Commanded>(*servicer.attitude)) {
  place_spacecraft(mission, data_directory, truth_);
  set_attitudes(mission, data_directory, truth_);
  servicer_ = truth_.index_of(servicer.name);
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    names_.push_back(spacecraft.name);
    indices_.push_back(truth_.index_of(spacecraft.name));
  }
}

twins::TruthSnapshot FlownTruth::snapshot(twins::TruthDetail detail) {
  twins::TruthSnapshot truth;
  truth.time = truth_.time();
  truth.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(mission_seconds(truth.time));
  for (std::size_t k = 0; k < names_.size(); ++k) {
    const std::size_t index = indices_[k];
    twins::SpacecraftTruth& one = truth.spacecraft.emplace_back();
    one.name = names_[k];
    one.orbit = truth_.state(index);
    if (truth_.has_attitude(index)) one.attitude = truth_.attitude(index);
    if (detail == twins::TruthDetail::kAccelerations) add_accelerations(index, one);
  }
  return truth;
}

// The angular one by a difference of second order into the past, as far as the attitude is kept.
void FlownTruth::add_accelerations(std::size_t index, twins::SpacecraftTruth& one) const {
  one.acceleration_eci = truth_.acceleration_eci(index, one.orbit);
  if (!one.attitude) return;
  constexpr double kStep_s = 0.05;
  const auto rate = [&](int steps) {
    return truth_.attitude_at(index, truth_.time() - fsw::nearest_duration(steps * kStep_s)).rate_body;
  };
  try {
    one.angular_acceleration_body = (3.0 * one.attitude->rate_body - 4.0 * rate(1) + rate(2)) / (2.0 * kStep_s);
  } catch (const std::out_of_range&) {
    one.angular_acceleration_body = std::nullopt;  // the attitude began less than a tenth of a second ago
  }
}

twins::TruthSnapshot FlownTruth::at(fsw::GpsTime time) {
  const fsw::Duration ahead = time - truth_.time();
  if (ahead < fsw::Duration{} || ahead > kHorizon)
    throw std::out_of_range("the truth's outlook reaches one second ahead");
  twins::TruthSnapshot truth = snapshot(twins::TruthDetail::kAccelerations);
  truth.time = time;
  truth.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(mission_seconds(time));
  const double dt = fsw::seconds(ahead);
  for (std::size_t k = 0; k < names_.size(); ++k) {
    twins::SpacecraftTruth& one = truth.spacecraft[k];
    one.orbit = truth_.state_ahead(indices_[k], time);
    one.acceleration_eci = truth_.acceleration_eci(indices_[k], one.orbit);
    if (!one.attitude) continue;
    one.attitude =
        truth::attitude_ahead(*one.attitude, one.angular_acceleration_body.value_or(fsw::Vector3::Zero()), dt);
  }
  return truth;
}

void FlownTruth::point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) {
  if (is_pointed_) static_cast<void>(truth_.command_pointing(servicer_, time, boresight_rtn, boresight_rate_rtn));
}

}  // namespace vbar::app
