#include "fsw/navigation/filter_configuration.h"

#include "fsw/math/math.h"
#include "fsw/measurements/source_list.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/elements.h"
#include "fsw/orbit/finite_burn.h"

namespace vbar::fsw::navigation {
namespace {

using messaging::is_between;
using messaging::is_positive;

constexpr double kLargestARoe = 1e6;  // m; beyond it the relative-orbit models are not valid
constexpr double kLongestPause_s = 3600.0;

// A limit of the process noise above that of two like spacecraft states larger differential accelerations: drag, a
// state of its own, begins with the acceleration that the limit stands for over a revolution.
constexpr double kLikeSpacecraftPsd = 1e-11;  // m^2/s^3
constexpr double kRevolution_s = 6000.0;

/// Bits of all sources of the list.
template <class... Source>
constexpr std::int32_t bits_of(const std::tuple<Source...>* /*list*/) {
  return (Source::kUse | ...);
}
constexpr std::int32_t kAllSources = bits_of(static_cast<const measurements::SourceList*>(nullptr));

}  // namespace

bool is_valid(const navigation_configuration& c) {
  const bool is_alone = c.sources == navigation_configuration::kUseIdeal;
  const bool has_ideal = (c.sources & navigation_configuration::kUseIdeal) != 0;
  return (c.sources & ~kAllSources) == 0 && has_ideal == is_alone && is_positive(c.acceleration_psd, 1.0) &&
         is_positive(c.acceleration_psd_least, c.acceleration_psd) &&
         is_between(c.acceleration_psd_most, c.acceleration_psd, 1.0) && is_positive(c.acceleration_sigma, 1.0) &&
         is_positive(c.acceleration_time_s, 1e6);
}

bool is_valid(const earth_configuration& c) {
  return messaging::is_usable(GpsTime{c.epoch_ns}) && math::abs(c.ut1_minus_gps_s) < 100.0 &&
         math::abs(c.ut1_rate) < 1e-6 && math::abs(c.pole_x) < 1e-4 && math::abs(c.pole_y) < 1e-4;
}

bool is_valid(const thruster_configuration& c) {
  const bool is_impulsive = c.thrust_acceleration == 0.0;
  return is_positive(c.sigma_mps, 1.0) && is_between(c.sigma_relative, 0.0, 1.0) &&
         (is_impulsive ||
          is_between(c.thrust_acceleration, orbit::kLeastThrustAcceleration, orbit::kMostThrustAcceleration)) &&
         is_between(c.pause_s, 0.0, kLongestPause_s);
}

bool is_valid(const target_apriori& a) {
  const Vector6 sigma_a_roe_m = messaging::vector(a.sigma_a_roe_m);
  if (!((sigma_a_roe_m.array() > 0.0).all() && (sigma_a_roe_m.array() < kLargestARoe).all())) return false;
  switch (a.kind) {
    case target_apriori::kKindOrbit:
      return orbit::qns_from_cartesian({messaging::vector(a.position_eci), messaging::vector(a.velocity_eci)}).ok();
    case target_apriori::kKindRoe:
      return (messaging::vector(a.mean_a_roe_m).array().abs() < kLargestARoe).all();
    default:
      return false;
  }
}

filter::FilterSettings filter_settings(const messaging::Telecommands& telecommands) {
  filter::FilterSettings settings;
  if (const auto* earth = telecommands.in_force<earth_configuration>()) {
    settings.earth = {.epoch = GpsTime{earth->epoch_ns},
                      .ut1_minus_gps_s = earth->ut1_minus_gps_s,
                      .ut1_rate = earth->ut1_rate,
                      .pole_x = earth->pole_x,
                      .pole_y = earth->pole_y};
  }
  if (const auto* thruster = telecommands.in_force<thruster_configuration>()) {
    settings.burn_sigma = thruster->sigma_mps;
    settings.burn_sigma_relative = thruster->sigma_relative;
  }
  if (const auto* navigation = telecommands.in_force<navigation_configuration>()) {
    settings.relative_orbit.acceleration = {navigation->acceleration_psd, navigation->acceleration_psd_least,
                                            navigation->acceleration_psd_most};
    settings.relative_orbit.empirical = {.sigma = navigation->acceleration_sigma,
                                         .time_s = navigation->acceleration_time_s};
    if (navigation->acceleration_psd_most > kLikeSpacecraftPsd) {
      settings.relative_orbit.drag.sigma = math::sqrt(navigation->acceleration_psd_most / kRevolution_s);
    }
  }
  return settings;
}

filter::TargetApriori apriori_of(const target_apriori& known, GpsTime time) {
  filter::TargetApriori apriori;
  apriori.kind = known.kind == target_apriori::kKindRoe ? filter::TargetApriori::Kind::kMeanRoe
                                                        : filter::TargetApriori::Kind::kAbsoluteOrbit;
  apriori.time = time;
  apriori.target = {messaging::vector(known.position_eci), messaging::vector(known.velocity_eci)};
  apriori.mean_a_roe_m = messaging::vector(known.mean_a_roe_m);
  apriori.sigma_a_roe_m = messaging::vector(known.sigma_a_roe_m);
  return apriori;
}

}  // namespace vbar::fsw::navigation
