#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "host_sim/cli/command_line.h"
#include "host_sim/cli/commands.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/load.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/orbit_fit/record.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/initial_state.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {

namespace {

using namespace orbit_fit;

constexpr double kDay_s = 86400.0, kHour_s = 3600.0;

struct FitOptions {
  std::filesystem::path mission;  ///< its forces, and the surface of its spacecraft
  std::filesystem::path orbit;    ///< file of the positions
  std::string object;             ///< in the file; empty: its only one
  std::string spacecraft;         ///< in the mission; empty: its only one
  std::string from;               ///< UTC; empty: the first position
  double days = 0.0;              ///< length of the arc; 0: to the last position
  double predict_days = 0.0;      ///< beyond the arc
  std::vector<std::string> fix;   ///< drag, radiation: scales that stay 1
  double drag_hours = 0.0;        ///< 0: one drag scale
  bool empirical = false;
  double empirical_hours = 0.0;  ///< 0: one set
  std::vector<std::string> burns;
  std::size_t find_burns = 0;
  std::string burn_axes = "RTN";
  bool no_ocean_tides = false;
  std::filesystem::path out;  ///< empty: runs/<spacecraft>-fit
  bool quiet = false;
  std::vector<std::string> overrides;  ///< "path=value"
};

const mission::Spacecraft& spacecraft_of(const mission::Mission& mission, const std::string& name) {
  if (!name.empty()) {
    const mission::Spacecraft* const one = mission.find_spacecraft(name);
    if (one == nullptr) throw Refused(fmt::format("--spacecraft: the mission has no spacecraft \"{}\"", name));
    return *one;
  }
  if (mission.spacecraft.size() != 1)
    throw Refused(fmt::format("--spacecraft is missing: the mission has {} spacecraft; accepted: the name of one",
                              mission.spacecraft.size()));
  return mission.spacecraft.front();
}

fsw::GpsTime time_of(const std::string& option, const std::string& text) {
  try {
    return truth::gps_from_utc(text);
  } catch (const std::exception& error) {
    throw Refused(fmt::format("{}: {}", option, error.what()));
  }
}

/// "UTC,R,T,N" or "UTC,R,T,N,DURATION", m/s and s.
Burn burn_of(const std::string& text, fsw::GpsTime epoch) {
  const std::vector<std::string_view> parts = files::split_at(text, ',');
  Burn burn;
  std::vector<double> numbers;
  for (std::size_t k = 1; k < parts.size(); ++k)
    if (const auto number = files::number_of(parts[k])) numbers.push_back(*number);
  if ((parts.size() != 4 && parts.size() != 5) || numbers.size() + 1 != parts.size() ||
      (numbers.size() == 4 && numbers[3] < 0.0))
    throw Refused(fmt::format("--burn: found \"{}\"; accepted: UTC,R,T,N or UTC,R,T,N,DURATION, in m/s and s", text));
  burn.seconds = fsw::seconds(time_of("--burn", std::string(parts[0])) - epoch);
  burn.dv_rtn = {numbers[0], numbers[1], numbers[2]};
  if (numbers.size() == 4) burn.duration_s = numbers[3];
  return burn;
}

/// The times to read: the arc and what is predicted.
struct Spans {
  ArcSpan arc, whole;
};

Spans spans_of(const orbit_files::OrbitFile& file, const FitOptions& options) {
  ArcSpan wanted;
  if (!options.from.empty()) wanted.from = time_of("--from", options.from);
  const auto days = [](double count) { return fsw::nearest_duration(kDay_s * count); };
  Spans spans{{}, span_of(file, wanted)};
  wanted = spans.whole;
  if (options.days > 0.0) wanted.to = std::min(*spans.whole.to, *spans.whole.from + days(options.days));
  spans.arc = span_of(file, wanted);
  spans.whole.to = std::min(*spans.whole.to, *spans.arc.to + days(options.predict_days));
  return spans;
}

OrbitParameters first_parameters(const FitOptions& options, const Arc& positions, double arc_s) {
  // A last interval shorter than half of the others belongs to the one before.
  const auto intervals = [&](double hours) {
    return hours > 0.0 ? static_cast<std::size_t>(std::max(1.0, std::round(arc_s / (kHour_s * hours)))) : 1;
  };
  OrbitParameters first;
  first.start = positions.first;
  first.drag_scale = {kHour_s * options.drag_hours, std::vector<double>(intervals(options.drag_hours), 1.0)};
  if (options.empirical)
    first.empirical = {kHour_s * options.empirical_hours, std::vector<Empirical>(intervals(options.empirical_hours))};
  for (const std::string& text : options.burns) {
    first.burns.push_back(burn_of(text, positions.epoch));
    const Burn& burn = first.burns.back();
    if (burn.start_s() <= 0.0 || burn.end_s() >= arc_s)
      throw Refused(fmt::format("--burn: {} is not within the arc from {} to {}", text,
                                truth::format_utc(positions.epoch, 0),
                                truth::format_utc(positions.epoch + fsw::nearest_duration(arc_s), 0)));
  }
  return first;
}

Estimated estimated_by(const FitOptions& options, const truth::ForceModel& forces) {
  const auto is_fixed = [&](const char* what) { return std::ranges::find(options.fix, what) != options.fix.end(); };
  Estimated estimated;
  estimated.drag_scale = forces.drag && !is_fixed("drag");
  estimated.radiation_scale = forces.radiation_pressure && !is_fixed("radiation");
  for (std::size_t axis = 0; axis < 3; ++axis)
    estimated.burn_axes[axis] = options.burn_axes.find("RTN"[axis]) != std::string::npos;
  return estimated;
}

int fit_command(const FitOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  const mission::Spacecraft& spacecraft = spacecraft_of(mission, options.spacecraft);
  FitRecord record;
  std::unique_ptr<const FittedDynamics> dynamics;
  try {
    const orbit_files::OrbitFile file = orbit_files::tracks_of(orbit_files::load_orbits(options.orbit), options.object);
    const Spans spans = spans_of(file, options);
    truth::TruthSettings settings = truth_settings(mission, mission::data_directory());
    settings.epoch = *spans.whole.from;
    settings.end = *spans.whole.to;
    dynamics =
        std::make_unique<const FittedDynamics>(settings, spacecraft.name, spacecraft.surface, !options.no_ocean_tides);
    record.mission = mission.name;
    record.spacecraft = spacecraft.name;
    record.file = options.orbit.string();
    record.positions = arc_of(file, spans.whole, dynamics->data().earth_orientation);
    record.arc_s = fsw::seconds(*spans.arc.to - *spans.arc.from);
    record.ocean_tides = !options.no_ocean_tides;
  } catch (const std::exception& error) {
    throw Refused(error.what());
  }
  if (!options.quiet)
    for (const std::string& note : dynamics->data().notes) fmt::print("note: {}\n", note);

  const OrbitParameters first = first_parameters(options, record.positions, record.arc_s);
  const Estimated estimated = estimated_by(options, dynamics->settings().forces);
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const Batch batch(*dynamics, until(record.positions, record.arc_s), threads);
  record.fitted = batch.fit(first, estimated);
  if (options.find_burns > 0)
    record.fitted = fit_with_found_burns(batch, std::move(record.fitted), estimated, options.find_burns);
  record.found_break = find_break(batch, record.fitted, estimated);
  record.residuals_rtn = residuals_rtn(record.positions.positions_eci,
                                       dynamics->propagate(record.fitted.parameters, record.positions.seconds));
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("runs") / (spacecraft.name + "-fit") : options.out;
  const std::string no_mission = write_fit(folder, record, *dynamics);
  if (!options.quiet) fmt::print("{}", fit_table(record));
  if (!options.quiet && !no_mission.empty()) fmt::print("note: {}\n", no_mission);
  if (!options.quiet) fmt::print("fit  {}\n", folder.string());
  return kDone;
}

}  // namespace

void add_fit_command(CLI::App& program, int& exit_code) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* command = program.add_subcommand("fit", "fit an orbit to the positions of a file, with a mission's forces");
  command
      ->add_option("mission", options->mission,
                   "mission file (TOML), or a name that vbar missions lists: its forces, and mass and areas of its "
                   "spacecraft")
      ->required();
  command->add_option("orbit", options->orbit, "file of positions: SP3 or CCSDS OEM")->required();
  command->add_option("--object", options->object, "object of the file; its only one unless given");
  command->add_option("--spacecraft", options->spacecraft, "spacecraft of the mission; its only one unless given");
  command->add_option("--from", options->from, "UTC at which the arc begins; the first position unless given");
  command->add_option("--days", options->days, "length of the arc; to the last position unless given")
      ->check(number_from(0.0));
  command->add_option("--predict", options->predict_days, "days behind the arc to predict and compare with the file")
      ->check(number_from(0.0));
  command->add_option("--fix", options->fix, "a scale that is not estimated: drag or radiation; may be given again")
      ->check(CLI::IsMember({"drag", "radiation"}))
      ->allow_extra_args(false);
  command->add_option("--drag-hours", options->drag_hours, "hours of each drag scale; one for the arc unless given")
      ->check(number_from(0.0));
  command->add_flag("--empirical", options->empirical,
                    "estimate accelerations along track, constant and once per revolution, and across track, once per "
                    "revolution");
  command->add_option("--empirical-hours", options->empirical_hours, "hours of each set; one for the arc unless given")
      ->check(number_from(0.0));
  command
      ->add_option("--burn", options->burns,
                   "a burn to estimate from this guess: UTC,R,T,N or UTC,R,T,N,DURATION in m/s and s; may be given "
                   "again")
      ->allow_extra_args(false);
  command->add_option("--find-burns", options->find_burns, "find up to this number of burns and estimate them");
  command->add_option("--burn-axes", options->burn_axes, "axes of the burns that are estimated (default RTN)")
      ->check(CLI::IsMember({"R", "T", "N", "RT", "RN", "TN", "RTN"}));
  command->add_flag("--no-ocean-tides", options->no_ocean_tides, "leave out the ocean tides, which a mission has not");
  command->add_option("--out", options->out, "folder; runs/<spacecraft>-fit unless given");
  command->add_flag("--quiet", options->quiet, "print nothing but errors");
  command->add_option("--set", options->overrides, "a key of the mission file and its value; may be given again")
      ->allow_extra_args(false);
  command->callback([options, &exit_code] { exit_code = fit_command(*options); });
}

}  // namespace vbar::app
