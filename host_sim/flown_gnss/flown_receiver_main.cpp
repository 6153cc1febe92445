// vbar_flown_receiver: the recorded receiver of a mission, or its twin on the same orbit, through the own-orbit
// navigation of the flight software, against a published orbit.

#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/flown_gnss/flown_receiver.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/truth/force_list.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss/recorded_receiver.h"

namespace {

using namespace vbar;
using flown_gnss::ErrorSums;
using flown_gnss::FlownResult;
using twins::gnss::RecordedReceiver;

struct Options {
  std::string mission, orbit, object, log, csv;
  std::vector<std::string> overrides;
  bool is_twin = false, is_beside_twin = false, omits_gravity = false;
  double from_h = 0.0, hours = 24.0;
  flown_gnss::FlownSettings settings;
};

const mission::Spacecraft& servicer_of(const mission::Mission& mission) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft)
    if (spacecraft.flight_computer && mission::find_settings<sensors::GnssSensor>(spacecraft) != nullptr)
      return spacecraft;
  throw std::runtime_error(fmt::format("{}: found no spacecraft with a flight computer and sensors.gnss, expected one",
                                       mission.file.string()));
}

std::unique_ptr<twins::gnss::ReceiverBytes> make_twin(const mission::Mission& mission, const std::string& name,
                                                      twins::gnss::GnssReceiverSettings settings, double antenna_up_m,
                                                      fsw::GpsTime first) {
  settings.body_frame.antenna_in_body_m = {0.0, 0.0, antenna_up_m};
  settings.body_frame.boresight_in_body = fsw::Vector3::UnitZ();
  const auto& sky = mission::shared_settings<sensors::GnssShared>(mission).constellation;
  auto constellation =
      std::make_shared<const twins::gnss::Constellation>(mission::data_directory(), sky, first, mission.seed);
  return std::make_unique<twins::gnss::GnssReceiver>(settings, constellation, mission::data_directory(), mission.seed,
                                                     name);
}

std::shared_ptr<const truth::EarthOrientationSeries> earth_orientation_of(const mission::Mission& mission) {
  truth::TruthSettings settings = mission.truth;
  settings.data_directory = mission::data_directory();
  truth::ForceData data;
  load_earth_orientation(settings, data);
  for (const std::string& note : data.notes) fmt::print("{}\n", note);
  return data.earth_orientation;
}

void print_row(const std::string& name, const ErrorSums& sums) {
  if (sums.epochs == 0) return;
  const fsw::Vector3 mean = sums.mean_rtn_m(), rms = sums.rms_rtn_m();
  fmt::print("{:>8} {:>7} {:>8.2f} {:>6.2f} {:>6.2f} {:>7.2f} {:>6.2f} {:>6.2f} {:>7.2f} {:>6.2f} {:>6.2f} {:>9.2f}\n",
             name, sums.epochs, sums.rms_m(), sums.mean_nees(), sums.mean_nis(), mean.x(), mean.y(), mean.z(), rms.x(),
             rms.y(), rms.z(), sums.point_rms_m());
}

void print_errors(const FlownResult& result) {
  fmt::print("Own orbit less the published one (m, RTN); NEES and NIS of 3 expected\n");
  fmt::print("{:>8} {:>7} {:>8} {:>6} {:>6} {:>7} {:>6} {:>6} {:>7} {:>6} {:>6} {:>9}\n", "hour", "epochs", "rms 3D",
             "NEES", "NIS", "mean R", "T", "N", "rms R", "T", "N", "point 3D");
  const std::size_t hours = result.errors.hours().size();
  for (std::size_t hour = 0; hour < hours; ++hour) print_row(fmt::format("{}", hour), result.errors.hours()[hour]);
  constexpr std::size_t kHalf = 12;
  if (hours > kHalf) {
    print_row("0 to 11", result.errors.of(0, kHalf));
    print_row("12 on", result.errors.of(kHalf, hours));
  }
  print_row("all", result.errors.of(0, hours));
  fmt::print("single points: {} used, {} rejected; {} epochs without one\n", result.counters.used,
             result.counters.rejected, result.counters.no_solution);
}

void print_signals(const FlownResult& result) {
  const flown_gnss::SignalStatistics& signals = result.signals;
  fmt::print(
      "\nNoise by elevation (1 sigma): code of L1 and L2 and L1 less L2 carrier by combinations without geometry; "
      "ranges less geometry\n");
  fmt::print("{:>11} {:>8} {:>9} {:>9} {:>12} {:>8}\n", "elevation", "ranges", "code L1 m", "code L2 m", "carrier mm",
             "range m");
  for (std::size_t k = 0; k < flown_gnss::kElevationBins; ++k) {
    if (result.ranges[k].count == 0) continue;
    const int from_deg = flown_gnss::kFirstElevation_deg + flown_gnss::kBinWidth_deg * static_cast<int>(k);
    fmt::print("{:>4} to {:>3} {:>8} {:>9.3f} {:>9.3f} {:>12.2f} {:>8.2f}\n", from_deg,
               from_deg + flown_gnss::kBinWidth_deg, result.ranges[k].count, signals.code_l1().bins[k].sigma(),
               signals.code_l2().bins[k].sigma(), 1e3 * signals.carrier()[k].sigma(), result.ranges[k].sigma());
  }
  fmt::print("{:>11} {:>8} {:>9.3f} {:>9.3f} {:>12.2f} {:>8.2f}\n", "all", sum_of(result.ranges).count,
             sum_of(signals.code_l1().bins).sigma(), sum_of(signals.code_l2().bins).sigma(),
             1e3 * sum_of(signals.carrier()).sigma(), sum_of(result.ranges).sigma());
  fmt::print("correlation of code after 1, 2, 6, 12, 30 epochs:");
  for (const flown_gnss::SignalNoise* noise : {&signals.code_l1(), &signals.code_l2()}) {
    fmt::print("{}", noise == &signals.code_l1() ? " L1" : "; L2");
    for (const std::size_t lag : {1, 2, 6, 12, 30}) fmt::print(" {:.2f}", noise->correlation.at(lag));
  }
  fmt::print(
      "\n{} arcs, {:.1f} h of satellites on both carriers, {:.1f} satellites an epoch; {} steps of L1 less L2 "
      "above 5 cm in 10 s without a loss of lock\n",
      signals.arcs(), signals.satellite_hours(),
      static_cast<double>(result.satellites) / static_cast<double>(result.epochs), signals.steps());
}

void print_comparison(const FlownResult& flown, const FlownResult& twin) {
  fmt::print("\n{:>60} {:>8} {:>8} {:>8} {:>8}\n", "Flown receiver and twin", "values", "flown", "twin", "ratio");
  for (const flown_gnss::ComparedFigure& figure : compare(flown, twin))
    fmt::print("{:>60} {:>8} {:>8.3f} {:>8.3f} {:>8.2f}\n", figure.name, figure.count, figure.flown, figure.twin,
               figure.ratio());
}

void print_recording(const RecordedReceiver& receiver) {
  const twins::gnss::RecordingCounts& c = receiver.counts();
  const auto& file = receiver.file_counts();
  fmt::print(
      "\nRecording: {} epochs sent, {} between calls, {} without a whole millisecond; {} calls without an epoch in "
      "{} gaps; {} power failures, {} events, {} slip records\n",
      c.epochs, c.epochs_between, c.epochs_untimed, c.missing, c.gaps, file.power_failures, file.events,
      file.slip_records);
  fmt::print(
      "{} observations, {} satellites without code; {} acquisitions of a carrier, {} losses of lock while it was "
      "tracked",
      c.observations, c.without_code, c.acquisitions, c.losses_of_lock);
  for (const auto& [system, count] : c.other_systems) fmt::print("; not used of system {}: {}", system, count);
  fmt::print("\n");
}

int run(Options options) {
  const mission::Mission mission = sensors::load_mission(options.mission, options.overrides);
  const mission::Spacecraft& servicer = servicer_of(mission);
  const sensors::GnssSensor& gnss = *mission::find_settings<sensors::GnssSensor>(servicer);
  options.settings.antenna_up_m = gnss.receiver.body_frame.antenna_in_body_m.norm();
  options.settings.period_s = gnss.receiver.output.period_s;
  options.settings.begin_s = 3600.0 * options.from_h;
  options.settings.duration_s = 3600.0 * options.hours;
  flown_gnss::GivenOrbit orbit(options.orbit, options.object, earth_orientation_of(mission));
  const double omitted = flown_gnss::omitted_gravity_psd(orbit.at(orbit.first()).position_eci.norm());
  if (options.omits_gravity) options.settings.filter.acceleration_psd = omitted;
  const auto twin = [&] {
    return make_twin(mission, servicer.name, gnss.receiver, options.settings.antenna_up_m, orbit.first());
  };
  std::unique_ptr<twins::gnss::ReceiverBytes> receiver;
  const RecordedReceiver* recorded = nullptr;
  if (options.is_twin) {
    receiver = twin();
  } else if (!options.log.empty()) {
    receiver = std::make_unique<flown_gnss::LoggedReceiver>(options.log, servicer.number,
                                                            fsw::nearest_duration(options.settings.period_s));
  } else if (gnss.source == sensors::kRinex) {
    auto made = std::make_unique<RecordedReceiver>(gnss.recording, mission::data_directory());
    recorded = made.get();
    receiver = std::move(made);
  } else {
    throw std::runtime_error(fmt::format("{}: found the source {} of sensors.gnss, expected rinex, --twin or --log",
                                         mission.file.string(), gnss.source));
  }
  fmt::print(
      "Process noise of the own orbit: {:.1e} m^2/s^3; gravity beyond degree 20 here by Kaula's rule: {:.1e}\n\n",
      options.settings.filter.acceleration_psd, omitted);
  const FlownResult result = fly(orbit, *receiver, options.settings);
  if (result.epochs == 0) throw std::runtime_error("no epoch of the receiver lies within the orbit");
  print_errors(result);
  print_signals(result);
  if (recorded != nullptr) print_recording(*recorded);
  if (options.is_beside_twin) print_comparison(result, fly(orbit, *twin(), options.settings));
  if (!options.csv.empty()) files::replace_text_file(options.csv, result.errors.csv());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Flies the recorded receiver of a mission, or its twin on the same orbit, through the own-orbit navigation "
      "of the flight software and compares the result with a published orbit.");
  app.add_option("mission", options.mission, "mission file whose servicer has sensors.gnss")->required();
  app.add_option("--orbit", options.orbit, "published orbit: SP3, OEM")->required();
  app.add_option("--object", options.object, "name of the spacecraft in it");
  app.add_flag("--twin", options.is_twin, "the receiver is the twin with the settings of the mission");
  app.add_option("--log", options.log, "the receiver is that of a run on this orbit: its packets.lcmlog");
  app.add_flag("--beside-twin", options.is_beside_twin, "flies the twin as well and prints the figures of both");
  app.add_option("--set", options.overrides, "PATH=VALUE of a key of the mission");
  app.add_option("--from-hours", options.from_h, "begin, after the first state of the orbit")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--hours", options.hours, "from that begin on")->check(CLI::Range(0.1, 1000.0));
  app.add_flag("--omitted-gravity", options.omits_gravity, "process noise: gravity beyond degree 20 at this altitude");
  app.add_option("--slow-error-sigma", options.settings.filter.slow_error_sigma_m,
                 "slow error of single points, each axis, m");
  app.add_option("--broadcast-sigma", options.settings.range_errors.broadcast_sigma_m,
                 "error of satellite orbits and clocks in a range, m");
  app.add_option("--ionosphere-sigma", options.settings.range_errors.ionosphere_sigma_m,
                 "ionosphere in a range of one frequency, m");
  app.add_option("--csv", options.csv, "table of the epochs to write");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vbar_flown_receiver: {}\n", files::printable(error.what()));
    return 1;
  }
}
