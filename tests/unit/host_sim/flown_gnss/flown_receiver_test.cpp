// GRACE-B's receiver in flight (NASA/GFZ; RINEX, 2010-07-27) through the own-orbit navigation of the flight software,
// against the orbit of the Center for Orbit Determination in Europe (CODE), which is good to some centimetres. The data
// of one hour are in tests/data/flight; the whole day is flown where the published files are: VBAR_FLIGHT_DATA names
// their folder.

#include "host_sim/flown_gnss/flown_receiver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/flown_gnss/ephemeris_fit.h"
#include "host_sim/twins/gnss/recorded_receiver.h"
#include "tests/support/paths.h"

namespace vbar::flown_gnss {
namespace {

using testing::HasSubstr;
using twins::gnss::RecordedReceiver;
using twins::gnss::RecordingSettings;
using twins::gnss::SignalTypes;

const std::filesystem::path& data() {
  static const std::filesystem::path folder(vbar::tests::source_path("tests/data/flight"));
  return folder;
}

RecordingSettings recording() {
  RecordingSettings settings;
  settings.observations = data() / "grace_b.10d";
  settings.navigation = data() / "grace_b.rnx";
  settings.l1 = SignalTypes{"P1", "L1", "S1"};
  settings.l2 = SignalTypes{"P2", "L2", "S2"};
  settings.strength_is_amplitude = true;
  return settings;
}

GivenOrbit given_orbit(const std::filesystem::path& file) {
  return {file, "",
          std::make_shared<const truth::EarthOrientationSeries>(
              truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv")))};
}

/// What the errors are, not what this day shows best: gravity beyond degree 20 at this altitude, and ranges by fitted
/// orbits (5 cm), clocks (7 cm) and the code's multipath.
FlownSettings settings_by_physics(GivenOrbit& orbit) {
  FlownSettings settings;
  settings.antenna_up_m = 0.414;
  settings.filter.acceleration_psd = omitted_gravity_psd(orbit.at(orbit.first()).position_eci.norm());
  settings.filter.slow_error_sigma_m = 0.3;
  settings.range_errors.broadcast_sigma_m = 0.3;
  return settings;
}

TEST(FlownReceiver, FindsTheOrbitIonosphereFree) {
  GivenOrbit orbit = given_orbit(data() / "grace_b.sp3");
  RecordedReceiver receiver(recording(), "");
  const FlownResult result = fly(orbit, receiver, settings_by_physics(orbit));
  EXPECT_EQ(receiver.counts().epochs, 360U);
  EXPECT_EQ(receiver.counts().missing, 0U);
  EXPECT_EQ(result.counters.no_solution, 0);
  const ErrorSums hour = result.errors.of(0, 2);
  EXPECT_EQ(hour.epochs, 359U);  // the first two positions make one orbit
  EXPECT_LT(hour.rms_m(), 1.5);
  EXPECT_LT(hour.point_rms_m(), 2.0);
  // Three degrees of freedom; errors of ranges are correlated over a pass, so an hour holds some ten independent ones.
  EXPECT_GT(hour.mean_nees(), 1.0);
  EXPECT_LT(hour.mean_nees(), 6.0);
  // Code noise of 5 cm above 50 deg (Montenbruck, Kroes 2003, of this kind of receiver), more at lower elevations.
  const ElevationBins& code = result.signals.code_l1().bins;
  EXPECT_LT(code[bin_of(1.0)].sigma(), 0.1);
  EXPECT_GT(code[bin_of(0.2)].sigma(), code[bin_of(1.0)].sigma());
}

TEST(FlownReceiver, FindsTheOrbitWithOneFrequencyAndItsCorrections) {
  GivenOrbit orbit = given_orbit(data() / "grace_b.sp3");
  RecordingSettings single = recording();
  single.l1 = SignalTypes{"C1", "L1", "S1"};
  single.uses_l2 = false;
  const auto rms_m = [&](bool corrects) {
    single.corrects_code = corrects;
    RecordedReceiver receiver(single, "");
    FlownSettings settings = settings_by_physics(orbit);
    settings.filter.slow_error_sigma_m = 1.5;
    return fly(orbit, receiver, settings).errors.of(0, 2).rms_m();
  };
  EXPECT_LT(rms_m(true), rms_m(false));
}

/// Satellite 32 has ranges 16 m too long on all codes from 10:24 to 10:56, and the carriers do not show it.
TEST(FlownReceiver, LeavesOutTheSatelliteWhoseRangesAreWrong) {
  GivenOrbit orbit = given_orbit(data() / "grace_b.sp3");
  RecordedReceiver receiver(recording(), "");
  OwnOrbit navigation({}, {.broadcast_sigma_m = 0.3}, orbit.on_board(), {0.0, 0.0, 0.414});
  std::size_t epochs = 0, left_out = 0;
  for (int step = 60; step < 180; ++step) {
    const twins::gnss::BodyTruth body = orbit.at(orbit.first() + fsw::duration_of_seconds(10 * step));
    const fsw::Matrix3 R_eci_body = body.q_body_eci.toRotationMatrix().transpose();
    navigation.process(receiver.output_at(body).bytes, R_eci_body,
                       [&](const OwnOrbitEpoch& estimate, const fsw::gnss::ObservationEpoch& epoch) {
                         ++epochs;
                         const bool has_it = std::ranges::any_of(
                             std::span(epoch.observations).first(epoch.count),
                             [](const fsw::gnss::Observation& one) { return one.satellite.prn == 32; });
                         if (has_it && estimate.point.ok() && estimate.point.value().used < epoch.count / 2) ++left_out;
                       });
  }
  EXPECT_EQ(epochs, 120U);
  EXPECT_GT(left_out, 110U);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(FlownReceiver, RefusesFilesInOneSentence) {
  const auto error = [](const RecordingSettings& settings) -> std::string {
    try {
      RecordedReceiver receiver(settings, "");
    } catch (const std::exception& what) {
      return what.what();
    }
    return "";
  };
  RecordingSettings missing = recording();
  missing.observations = data() / "absent.10d";
  EXPECT_THAT(error(missing), HasSubstr("absent.10d: cannot open the file"));
  RecordingSettings swapped = recording();
  std::swap(swapped.observations, swapped.navigation);
  EXPECT_THAT(error(swapped), HasSubstr("grace_b.rnx:1: found a file of type"));
  RecordingSettings other = recording();
  other.navigation = data() / "grace_b.sp3";
  EXPECT_THAT(error(other), HasSubstr("grace_b.sp3:1: found"));
}

TEST(FlownReceiver, FindsTheOrbitOfTheWholeDay) {
  const char* const folder = std::getenv("VBAR_FLIGHT_DATA");
  if (folder == nullptr)
    GTEST_SKIP()
        << "VBAR_FLIGHT_DATA names no folder with GRCB2080.10D, COD15941.EPH to COD15943.EPH, igs05.atx and grcb.sp3";
  const std::filesystem::path published(folder);
  std::vector<orbit_files::OrbitFile> files;
  for (const char* day : {"COD15941.EPH", "COD15942.EPH", "COD15943.EPH"})
    files.push_back(orbit_files::load_orbits(published / day));
  const PhaseCentres centres =
      read_phase_centres(text_of(published / "igs05.atx"), "igs05.atx", files[1].tracks.front().states.front().time);
  const Fit fit = fit_ephemerides(files, {}, centres);
  double squares = 0.0;
  for (const FittedSet& set : fit.sets) squares += set.orbit_rms_m * set.orbit_rms_m;
  EXPECT_LT(std::sqrt(squares / static_cast<double>(fit.sets.size())), 0.1);
  const std::filesystem::path navigation = std::filesystem::path(testing::TempDir()) / "vbar_grace_b_day.rnx";
  std::ofstream(navigation) << rinex_navigation(fit.sets);
  RecordingSettings settings = recording();
  settings.observations = published / "GRCB2080.10D";
  settings.navigation = navigation;
  GivenOrbit orbit = given_orbit(published / "grcb.sp3");
  RecordedReceiver receiver(settings, "");
  const FlownResult result = fly(orbit, receiver, settings_by_physics(orbit));
  std::filesystem::remove(navigation);
  // The first half of the day is that on which the settings were chosen.
  const ErrorSums judged = result.errors.of(12, 24);
  EXPECT_EQ(judged.epochs, 4320U);
  EXPECT_LT(judged.rms_m(), 1.5);
  EXPECT_GT(judged.mean_nees(), 2.0);
  EXPECT_LT(judged.mean_nees(), 4.5);
}

}  // namespace
}  // namespace vbar::flown_gnss
