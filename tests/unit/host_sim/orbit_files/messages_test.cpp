// CCSDS OEM and OPM. The OPM is the example of the standard (502.0-B, annex, "OPM file example") in its Earth-fixed
// frame, and the same in another one; the OEM has states of a Keplerian orbit.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <erfa.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/orbit_files/published_time.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_files {
namespace {

using fsw::Vector3;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kGm_km = 398600.4415, kRadius_km = 6778.0, kInclination = 0.9;

/// Circular orbit, km and km/s, `t` s after its node.
fsw::Vector6 circular(double t) {
  const double n = std::sqrt(kGm_km / (kRadius_km * kRadius_km * kRadius_km)), u = n * t;
  const Vector3 along(std::cos(u), std::sin(u) * std::cos(kInclination), std::sin(u) * std::sin(kInclination));
  const Vector3 across(-std::sin(u), std::cos(u) * std::cos(kInclination), std::cos(u) * std::sin(kInclination));
  fsw::Vector6 state;
  state << kRadius_km * along, kRadius_km * n * across;
  return state;
}

std::string oem(std::string_view frame = "GCRF", std::string_view time_system = "UTC", int step_s = 60) {
  std::string text = fmt::format(
      "CCSDS_OEM_VERS = 2.0\nCOMMENT a test\nCREATION_DATE = 2026-11-20T00:00:00\nORIGINATOR = TEST\n\nMETA_START\n"
      "OBJECT_NAME = CHASER\nOBJECT_ID = 2026-001A\nCENTER_NAME = EARTH\nREF_FRAME = {}\nTIME_SYSTEM = {}\n"
      "START_TIME = 2026-11-20T00:00:00\nSTOP_TIME = 2026-11-20T01:00:00\nINTERPOLATION = HERMITE\n"
      "INTERPOLATION_DEGREE = 7\nMETA_STOP\n\n",
      frame, time_system);
  for (int t = 0; t <= 3600; t += step_s) {
    const fsw::Vector6 s = circular(t);
    text += fmt::format("2026-11-20T{:02}:{:02}:{:02}.000 {:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f}\n", t / 3600,
                        t / 60 % 60, t % 60, s[0], s[1], s[2], s[3], s[4], s[5]);
  }
  return text + "COVARIANCE_START\nEPOCH = 2026-11-20T00:00:00\n1.0\nCOVARIANCE_STOP\n";
}

std::string opm(std::string_view frame) {
  return fmt::format(
      "CCSDS_OPM_VERS = 2.0\nCREATION_DATE = 1998-11-06T09:23:57\nORIGINATOR = JAXA\n"
      "COMMENT GEOCENTRIC, CARTESIAN, EARTH FIXED\nOBJECT_NAME = GODZILLA 5\nOBJECT_ID = 1998-999A\n"
      "CENTER_NAME = EARTH\nREF_FRAME = {}\nTIME_SYSTEM = UTC\nEPOCH = 1998-12-18T14:28:15.1172\n"
      "X = 6503.514000\nY = 1239.647000 [km]\nZ = -717.490000\nX_DOT = -0.873160 [km/s]\nY_DOT = 8.740420\n"
      "Z_DOT = -4.191076\nMASS = 3000.000000\nSOLAR_RAD_AREA = 18.770000\nSOLAR_RAD_COEFF = 1.000000\n"
      "DRAG_AREA = 18.770000\nDRAG_COEFF = 2.500000\n",
      frame);
}

std::string error_of(std::string text, std::string_view what = "", std::string_view with = "") {
  if (!what.empty()) text.replace(text.find(what), what.size(), with);
  try {
    static_cast<void>(read_orbits(text, "orbit.txt"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Oem, StatesBetweenItsEpochs) {
  const OrbitFile file = read_orbits(oem(), "orbit.oem");
  ASSERT_EQ(file.tracks.size(), 1U);
  EXPECT_EQ(file.tracks[0].object, "CHASER");
  EXPECT_EQ(file.tracks[0].states.size(), 61U);
  const fsw::GpsTime start = truth::gps_from_utc("2026-11-20T00:00:00Z");
  // Hermite's polynomial of degree 7 over a minute errs by h^8/8! w^8 r/2^8, below a micrometre; the file has 1 um.
  for (const double t : {0.0, 30.0, 615.25, 1999.0, 3571.0, 3600.0}) {
    const FramedState at = state_at(file, start + fsw::nearest_duration(t));
    const fsw::Vector6 expected = 1e3 * circular(t);
    EXPECT_EQ(at.frame, Frame::kGcrf);
    EXPECT_LT((at.state.position_eci - expected.head<3>()).norm(), 5e-6) << t;
    EXPECT_LT((at.state.velocity_eci - expected.tail<3>()).norm(), 1e-6) << t;
  }
  EXPECT_THROW(static_cast<void>(state_at(file, start - fsw::duration_of_seconds(1))), std::out_of_range);
}

TEST(Oem, TimeSystemsAndFrames) {
  const auto first = [](std::string_view frame, std::string_view time_system) {
    return read_orbits(oem(frame, time_system), "o").tracks[0].states[0];
  };
  const fsw::GpsTime utc = truth::gps_from_utc("2026-11-20T00:00:00Z");
  EXPECT_EQ(first("GCRF", "UTC").time, utc);
  EXPECT_EQ(first("GCRF", "GPS").time, utc - fsw::duration_of_seconds(18));
  EXPECT_EQ(first("GCRF", "TAI").time, utc - fsw::duration_of_seconds(37));
  EXPECT_EQ(first("GCRF", "TT").time, utc - fsw::Duration{69'184'000'000});
  // The frame bias is 23 mas: below a metre in a low orbit. Its largest part, -16.6 mas about y, comes from ERFA.
  const Vector3 gcrf = first("ICRF", "UTC").state.position_eci, eme2000 = first("EME2000", "UTC").state.position_eci;
  double bias[3][3], precession[3][3], both[3][3], rotated[3];
  eraBp06(2451545.0, 0.0, bias, precession, both);
  double in_gcrf[3] = {eme2000.x(), eme2000.y(), eme2000.z()};
  eraRxp(bias, in_gcrf, rotated);
  EXPECT_LT((Vector3(rotated[0], rotated[1], rotated[2]) - gcrf).norm(), 1e-8);
  EXPECT_GT((eme2000 - gcrf).norm(), 0.1);
}

TEST(Oem, InvalidFilesAreRefusedWithALine) {
  const std::string text = oem();
  EXPECT_THAT(error_of(oem("TEME")),
              HasSubstr("orbit.txt:10: found REF_FRAME \"TEME\", expected GCRF, ICRF, EME2000 or ITRF"));
  for (const char* frame : {"TOD", "ITRF1", "ITRF-2001", "ITRF2014 ", "GTOD", "ITRF-"})
    EXPECT_EQ(error_of(oem(frame)).empty(), std::string(frame) == "ITRF2014 ") << frame;
  EXPECT_THAT(error_of(oem("GCRF", "TDB")),
              HasSubstr("orbit.txt:11: found TIME_SYSTEM \"TDB\", expected UTC, TAI, TT or GPS"));
  EXPECT_THAT(error_of(text, "CENTER_NAME = EARTH", "CENTER_NAME = MARS BARYCENTER"), HasSubstr("expected EARTH"));
  EXPECT_THAT(error_of(text, "REF_FRAME = GCRF\n", ""), HasSubstr("found metadata without REF_FRAME"));
  EXPECT_THAT(error_of(text, "2026-11-20T00:03:00.000", "2026-11-20T00:01:00.000"),
              HasSubstr("times in ascending order"));
  EXPECT_THAT(error_of(text, "2026-11-20T00:03:00.000", "2026-13-20T00:03:00.000"), HasSubstr("orbit.txt:21: found"));
  EXPECT_THAT(error_of(text, "6778.000000000", "6778000.000000"), HasSubstr("6400 to 1e6 km from its centre"));
  EXPECT_THAT(error_of(text.substr(0, text.find("META_STOP"))), HasSubstr("expected META_STOP"));
  EXPECT_THAT(error_of(text.substr(0, text.find("COVARIANCE_STOP"))), HasSubstr("expected COVARIANCE_STOP"));
  EXPECT_THAT(error_of(text.substr(0, text.find("META_STOP") + 11)), HasSubstr("a segment without a state"));
  EXPECT_THAT(error_of("<?xml version=\"1.0\"?>\n"), HasSubstr("CCSDS OEM (KVN)"));
}

TEST(Oem, UseableTimesAreHonoured) {
  const std::string text = [] {
    std::string with = oem();
    return with.insert(with.find("INTERPOLATION ="),
                       "USEABLE_START_TIME = 2026-11-20T00:10:00\nUSEABLE_STOP_TIME = 2026-11-20T00:50:00\n");
  }();
  const OrbitFile file = read_orbits(text, "orbit.oem");
  const auto error_at = [&](int t) -> std::string {
    try {
      static_cast<void>(state_at(file, truth::gps_from_utc("2026-11-20T00:00:00Z") + fsw::duration_of_seconds(t)));
    } catch (const std::out_of_range& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_at(600), "");
  EXPECT_EQ(error_at(3000), "");
  // Also at a state of the file itself: 502.0-B, table 5-3.
  EXPECT_THAT(error_at(540), HasSubstr("permits their use from 2026-11-20T00:10:00.000Z to 2026-11-20T00:50:00.000Z"));
  EXPECT_THAT(error_at(3001), HasSubstr("USEABLE_STOP_TIME"));
  EXPECT_THAT(error_of(text, "00:10:00\nUSEABLE_STOP", "00:55:00\nUSEABLE_STOP"),
              HasSubstr("found USEABLE_START_TIME after USEABLE_STOP_TIME"));
  EXPECT_THAT(error_of(text, "00:50:00\nINTER", "01:10:00\nINTER"),
              HasSubstr("found USEABLE_STOP_TIME after STOP_TIME"));
  EXPECT_THAT(error_of(text, "START_TIME = 2026-11-20T00:00:00", "START_TIME = 2026-11-20T00:20:00"),
              HasSubstr("found START_TIME after USEABLE_START_TIME"));
  EXPECT_THAT(error_of(oem(), "STOP_TIME = 2026-11-20T01", "STOP_TIME = 2026-11-19T01"),
              HasSubstr("found START_TIME after STOP_TIME"));
  EXPECT_THAT(error_of(oem(), "STOP_TIME = 2026-11-20T01:00:00", "STOP_TIME = 2026-11-20T00:30:00"),
              HasSubstr("a state outside START_TIME to STOP_TIME"));
}

TEST(Oem, AKeywordStandsOnceInABlock) {
  const std::string text = oem();
  EXPECT_THAT(error_of(text, "META_STOP", "OBJECT_NAME = CHASER\nMETA_STOP"),
              HasSubstr("orbit.txt:16: found a second OBJECT_NAME, expected one"));
  EXPECT_THAT(error_of(text, "META_STOP", "STOP_TIME = 2026-11-20T02:00:00\nMETA_STOP"),
              HasSubstr("found a second STOP_TIME"));
  EXPECT_THAT(error_of(text, "ORIGINATOR", "CREATION_DATE = 2026-11-20T00:00:00\nORIGINATOR"),
              HasSubstr("orbit.txt:4: found a second CREATION_DATE"));
  EXPECT_THAT(error_of(opm("GCRF"), "Y = ", "X = 1.0\nY = "), HasSubstr("orbit.txt:12: found a second X"));
  EXPECT_THAT(error_of(opm("GCRF"), "Y = ", "EPOCH = 1998-12-18T14:28:15\nY = "), HasSubstr("found a second EPOCH"));
}

TEST(Oem, VersionsOneToThree) {
  for (const char* version : {"1.0", "2.0", "3.0"})
    EXPECT_EQ(error_of(oem(), "VERS = 2.0", std::string("VERS = ") + version), "");
  EXPECT_THAT(error_of(oem(), "VERS = 2.0", "VERS = 4.0"),
              HasSubstr("orbit.txt:1: found CCSDS_OEM_VERS \"4.0\", expected 1.0, 2.0 or 3.0"));
  EXPECT_THAT(error_of(opm("GCRF"), "VERS = 2.0", "VERS ="), HasSubstr("expected 1.0, 2.0 or 3.0"));
}

TEST(Oem, AByteOrderMarkIsSkipped) {
  const std::string file = testing::TempDir() + "vbar_byte_order_mark.oem";
  std::ofstream(file) << "\xEF\xBB\xBF" << oem();
  EXPECT_EQ(load_orbits(file).tracks.at(0).states.size(), 61U);
  std::filesystem::remove(file);
}

// 7.5 km/s cut to 7 is a velocity too.
TEST(Oem, ALastStateThatIsCutShortIsRefused) {
  const std::string text = oem(), states = text.substr(0, text.find("COVARIANCE_START"));
  EXPECT_EQ(error_of(states), "");
  for (const std::size_t cut : {1U, 2U, 12U})
    EXPECT_THAT(error_of(states.substr(0, states.size() - cut)),
                HasSubstr("orbit.txt:78: found a last row without a line feed, expected one"));
  EXPECT_EQ(error_of(text.substr(0, text.size() - 1)), "") << "COVARIANCE_STOP cannot be cut short";
}

TEST(Oem, OneOfSeveralObjectsMustBeNamed) {
  std::string text = oem();
  std::string other = text.substr(text.find("META_START"));
  other.replace(other.find("CHASER"), 6, "TARGET");
  const OrbitFile file = read_orbits(text + other, "two.oem");
  EXPECT_EQ(tracks_of(file, "TARGET").tracks.size(), 1U);
  EXPECT_EQ(tracks_of(file, "2026-001A").tracks.size(), 2U);
  EXPECT_THROW(static_cast<void>(tracks_of(file, "")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(tracks_of(file, "X")), std::runtime_error);
}

TEST(Opm, TheExampleOfTheStandard) {
  for (const char* name : {"ITRF-97", "ITRF97", "ITRF1997", "ITRF", "ITRF2000", "ITRF-2005", "ITRF2020"}) {
    const Track fixed = read_orbits(opm(name), "state.opm").tracks.at(0);
    EXPECT_EQ(fixed.frame, Frame::kItrf) << name;
    EXPECT_EQ(fixed.states.at(0).state.position_eci, Vector3(6503514.0, 1239647.0, -717490.0));
  }
  const OrbitFile file = read_orbits(opm("GCRF"), "state.opm");
  const TimedState& state = file.tracks.at(0).states.at(0);
  EXPECT_EQ(state.time, truth::gps_from_utc("1998-12-18T14:28:15.1172Z"));
  EXPECT_EQ(state.state.position_eci, Vector3(6503514.0, 1239647.0, -717490.0));
  EXPECT_LT((state.state.velocity_eci - Vector3(-873.16, 8740.42, -4191.076)).norm(), 1e-9);
  EXPECT_EQ(state_at(file, state.time).state.position_eci, state.state.position_eci);
  EXPECT_THROW(static_cast<void>(state_at(file, state.time + fsw::Duration{1})), std::out_of_range);
}

TEST(Opm, InvalidFilesAreRefusedWithALine) {
  const std::string text = opm("GCRF");
  EXPECT_THAT(error_of(text, "1239.647000 [km]", "1239647.0 [m]"),
              HasSubstr("orbit.txt:12: found Y in \"m\", expected km"));
  EXPECT_THAT(error_of(text, "6503.514000", "65O3.514000"), HasSubstr("expected a number"));
  EXPECT_THAT(error_of(text, "Z = -717.490000\n", ""), HasSubstr("found a message without Z"));
  EXPECT_THAT(error_of(text + "MAN_EPOCH_IGNITION = 1998-12-18T15:00:00\n"), HasSubstr("a state without maneuvers"));
}

TEST(Opm, ALastNumberThatIsCutShortIsRefused) {
  const std::string text = opm("GCRF"), state = text.substr(0, text.find("MASS"));
  EXPECT_EQ(error_of(state), "");
  for (const std::size_t cut : {1U, 2U, 5U})
    EXPECT_THAT(error_of(state.substr(0, state.size() - cut)),
                HasSubstr("orbit.txt:16: found a last row without a line feed, expected one"));
  EXPECT_EQ(error_of(state.substr(0, state.size() - 1) + " [km/s]"), "") << "its unit is whole";
  EXPECT_EQ(error_of(text.substr(0, text.size() - 2)), "") << "no number of the state";
}

TEST(PublishedTime, CalendarDaysAndDaysOfTheYear) {
  const auto time = [](std::string_view text) { return ccsds_time(text, TimeSystem::kUtc); };
  EXPECT_EQ(time("2012-06-30T23:59:60.5"), truth::gps_from_utc("2012-06-30T23:59:60.5Z"));
  EXPECT_EQ(time("2024-366T12:00:00Z"), truth::gps_from_utc("2024-12-31T12:00:00Z"));
  EXPECT_EQ(time("2023-366T12:00:00"), std::nullopt);
  EXPECT_EQ(time("2023-02-29T12:00:00"), std::nullopt);
  EXPECT_EQ(time("2012-06-29T23:59:60"), std::nullopt);
  EXPECT_EQ(time("1979-06-29T23:59:00"), std::nullopt);
  EXPECT_EQ(time("2023-02-20 12:00:00"), std::nullopt);
}

// Orekit and products of ESA and DGFI write such times.
TEST(PublishedTime, SixtySecondsSixtyMinutesAndTwentyFourHoursAreTheNextOnes) {
  const auto carried = [](const Calendar& c) { return instant_of_carried(c, TimeSystem::kUtc); };
  EXPECT_EQ(carried({2012, 6, 29, 23, 59, 60.0}), truth::gps_from_utc("2012-06-30T00:00:00Z"));
  EXPECT_EQ(carried({2011, 7, 18, 1, 4, 60.25}), truth::gps_from_utc("2011-07-18T01:05:00.25Z"));
  EXPECT_EQ(carried({2011, 7, 18, 1, 60, 0.0}), truth::gps_from_utc("2011-07-18T02:00:00Z"));
  EXPECT_EQ(carried({2011, 12, 31, 24, 0, 0.0}), truth::gps_from_utc("2012-01-01T00:00:00Z"));
  // On the day of a leap second these are two instants.
  EXPECT_EQ(carried({2012, 6, 30, 23, 59, 60.0}), truth::gps_from_utc("2012-06-30T23:59:60Z"));
  EXPECT_EQ(carried({2012, 6, 30, 24, 0, 0.0}), truth::gps_from_utc("2012-07-01T00:00:00Z"));
  for (const Calendar& c : {Calendar{2011, 7, 18, 1, 4, 61.0}, Calendar{2011, 7, 18, 1, 61, 0.0},
                            Calendar{2011, 7, 18, 24, 1, 0.0}, Calendar{2011, 2, 29, 24, 0, 0.0}})
    EXPECT_EQ(carried(c), std::nullopt) << c.hour << ":" << c.minute << ":" << c.second;
  EXPECT_EQ(ccsds_time("2011-07-18T01:04:60", TimeSystem::kUtc), std::nullopt) << "CCSDS 301.0-B permits none";
}

TEST(PublishedTime, LastDayThatIsRead) {
  // 2200-12-31, MJD 124957, in GPS time; 1980-01-06 is MJD 44244.
  EXPECT_EQ(ccsds_time("2200-12-31T00:00:00", TimeSystem::kGps)->ns, (124957 - 44244) * 86400LL * 1000000000LL);
  EXPECT_EQ(ccsds_time("2201-01-01T00:00:00", TimeSystem::kGps), std::nullopt);
}

}  // namespace
}  // namespace vbar::orbit_files
