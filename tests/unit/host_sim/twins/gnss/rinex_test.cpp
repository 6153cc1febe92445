// RINEX navigation files of three origins: CDDIS (2.xx), DLR and TU Munich (3.02), ESA (4.00), excerpts as published.
// The tables in data/gps were made from the first two.

#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/formats/ephemeris_formats.h"
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
  EXPECT_THAT(error_of(two, "0.515358347130D+04", "0.515358347130D+07"),
              HasSubstr("a record of G02 that cannot be right"));
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

}  // namespace
}  // namespace vbar::twins::gnss
