// vbar_fit_ephemerides: precise orbits and clocks of GPS satellites (SP3) to a RINEX navigation file.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/flown_gnss/ephemeris_fit.h"
#include "host_sim/twins/gnss/ephemeris_file.h"

namespace {

using namespace vbar;

struct Options {
  std::vector<std::string> orbits;
  std::string antennas, broadcast, out;
  flown_gnss::FitSettings settings;
};

std::string text_in(const std::string& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the file", file));
  return stream.str();
}

int fit(const Options& options) {
  std::vector<orbit_files::OrbitFile> files;
  for (const std::string& orbit : options.orbits) files.push_back(orbit_files::load_orbits(orbit));
  flown_gnss::PhaseCentres centres;
  if (!options.antennas.empty())
    centres = flown_gnss::read_phase_centres(text_in(options.antennas), options.antennas,
                                             files.front().tracks.front().states.front().time);
  flown_gnss::Fit result = flown_gnss::fit_ephemerides(files, options.settings, centres);
  twins::gnss::BroadcastCorrections corrections;
  if (!options.broadcast.empty()) {
    const auto broadcast = twins::gnss::read_ephemeris_file(options.broadcast);
    corrections = broadcast.corrections;
    for (flown_gnss::FittedSet& set : result.sets) {
      const auto same =
          std::ranges::find(broadcast.satellites, set.elements.satellite, &twins::gnss::Ephemeris::satellite);
      if (same != broadcast.satellites.end()) set.elements.group_delay_s = same->group_delay_s;
    }
  }
  double orbit_m = 0.0, orbit_squares = 0.0, clock_m = 0.0, clock_squares = 0.0;
  for (const flown_gnss::FittedSet& set : result.sets) {
    orbit_m = std::max(orbit_m, set.orbit_max_m);
    clock_m = std::max(clock_m, set.clock_max_m);
    orbit_squares += set.orbit_rms_m * set.orbit_rms_m;
    clock_squares += set.clock_rms_m * set.clock_rms_m;
  }
  const auto count = static_cast<double>(result.sets.size());
  fmt::print("{} sets; orbit {:.3f} m rms, {:.3f} m at most; clock {:.3f} m rms, {:.3f} m at most; left out: {}\n",
             result.sets.size(), std::sqrt(orbit_squares / count), orbit_m, std::sqrt(clock_squares / count), clock_m,
             result.left_out.size());
  for (const std::string& reason : result.left_out) fmt::print("  {}\n", reason);
  files::replace_text_file(options.out, flown_gnss::rinex_navigation(result.sets, corrections));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Fits GPS broadcast elements to precise orbits and clocks (SP3) and writes them as RINEX navigation file.");
  app.add_option("orbits", options.orbits, "SP3 files of consecutive days")->required();
  app.add_option("--out", options.out, "file to write")->required();
  app.add_option("--antennas", options.antennas, "ANTEX file: distance of the antennas from the centres of mass");
  app.add_option("--broadcast", options.broadcast, "broadcast file whose group delays and ionosphere are taken over");
  app.add_option("--period", options.settings.period_s, "seconds between reference times")
      ->check(CLI::Range(900.0, 14400.0));
  app.add_option("--orbit-arc", options.settings.orbit_arc_s, "seconds of positions of a set")
      ->check(CLI::Range(5400.0, 21600.0));
  app.add_option("--clock-arc", options.settings.clock_arc_s, "seconds of clocks of a set")
      ->check(CLI::Range(900.0, 21600.0));
  CLI11_PARSE(app, argc, argv);
  try {
    return fit(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vbar_fit_ephemerides: {}\n", files::printable(error.what()));
    return 1;
  }
}
