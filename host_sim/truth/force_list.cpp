#include "host_sim/truth/force_list.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/truth/forces/solid_tides.h"
#include "host_sim/truth/forces/thrust_force.h"

namespace vbar::truth {

namespace {

constexpr const char* kAtmosphereFile = "atmosphere/nrlmsise00.csv";

/// Returns the note on a tide-free model without the force of the tides.
std::string note_on_permanent_tide(const std::string& model, bool is_added) {
  constexpr std::string_view kSize =
      "some 18 m along the track of a low orbit in a day: programs that use the file's C20 differ by that";
  if (is_added)
    return fmt::format(
        "The gravity model {} is tide-free: the permanent deformation of the Earth, {:.2e} of C20 (IERS Conventions "
        "2010, 6.2.2), is added, {}; truth.permanent_tide = false leaves it out.",
        model, permanent_tide_c20(), kSize);
  return fmt::format(
      "The gravity model {} is tide-free and used as published: the permanent deformation of the Earth, {:.2e} of C20 "
      "(IERS Conventions 2010, 6.2.2), acts on no spacecraft, an error of some 18 m along the track of a low orbit in "
      "a "
      "day.",
      model, permanent_tide_c20());
}

void load_gravity(const TruthSettings& settings, ForceData& data) {
  const std::filesystem::path file = settings.data_directory / settings.gravity_file;
  GravityCoefficients coefficients = load_gravity_coefficients(file, settings.gravity_degree);
  // Without the force of the tides nothing else adds the permanent deformation.
  if (!settings.forces.solid_tides && settings.gravity_degree >= 2 && coefficients.tide_system == "tide_free") {
    if (settings.permanent_tide) coefficients.c[GravityCoefficients::index(2, 0)] += permanent_tide_c20();
    data.notes.push_back(note_on_permanent_tide(coefficients.model, settings.permanent_tide));
  }
  data.gravity = std::make_shared<const GravityField>(coefficients, settings.gravity_degree, settings.gravity_order);
  if (!settings.forces.solid_tides) return;
  try {
    data.tide_system = tide_system_named(coefficients.tide_system);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

/// A force on the surface is proportional to area over mass: both are required, or the force would vanish silently.
void require(const SpacecraftSettings& spacecraft, std::string_view force, std::string_view property, double value) {
  if (value > 0.0) return;
  throw std::invalid_argument(
      fmt::format("spacecraft \"{}\": {} needs {} above 0; it has {}", spacecraft.name, force, property, value));
}

}  // namespace

void load_atmosphere(const TruthSettings& settings, ForceData& data) {
  if (data.atmosphere) return;
  data.atmosphere =
      std::make_shared<const Nrlmsise00Tables>(load_nrlmsise00_tables(settings.data_directory / kAtmosphereFile));
  load_space_weather(settings, data);
}

ForceData load_force_data(const TruthSettings& settings) {
  ForceData data;
  load_gravity(settings, data);
  load_earth_orientation(settings, data);
  if (settings.forces.drag) load_atmosphere(settings, data);
  return data;
}

std::vector<std::unique_ptr<Force>> make_forces(const TruthSettings& settings, const ForceData& data,
                                                const SpacecraftSettings& spacecraft) {
  const ForceModel& model = settings.forces;
  const SurfaceProperties& surface = spacecraft.surface;
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::make_unique<GravityForce>(data.gravity));
  if (model.drag) {
    require(spacecraft, "drag", "mass_kg", surface.mass_kg);
    require(spacecraft, "drag", "drag_area_m2", surface.drag_area_m2);
    require(spacecraft, "drag", "drag_coefficient", surface.drag_coefficient);
    forces.push_back(std::make_unique<DragForce>(surface, data.atmosphere, data.space_weather, model.geomagnetic_index,
                                                 settings.epoch));
  }
  if (model.radiation_pressure) {
    require(spacecraft, "radiation_pressure", "mass_kg", surface.mass_kg);
    require(spacecraft, "radiation_pressure", "radiation_area_m2", surface.radiation_area_m2);
    require(spacecraft, "radiation_pressure", "radiation_coefficient", surface.radiation_coefficient);
    forces.push_back(std::make_unique<RadiationPressureForce>(surface, model.shadow));
  }
  if (model.sun) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun));
  if (model.moon) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon));
  if (model.solid_tides) {
    forces.push_back(std::make_unique<SolidTidesForce>(data.gravity->gm(), data.gravity->radius(), data.tide_system,
                                                       settings.epoch, data.earth_orientation));
  }
  if (spacecraft.burns_last) forces.push_back(std::make_unique<ThrustForce>());
  if (model.relativity) forces.push_back(std::make_unique<RelativityForce>(data.gravity->gm()));
  return forces;
}

namespace {

constexpr const char* kBundledOrientation = "earth/eop_2009_2013.csv";
constexpr const char* kBundledWeather = "earth/space_weather_2009_2013.csv";

/// Longest last step of the integrator, which goes beyond the end by up to its length: a minute or two in a low orbit.
/// A longer one, of a high orbit, that overruns the data is rejected when it happens.
constexpr std::int64_t kLongestStep_s = 3600;

fsw::GpsTime last_instant(const TruthSettings& settings) {
  if (settings.end <= settings.epoch) return settings.epoch;
  return settings.end + fsw::duration_of_seconds(kLongestStep_s);
}

/// Rejects before the run starts an epoch or end for which `look_up` has no data. `look_up` takes an instant and throws
/// std::out_of_range.
template <class LookUp>
void check_reach(const TruthSettings& settings, const std::filesystem::path& file, const LookUp& look_up) {
  const auto check = [&](fsw::GpsTime time, const std::string& what) {
    try {
      look_up(time);
    } catch (const std::out_of_range& error) {
      throw std::out_of_range(fmt::format("{}: {} needs it: {}", file.string(), what, error.what()));
    }
  };
  check(settings.epoch, "the epoch");
  if (settings.end <= settings.epoch) return;
  check(last_instant(settings), fmt::format("the last step of a run that ends at {}", format_utc(settings.end, 0)));
}

/// Whether bundled data serve: false where a file that is named would be rejected.
template <class LookUp>
bool reaches(const TruthSettings& settings, const LookUp& look_up) {
  try {
    check_reach(settings, "", look_up);
    return true;
  } catch (const std::out_of_range&) {
    return false;
  }
}

[[noreturn]] void refuse_prediction(const std::filesystem::path& file, const std::string& what,
                                    const std::string& from) {
  throw std::runtime_error(
      fmt::format("{}: {} is predicted from {} on; accepted are observed values, unless "
                  "truth.accept_predictions is true",
                  file.string(), what, from));
}

/// Error of one sigma of predictions `days` long: IERS Bulletin A, section "Predictions".
double predicted_ut1_sigma_s(double days) {
  return 0.00025 * std::pow(days, 0.75);
}
double predicted_pole_sigma_arcsec(double days) {
  return 0.00068 * std::pow(days, 0.80);
}

constexpr double kMetresPerArcsecond = 6378137.0 * M_PI / 648000.0;  // on the equator
constexpr double kArcsecondsPerSecond = 15.041;                      // rate of the Earth's rotation

void note_predicted_orientation(const TruthSettings& settings, const std::filesystem::path& file, ForceData& data) {
  const auto from = data.earth_orientation->predicted_from();
  if (!from || *from > last_instant(settings)) return;
  if (!settings.accept_predictions) refuse_prediction(file, "Earth orientation", format_utc(*from, 0));
  const double days = std::max(1.0, fsw::seconds(last_instant(settings) - *from) / kSecondsPerDay);
  const double ut1_m = predicted_ut1_sigma_s(days) * kArcsecondsPerSecond * kMetresPerArcsecond;
  const double pole_m = predicted_pole_sigma_arcsec(days) * kMetresPerArcsecond;
  data.notes.push_back(fmt::format(
      "Earth orientation is predicted from {} on; at the end of the run 1 sigma of UT1 is {:.2g} s ({:.2g} m on the "
      "equator), of the pole {:.2g} arcsec ({:.2g} m).",
      format_utc(*from, 0), predicted_ut1_sigma_s(days), ut1_m, predicted_pole_sigma_arcsec(days), pole_m));
}

std::string missing(const TruthSettings& settings, bool is_bundled, const char* bundled, std::string_view what) {
  if (!is_bundled) return fmt::format("The mission uses no {}", what);
  return fmt::format("The data folder has no {} for the run from {} ({} ends before or begins later)", what,
                     format_utc(settings.epoch, 0), bundled);
}

void assume_orientation(const TruthSettings& settings, bool is_bundled, ForceData& data) {
  data.earth_orientation =
      std::make_shared<const EarthOrientationSeries>(EarthOrientationSeries::unknown(settings.epoch));
  constexpr double kLargestUt1_s = 0.9, kLargestPole_arcsec = 0.6;
  data.notes.push_back(fmt::format(
      "{}: UT1 = UTC is assumed, an error of up to {} s ({:.1f} arcsec, {:.0f} m on the equator), and no polar motion, "
      "up to {} arcsec ({:.0f} m); truth.earth_orientation_file names a file (IERS finals2000A, EOP C04).",
      missing(settings, is_bundled, kBundledOrientation, "Earth orientation"), kLargestUt1_s,
      kLargestUt1_s * kArcsecondsPerSecond, kLargestUt1_s * kArcsecondsPerSecond * kMetresPerArcsecond,
      kLargestPole_arcsec, kLargestPole_arcsec * kMetresPerArcsecond));
}

void assume_weather(const TruthSettings& settings, bool is_bundled, ForceData& data) {
  data.space_weather =
      std::make_shared<const SpaceWeather>(SpaceWeather::constant(settings.constant_f107, settings.constant_ap));
  data.notes.push_back(fmt::format(
      "{}: F10.7 = {} and Ap = {} are assumed; between F10.7 of 70 and 230 the density, and drag with it, grows by a "
      "factor of 11 at 400 km and of 36 at 700 km; truth.space_weather_file names a file (CelesTrak SW-All).",
      missing(settings, is_bundled, kBundledWeather, "space weather"), settings.constant_f107, settings.constant_ap));
}

void note_predicted_weather(const TruthSettings& settings, const std::filesystem::path& file, ForceData& data) {
  using Kind = SpaceWeather::Kind;
  const auto first = [&](Kind kind) {
    return data.space_weather->find_first(kind, settings.epoch, last_instant(settings));
  };
  if (const auto* day = first(Kind::kMissing))
    throw std::runtime_error(fmt::format("{}:{}: the row of {} lacks an index or a flux that the run needs",
                                         file.string(), day->line, format_utc(midnight_utc(day->mjd_utc), 0)));
  const auto* const daily = first(Kind::kPredictedDaily);
  const auto* const monthly = first(Kind::kPredictedMonthly);
  const auto* const earliest = daily != nullptr ? daily : monthly;
  if (earliest == nullptr) return;
  const std::string from = format_utc(midnight_utc(earliest->mjd_utc), 0);
  if (!settings.accept_predictions) refuse_prediction(file, "space weather", from);
  std::string note = fmt::format("Space weather is predicted from {} on", from);
  if (monthly != nullptr) {
    note += fmt::format(
        ", from {} by the month, with an assumed Ap of {}: F10.7 may differ by a factor of 1.5, which is one of 2 to 4 "
        "in density",
        format_utc(midnight_utc(monthly->mjd_utc), 0), SpaceWeather::kAssumedAp);
  }
  data.notes.push_back(note + ".");
}

}  // namespace

void load_earth_orientation(const TruthSettings& settings, ForceData& data) {
  const bool is_bundled = settings.earth_orientation_file == TruthSettings::kBundled;
  if (settings.earth_orientation_file == TruthSettings::kNone) return assume_orientation(settings, false, data);
  const std::filesystem::path file =
      settings.data_directory / (is_bundled ? kBundledOrientation : settings.earth_orientation_file);
  data.earth_orientation = std::make_shared<const EarthOrientationSeries>(EarthOrientationSeries::load(file));
  const auto look_up = [&](fsw::GpsTime time) { static_cast<void>(data.earth_orientation->at(time)); };
  if (is_bundled && !reaches(settings, look_up)) return assume_orientation(settings, true, data);
  check_reach(settings, file, look_up);
  note_predicted_orientation(settings, file, data);
}

void load_space_weather(const TruthSettings& settings, ForceData& data) {
  const bool is_bundled = settings.space_weather_file == TruthSettings::kBundled;
  if (settings.space_weather_file == TruthSettings::kConstant) return assume_weather(settings, false, data);
  const std::filesystem::path file =
      settings.data_directory / (is_bundled ? kBundledWeather : settings.space_weather_file);
  data.space_weather = std::make_shared<const SpaceWeather>(SpaceWeather::load(file));
  const auto look_up = [&](fsw::GpsTime time) {
    static_cast<void>(data.space_weather->indices_at(time, settings.forces.geomagnetic_index));
  };
  if (is_bundled && !reaches(settings, look_up)) return assume_weather(settings, true, data);
  check_reach(settings, file, look_up);
  note_predicted_weather(settings, file, data);
}

}  // namespace vbar::truth
