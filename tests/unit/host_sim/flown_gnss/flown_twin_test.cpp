// The twin with the parameters of grace_b_twin.toml beside GRACE-B's receiver: parameters of the first half of the day,
// judged by the hour in tests/data/flight and, where VBAR_FLIGHT_DATA names the folder of the published files, by the
// second half.

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "host_sim/flown_gnss/ephemeris_fit.h"
#include "host_sim/flown_gnss/flown_receiver.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/mission.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss/recorded_receiver.h"
#include "tests/support/paths.h"

namespace vbar::flown_gnss {
namespace {

/// Flown and twin figures of `hours` from `from_h` on, by name.
std::map<std::string, ComparedFigure> figures(const std::filesystem::path& orbit_file,
                                              const std::filesystem::path& observations,
                                              const std::filesystem::path& navigation, double from_h, double hours) {
  const mission::Mission mission =
      sensors::load_mission(vbar::tests::source_path("tests/data/flight/grace_b_twin.toml"), {});
  const mission::Spacecraft& servicer = *mission.find_spacecraft("servicer");
  const sensors::GnssSensor& gnss = *mission::find_settings<sensors::GnssSensor>(servicer);
  GivenOrbit orbit(orbit_file, "",
                   std::make_shared<const truth::EarthOrientationSeries>(
                       truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv"))));
  FlownSettings settings;
  settings.antenna_up_m = gnss.receiver.body_frame.antenna_in_body_m.norm();
  settings.begin_s = 3600.0 * from_h;
  settings.duration_s = 3600.0 * hours;
  settings.filter.acceleration_psd = omitted_gravity_psd(orbit.at(orbit.first()).position_eci.norm());
  settings.filter.slow_error_sigma_m = 0.3;
  settings.range_errors.broadcast_sigma_m = 0.3;
  twins::gnss::RecordingSettings recording = gnss.recording;
  recording.observations = observations;
  recording.navigation = navigation;
  twins::gnss::RecordedReceiver flown(recording, "");
  twins::gnss::GnssReceiverSettings receiver = gnss.receiver;
  receiver.body_frame.antenna_in_body_m = {0.0, 0.0, settings.antenna_up_m};
  receiver.body_frame.boresight_in_body = fsw::Vector3::UnitZ();
  const std::filesystem::path data = vbar::tests::source_path("data");
  const auto sky = std::make_shared<const twins::gnss::Constellation>(
      data, mission::shared_settings<sensors::GnssShared>(mission).constellation, orbit.first(), mission.seed);
  twins::gnss::GnssReceiver twin(receiver, sky, data, mission.seed, servicer.name);
  std::map<std::string, ComparedFigure> named;
  for (const ComparedFigure& figure : compare(fly(orbit, flown, settings), fly(orbit, twin, settings)))
    named.emplace(figure.name, figure);
  return named;
}

/// Twin over flown, less 1, of at most `tolerance`.
void expect_alike(const std::map<std::string, ComparedFigure>& all, const std::string& name, double tolerance) {
  const auto found = all.find(name);
  ASSERT_NE(found, all.end()) << name;
  EXPECT_NEAR(found->second.ratio(), 1.0, tolerance)
      << name << ": flown " << found->second.flown << ", twin " << found->second.twin;
}

/// 40 %: an hour holds some ten independent values of an error that is correlated over four minutes.
TEST(FlownTwin, HasTheNoiseOfTheFlownHour) {
  const std::filesystem::path folder(vbar::tests::source_path("tests/data/flight"));
  const auto all = figures(folder / "grace_b.sp3", folder / "grace_b.10d", folder / "grace_b.rnx", 0.0, 1.0);
  for (const char* code : {"code L1", "code L2"})
    for (const char* bin : {"10 to 20", "20 to 30", "30 to 40", "40 to 50"})
      expect_alike(all, std::string(code) + ", m, " + bin + " deg", 0.4);
  expect_alike(all, "satellites of an epoch", 0.2);
  expect_alike(all, "own orbit, m rms 3D", 0.4);
  expect_alike(all, "code L2 above 30 deg, correlation after 10 s", 0.2);
}

TEST(FlownTwin, IsWithinAFifthOfTheFlownReceiverOnTheOtherHalfOfTheDay) {
  const char* const folder = std::getenv("VBAR_FLIGHT_DATA");
  if (folder == nullptr)
    GTEST_SKIP() << "VBAR_FLIGHT_DATA names no folder with GRCB2080.10D, COD15941.EPH to COD15943.EPH, igs05.atx and "
                    "grcb.sp3";
  const std::filesystem::path published(folder);
  std::vector<orbit_files::OrbitFile> files;
  for (const char* day : {"COD15941.EPH", "COD15942.EPH", "COD15943.EPH"})
    files.push_back(orbit_files::load_orbits(published / day));
  std::ifstream antennas(published / "igs05.atx");
  const std::string antenna_text{std::istreambuf_iterator<char>(antennas), std::istreambuf_iterator<char>()};
  const PhaseCentres centres =
      read_phase_centres(antenna_text, "igs05.atx", files[1].tracks.front().states.front().time);
  const std::filesystem::path navigation =
      std::filesystem::path(testing::TempDir()) / "vbar_grace_b_day_beside_twin.rnx";
  std::ofstream(navigation) << rinex_navigation(fit_ephemerides(files, {}, centres).sets);
  const auto all = figures(published / "grcb.sp3", published / "GRCB2080.10D", navigation, 12.0, 12.0);
  std::filesystem::remove(navigation);
  constexpr double kFifth = 0.2;
  for (const char* name :
       {"own orbit, m rms 3D", "NEES of its position", "single points, m rms 3D", "satellites of an epoch",
        "code L1 above 30 deg, correlation time beside white noise, s", "code L1 above 30 deg, correlation after 10 s",
        "code L1 above 30 deg, correlation after 60 s", "code L2 above 30 deg, correlation after 10 s",
        "code L2 above 30 deg, correlation after 60 s", "code L2, correlation time beside white noise, s"})
    expect_alike(all, name, kFifth);
  for (const char* quantity : {"range", "code L1", "code L2"})
    for (const char* bin : {"10 to 20", "20 to 30", "30 to 40", "40 to 50", "50 to 60", "60 to 70"})
      expect_alike(all, std::string(quantity) + ", m, " + bin + " deg", kFifth);
}

}  // namespace
}  // namespace vbar::flown_gnss
