// RINEX navigation files of three origins: CDDIS (2.xx), DLR and TU Munich (3.02), ESA (4.00), excerpts as published.
// The tables in data/gps were made from the first two.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "tests/support/paths.h"

namespace vbar::twins::gnss {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kData = vbar::tests::source_path("data");

std::filesystem::path published(const std::string& name) {
  return vbar::tests::source_path("tests/data/formats/" + name);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void expect_same(const Ephemeris& a, const Ephemeris& b) {
  EXPECT_EQ(a.satellite, b.satellite);
  const std::string name = name_of(a.satellite);
  EXPECT_EQ(a.toe.ns, b.toe.ns) << name;
  for (const auto member :
       {&Ephemeris::sqrt_a, &Ephemeris::e, &Ephemeris::m0, &Ephemeris::delta_n, &Ephemeris::node_at_toe,
        &Ephemeris::omega_dot, &Ephemeris::i0, &Ephemeris::i_dot, &Ephemeris::omega, &Ephemeris::cuc, &Ephemeris::cus,
        &Ephemeris::cic, &Ephemeris::cis, &Ephemeris::crc, &Ephemeris::crs, &Ephemeris::af0, &Ephemeris::af1,
        &Ephemeris::af2, &Ephemeris::group_delay_s})
    EXPECT_EQ(a.*member, b.*member) << name;
}

TEST(Rinex, TheFilesAsPublishedHoldTheBundledSatellites) {
  const EphemerisFile gps = read_ephemeris_file(published("brdc2930_excerpt.11n"));
  const EphemerisFile gps_table = read_ephemeris_file(kData / "gps/gps_2011_10_20.csv");
  ASSERT_EQ(gps.satellites.size(), gps_table.satellites.size());
  for (std::size_t k = 0; k < gps.satellites.size(); ++k) expect_same(gps.satellites[k], gps_table.satellites[k]);
  EXPECT_EQ(gps.corrections, gps_table.corrections);

  const EphemerisFile others = read_ephemeris_file(published("brdm2000_excerpt.13p"));
  const EphemerisFile table = read_ephemeris_file(kData / "gps/galileo_beidou_2013_07_19.csv");
  for (const Ephemeris& expected : table.satellites) {
    const auto found = std::ranges::find(others.satellites, expected.satellite, &Ephemeris::satellite);
    ASSERT_NE(found, others.satellites.end()) << name_of(expected.satellite);
    expect_same(*found, expected);
  }
}

TEST(Rinex, AConstellationOfFilesIsTheBundledOne) {
  const fsw::GpsTime epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  ConstellationSettings settings;
  const Constellation bundled(kData, settings, epoch, 1);
  settings.navigation_files = {published("brdc2930_excerpt.11n"), published("brdm2000_excerpt.13p")};
  const Constellation read(kData, settings, epoch, 1);
  ASSERT_EQ(read.size(), bundled.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    EXPECT_EQ(read.id(k), bundled.id(k));
    EXPECT_EQ(read.true_state(k, epoch, 1234.5).position_ecef, bundled.true_state(k, epoch, 1234.5).position_ecef);
    EXPECT_EQ(read.true_state(k, epoch, 1234.5).clock_s, bundled.true_state(k, epoch, 1234.5).clock_s);
  }
  EXPECT_EQ(read.corrections(), bundled.corrections());
}

TEST(Rinex, VersionFour) {
  const EphemerisFile file = read_ephemeris_file(published("esoc_2025_166_excerpt.rnx"));
  ASSERT_EQ(file.satellites.size(), 2U);
  const Ephemeris &g01 = file.satellites[0], &e04 = file.satellites[1];
  EXPECT_EQ(g01.satellite, (SatelliteId{System::kGps, 1}));
  EXPECT_EQ(g01.toe, (fsw::GpsTime{(2371 * 604800LL + 7200) * 1'000'000'000LL}));
  EXPECT_EQ(g01.sqrt_a, 5.153723411560E+03);
  EXPECT_EQ(g01.i_dot, 2.364384200378E-10);
  EXPECT_EQ(g01.group_delay_s, -8.847564458847E-09);
  EXPECT_EQ(g01.af0, 2.915360964835E-04);  // toc is toe
  EXPECT_EQ(e04.satellite, (SatelliteId{System::kGalileo, 4}));
  EXPECT_EQ(e04.toe, (fsw::GpsTime{(2370 * 604800LL + 602400) * 1'000'000'000LL}));
  EXPECT_EQ(e04.group_delay_s, -4.656612873077E-09);  // BGD(E1,E5b)
  EXPECT_EQ(file.corrections.klobuchar.alpha[3], -5.960464477539E-08);
  EXPECT_EQ(file.corrections.klobuchar.beta[3], 6.5536e+04);
  EXPECT_EQ(file.corrections.utc_a0_s, 9.313225746155E-10);
}

TEST(Rinex, ASystemWithoutASatelliteIsRefused) {
  ConstellationSettings settings;
  settings.navigation_files = {published("brdc2930_excerpt.11n")};
  const fsw::GpsTime epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  try {
    const Constellation constellation(kData, settings, epoch, 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no file has a satellite of galileo"));
  }
  settings.galileo = settings.beidou = SatelliteSet::kNone;
  EXPECT_EQ(Constellation(kData, settings, epoch, 1).size(), 31U);
}

std::string error_of(std::string text, std::string_view what = "", std::string_view with = "") {
  if (!what.empty()) text.replace(text.find(what), what.size(), with);
  try {
    static_cast<void>(read_ephemerides(text, "brdc.rnx"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Rinex, InvalidFilesAreRefusedWithALine) {
  const std::string two = text_of(published("brdc2930_excerpt.11n")),
                    three = text_of(published("brdm2000_excerpt.13p"));
  EXPECT_THAT(error_of(two, "NAVIGATION DATA", "GLONASS NAV DAT"),
              AllOf(HasSubstr("brdc.rnx:1: found a file of type \"GLONASS NAV DAT"), HasSubstr("navigation data (N)")));
  EXPECT_THAT(
      error_of(three, "M (Mixed)", "R (GLO)  "),
      AllOf(HasSubstr("brdc.rnx:1: found the satellite system \"R (GLO)\""), HasSubstr("GPS, Galileo, BeiDou")));
  EXPECT_THAT(error_of(three, "NAVIGATION DATA", "OBSERVATION DAT"),
              HasSubstr("found a file of type \"OBSERVATION DAT"));
  EXPECT_THAT(error_of(three, "     3.02", "     5.02"), HasSubstr("found RINEX version 5.02, expected 2, 3 or 4"));
  EXPECT_THAT(error_of(two.substr(0, two.size() - 200)),
              HasSubstr("found the end of the file, expected the next line of"));
  EXPECT_THAT(error_of(two, "END OF HEADER", "END OF HEADXX"), HasSubstr("expected END OF HEADER"));
  EXPECT_THAT(error_of("x y\n"), HasSubstr("RINEX navigation file"));
}

// The merged file of DLR has such sets (C03 on 2013-07-19).
TEST(Rinex, ASetWithTheWeekOfAnotherOneIsLeftOut) {
  std::string text = text_of(published("brdc2930_excerpt.11n"));
  const std::string week = "0.165800000000D+04";
  const std::size_t record = text.find(" 2 11 10 20 12  0  0.0");  // the set of G02 that is used
  ASSERT_NE(record, std::string::npos);
  text.replace(text.find(week, record), week.size(), "0.165900000000D+04");
  const EphemerisFile all = read_ephemeris_file(published("brdc2930_excerpt.11n"));
  const EphemerisFile rest = read_ephemerides(text, "brdc.rnx");
  ASSERT_EQ(rest.satellites.size(), all.satellites.size());
  EXPECT_EQ(rest.satellites[1].satellite, all.satellites[1].satellite);
  EXPECT_NE(rest.satellites[1].toe, all.satellites[1].toe);
}

// One set in the columns of a version; numbers of the broadcast files' sizes, invented.
struct SetText {
  std::string satellite = "G01", week = " 2.111000000000D+03", e = " 5.000000000000D-03",
              sqrt_a = " 5.153700000000D+03", sources = " 1.000000000000D+00", i_dot = " 1.000000000000D-10",
              spare = " 0.000000000000D+00", omega0 = " 5.000000000000D-01", i0 = " 9.600000000000D-01";
  [[nodiscard]] std::string in_version(int version) const {
    const std::string indent(version == 2 ? 3 : 4, ' ');
    const std::string first =
        version == 2 ? satellite.substr(1) + " 20  6 25 12  0  0.0" : satellite + " 2020 06 25 12 00 00";
    return first + " 1.000000000000D-05 1.000000000000D-12 0.000000000000D+00\n" +                 //
           indent + spare + " 1.000000000000D+01 4.500000000000D-09 1.000000000000D+00\n" +        //
           indent + " 1.000000000000D-06" + e + " 5.000000000000D-06" + sqrt_a + "\n" +            //
           indent + " 3.888000000000D+05 1.000000000000D-08" + omega0 + " 1.000000000000D-08\n" +  //
           indent + i0 + " 2.500000000000D+02 8.000000000000D-01-8.000000000000D-09\n" +           //
           indent + i_dot + sources + week + spare + "\n" +                                        //
           indent + spare + spare + " 1.000000000000D-09" + (satellite[0] == 'E' ? " 1.000000000000D-09" : spare) +
           "\n" +  //
           indent + spare + " 4.000000000000D+00" + spare + spare + "\n";
  }
};

std::string head_of(int version, std::string_view system = "M") {
  return fmt::format("{:9.2f}{:11}{:20}{:20}{:20}\n{:60}END OF HEADER\n", static_cast<double>(version), "",
                     "NAVIGATION DATA", system, "RINEX VERSION / TYPE", "");
}

// GPS time of 2020-06-25T12:00:00: week 2111, 388800 s.
constexpr fsw::GpsTime kNoon{(2111 * 604800LL + 388800) * 1'000'000'000LL};

void expect_only_g01(const EphemerisFile& file) {
  ASSERT_EQ(file.satellites.size(), 1U);
  EXPECT_EQ(file.satellites[0].satellite, (SatelliteId{System::kGps, 1}));
  EXPECT_EQ(file.satellites[0].toe, kNoon);
  EXPECT_EQ(file.satellites[0].sqrt_a, 5153.7);
  EXPECT_EQ(file.satellites[0].group_delay_s, 1e-9);
}

// Version 4.00, appendix: records of GLONASS have four lines, those of CNAV messages nine and more, with other fields.
TEST(Rinex, RecordsOfOtherSystemsAndMessagesAreSkipped) {
  const std::string glonass =
      "R03 2020 06 25 12 15 00 1.000000000000D-05 0.000000000000D+00 3.888000000000D+05\n"
      "     1.000000000000D+04 1.500000000000D+00 x.000000000000D+00 0.000000000000D+00\n";
  const std::string g01 = SetText{}.in_version(4);
  const EphemerisFile four = read_ephemerides(
      head_of(4) + "> EPH R03 FDMA\n" + glonass + "> EPH R03 FDMA\n" + glonass + "> EPH G01 CNAV\n" + g01 +
          "> EPH S23 SBAS\nS23 2020 06 25 12 15 00 1.0\n> EPH J02 CNV2\nJ02 what it holds\n> EPH I03 L1NV\nI03\n" +
          "> EPH C20 CNV1\nC20 2020\n> EOP G01 CNVX\n    2020 06 25 12 00 00\n> STO R03 FDMA\n    x\n> XYZ\nG99\n" +
          "> EPH G01 LNAV\n" + g01 + "     9.000000000000D+00\n> ION E01 IFNV\n    2020\n",
      "brd4.rnx");
  expect_only_g01(four);
  EXPECT_EQ(
      four.note,
      "brd4.rnx: not used are GLONASS FDMA (2), GPS CNAV (1), SBAS SBAS (1), QZSS CNV2 (1), NavIC L1NV (1), BeiDou "
      "CNV1 (1).");
  const EphemerisFile three =
      read_ephemerides(head_of(3) + glonass + "S23 2020\n     1.0\n" + SetText{}.in_version(3) + "J02\n", "brd3.rnx");
  expect_only_g01(three);
  EXPECT_EQ(three.note, "brd3.rnx: not used are GLONASS (1), SBAS (1), QZSS (1).");
}

// E14 and E18 were put into orbits of e = 0.16 by the failure of their launch on 2014-08-22.
TEST(Rinex, EccentricSatellitesOfGalileoAreRead) {
  const SetText e14{.satellite = "E14",
                    .e = " 1.668000000000D-01",
                    .sqrt_a = " 5.289350000000D+03",
                    .sources = " 5.170000000000D+02"};
  const EphemerisFile file = read_ephemerides(head_of(3) + SetText{}.in_version(3) + e14.in_version(3), "f");
  ASSERT_EQ(file.satellites.size(), 2U);
  EXPECT_EQ(file.satellites[1].e, 0.1668);
  EXPECT_EQ(file.note, "");
  // Perigee, where the mean anomaly is 0, and apogee; its value at noon is 1 rad.
  const Ephemeris& e14_read = file.satellites[1];
  const auto radius = [&](double mean_anomaly) {
    return satellite_state(e14_read, kNoon, (mean_anomaly - 1.0) / mean_motion(e14_read)).position_ecef.norm();
  };
  const double a = 5289.35 * 5289.35, harmonics_m = 300.0;
  EXPECT_NEAR(radius(0.0), a * (1.0 - 0.1668), harmonics_m);
  EXPECT_NEAR(radius(std::numbers::pi), a * (1.0 + 0.1668), harmonics_m);
}

TEST(Rinex, FieldsThatAreNotUsedAreNotLookedAt) {
  for (const int version : {2, 3, 4}) {
    const SetText odd{.spare = " 0.123456789012-269"};
    const std::string text = head_of(version) + (version == 4 ? "> EPH G01 LNAV\n" : "") + odd.in_version(version);
    expect_only_g01(read_ephemerides(text, "f"));
  }
}

TEST(Rinex, WeeksModulo1024AreResolvedByTheDate) {
  const SetText g01{.week = " 6.300000000000D+01"};  // 2111 = 2 * 1024 + 63
  const EphemerisFile file = read_ephemerides(head_of(2) + g01.in_version(2), "old.20n");
  expect_only_g01(file);
  EXPECT_EQ(file.note, "old.20n: sets whose week is counted modulo 1024 and resolved by their date: 1.");
  // Galileo's own count begins 1024 weeks after that of GPS.
  const SetText e01{.satellite = "E01", .week = " 1.087000000000D+03", .sources = " 5.170000000000D+02"};
  EXPECT_EQ(read_ephemerides(head_of(3) + e01.in_version(3), "f").satellites[0].toe, kNoon);
}

TEST(Rinex, SetsThatCannotBeUsedAreLeftOutWithTheirReason) {
  const SetText cut{.satellite = "G02", .i_dot = "*******************"},
      wide{.satellite = "G03", .e = " 9.000000000000D-01"},
      other_week{.satellite = "G04", .week = " 2.113000000000D+03"},
      zero{.satellite = "G05", .sqrt_a = " 0.000000000000D+00"};
  const std::string text = head_of(3) + SetText{}.in_version(3) + cut.in_version(3) + wide.in_version(3) +
                           other_week.in_version(3) + zero.in_version(3) + zero.in_version(3);
  const EphemerisFile file = read_ephemerides(text, "f");
  expect_only_g01(file);
  EXPECT_EQ(
      file.note,
      "f: not used are sets with a field that cannot be read (1; G02 in line 11, line 16: found "
      "\"*******************\" in columns 5 to 23, expected a number), sets that cannot be right (1; G03 in line 19, "
      "an eccentricity of 0.9 does not lie between 0 and 0.2), sets whose week contradicts their date (1; G04 in line "
      "27, week 2113), sets of zeros (2; the first: G05 in line 35).");
}

TEST(Rinex, AFileWithoutAUsableSetSaysWhy) {
  const SetText fnav{.satellite = "E01", .sources = " 2.580000000000D+02"};
  EXPECT_THAT(error_of(head_of(3) + fnav.in_version(3) + fnav.in_version(3)),
              AllOf(HasSubstr("found nothing but Galileo F/NAV (2), expected at least one set of GPS LNAV")));
  EXPECT_THAT(error_of(head_of(3)), HasSubstr("found no record of a satellite"));
}

TEST(Rinex, SystemsThatAreNotUsedAreNotLookedAt) {
  const SetText bad{.satellite = "C20", .e = " x.000000000000D-03"};
  const std::string text = head_of(3) + bad.in_version(3) + SetText{}.in_version(3);
  const EphemerisFile file = read_ephemerides(text, "f", {true, true, false});
  expect_only_g01(file);
  EXPECT_EQ(file.note, "");
  // Another file may have the system that is used.
  EXPECT_TRUE(read_ephemerides(text, "f", {false, true, false}).satellites.empty());
}

// A simulator of signals writes version 3.00 without the system of the file.
TEST(Rinex, AHeaderWithoutASystem) {
  expect_only_g01(read_ephemerides(head_of(3, "") + SetText{}.in_version(3), "f"));
}

// BDS-SIS-ICD-B1I-3.0, 5.2.4.12: elements of geostationary satellites, from 59 on those of BeiDou-3, are given in a
// frame tilted by 5 deg about its x axis. An orbit inclined by 5 deg there whose node is at 180 deg lies in the
// equator.
TEST(Rinex, GeostationarySatellitesOfBeidou3StayInTheEquator) {
  const SetText c59{.satellite = "C59",
                    .week = " 7.550000000000D+02",
                    .e = " 5.000000000000D-04",
                    .sqrt_a = " 6.493400000000D+03",
                    .omega0 = " 7.740924000000D-02",  // 180 deg + 7.292115e-5 rad/s * 388800 s
                    .i0 = " 8.726646260000D-02"};
  ConstellationSettings settings{.gps = SatelliteSet::kNone, .galileo = SatelliteSet::kNone};
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / fmt::format("vbar_rinex_c59_{}.rnx", ::getpid());
  std::ofstream(path) << head_of(3) << c59.in_version(3);
  settings.navigation_files = {path};
  const Constellation sky(kData, settings, kNoon, 1);
  std::filesystem::remove(path);
  ASSERT_EQ(sky.size(), 1U);
  for (double h = 0.0; h < 24.0; h += 1.0)
    EXPECT_LT(std::abs(sky.true_state(0, kNoon, 3600.0 * h).position_ecef.z()), 10.0) << h;  // m; its errors are 1 m
}

}  // namespace
}  // namespace vbar::twins::gnss
