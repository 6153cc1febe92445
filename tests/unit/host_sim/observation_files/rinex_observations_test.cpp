// RINEX observation files by the examples of the format's descriptions (Gurtner 2007, RINEX 2.11; Romero 2020, 3.05):
// epochs, gaps, events, cycle slip records, foreign systems, and damage of each kind.

#include "host_sim/observation_files/rinex_observations.h"

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::observation_files {
namespace {

using testing::HasSubstr;

std::string header_line(std::string content, const std::string& label) {
  content.resize(60, ' ');
  return content + label + "\n";
}

std::string header_of_version_2(const std::string& system = "M (MIXED)") {
  return header_line("     2.11           OBSERVATION DATA    " + system, "RINEX VERSION / TYPE") +
         header_line("A 9080", "MARKER NAME") +
         header_line("     6    P1    L1    L2    P2    C1    S1", "# / TYPES OF OBSERV") +
         header_line("    18.000", "INTERVAL") +
         header_line("  2005     3    24    13    10   36.0000000     GPS", "TIME OF FIRST OBS") +
         header_line("", "END OF HEADER");
}

/// A field of 14 columns with loss of lock and strength; blank for a missing one.
std::string field(std::optional<double> value = std::nullopt, char loss_of_lock = ' ', char strength = ' ') {
  return value ? fmt::format("{:14.3f}{}{}", *value, loss_of_lock, strength) : std::string(16, ' ');
}

// An epoch of GPS and GLONASS with six types, then a power failure, header lines, slips and an epoch after a gap.
std::string records_of_version_2() {
  return " 05  3 24 13 10 36.0000000  0  3G12G 9R21                         -.123456789\n" + field(23629347.915) +
         field(0.3, ' ', '8') + field(-0.353) + field(23629364.158) + field(23629347.1) + "\n" + field(45.0) +
         "\n" +  //
         field(20891534.648) + field(-0.12, ' ', '9') + field(-0.358) + field(20891545.292) + field(20891534.1) +
         "\n\n" +                                                                                       //
         field(19000000.0) + field(1.5, ' ', '7') + "\n\n" + " 05  3 24 13 10 54.0000000  1  1G12\n" +  //
         field(23619095.45) + field(-53875.632, '4', '8') + field(-41981.375) + field(23619112.008) + "\n\n" +
         "                            4  2\n" + header_line("     2    C1    L1", "# / TYPES OF OBSERV") +
         header_line("comment", "COMMENT") + " 05  3 24 13 11 12.0000000  6  1G12\n" +  //
         field() + field(1.0) + "\n" +                                                  //
         " 05  3 24 13 14 12.0000000  0  1G12\n" + field(23619000.0) + field(-53000.0, '0', '8') + "\n";
}

std::vector<RecordedEpoch> epochs_of(const std::string& text, ObservationCounts* counts = nullptr) {
  ObservationReader reader(text, "log.05o");
  std::vector<RecordedEpoch> epochs;
  while (auto epoch = reader.next()) epochs.push_back(*epoch);
  if (counts != nullptr) *counts = reader.counts();
  return epochs;
}

std::string error_of(std::string text, std::string_view what = "", std::string_view with = "") {
  if (!what.empty()) text.replace(text.find(what), what.size(), with);
  try {
    static_cast<void>(epochs_of(text));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(RinexObservations, HoldsTheEpochsOfVersion2) {
  ObservationCounts counts;
  const std::string text = header_of_version_2() + records_of_version_2();
  const auto epochs = epochs_of(text, &counts);
  ASSERT_EQ(epochs.size(), 3U);
  // 2005-03-24 13:10:36 GPS: week 1315, day 4.
  EXPECT_EQ(epochs[0].time, fsw::GpsTime{} + fsw::duration_of_seconds(1315 * 604800 + 4 * 86400 + 13 * 3600 + 636));
  ASSERT_EQ(epochs[0].satellites.size(), 3U);
  const SatelliteObservations& first = epochs[0].satellites[0];
  EXPECT_EQ(first.system, 'G');
  EXPECT_EQ(first.number, 12);
  EXPECT_EQ(epochs[0].value(first, "P1").value, 23629347.915);
  EXPECT_EQ(epochs[0].value(first, "L1").value, 0.3);
  EXPECT_EQ(epochs[0].value(first, "L1").strength, 8);
  EXPECT_EQ(epochs[0].value(first, "S1").value, 45.0);
  EXPECT_EQ(epochs[0].value(first, "D1").value, 0.0);
  EXPECT_EQ(epochs[0].satellites[2].system, 'R');
  EXPECT_EQ(epochs[0].satellites[2].number, 21);
  EXPECT_FALSE(epochs[0].after_power_failure);
  EXPECT_TRUE(epochs[1].after_power_failure);
  EXPECT_EQ(epochs[1].value(epochs[1].satellites[0], "L1").value, -53875.632);
  EXPECT_EQ(epochs[1].value(epochs[1].satellites[0], "L1").loss_of_lock, 4);
  // Types changed by the event; the slip record sets the loss of lock of the next phase.
  EXPECT_EQ(epochs[2].value(epochs[2].satellites[0], "P1").value, 0.0);
  EXPECT_EQ(epochs[2].value(epochs[2].satellites[0], "L1").value, -53000.0);
  EXPECT_EQ(epochs[2].value(epochs[2].satellites[0], "L1").loss_of_lock, 1);
  EXPECT_EQ(counts.epochs, 3U);
  EXPECT_EQ(counts.power_failures, 1U);
  EXPECT_EQ(counts.events, 1U);
  EXPECT_EQ(counts.slip_records, 1U);
}

TEST(RinexObservations, ListsMoreThanTwelveSatellites) {
  std::string text = header_of_version_2("G (GPS)") + " 05  3 24 13 10 36.0000000  0 13";
  for (int k = 1; k <= 12; ++k) text += k < 10 ? "  " + std::to_string(k) : " " + std::to_string(k);
  text += "\n                                 13\n";
  for (int k = 1; k <= 13; ++k) text += "  2000000" + std::to_string(k % 10) + ".000\n\n";
  const auto epochs = epochs_of(text);
  ASSERT_EQ(epochs.size(), 1U);
  ASSERT_EQ(epochs[0].satellites.size(), 13U);
  EXPECT_EQ(epochs[0].satellites[12].number, 13);
  EXPECT_EQ(epochs[0].satellites[12].system, 'G');
  EXPECT_EQ(epochs[0].satellites[12].values[0].value, 20000003.0);
}

std::string text_of_version_3() {
  return header_line("     3.05           OBSERVATION DATA    M", "RINEX VERSION / TYPE") +
         header_line("G    3 C1C L1C S1C", "SYS / # / OBS TYPES") + header_line("E    1 C1C", "SYS / # / OBS TYPES") +
         header_line("  2006     3    24    13    10   36.0000000     GPS", "TIME OF FIRST OBS") +
         header_line("", "END OF HEADER") +
         "> 2006 03 24 13 10 36.0000000  0  2      -0.123456789012\n"
         "G06" +
         field(23629347.915) + field(300.0, '1', '8') + field(45.0) + "\n" + "E11" + field(23629364.158) + "\n" +
         ">                              3  1\n" + header_line("B 9080", "MARKER NAME") +
         "> 2006 03 24 13 11 36.0000000  0  1\n"
         "G06" +
         field(23629447.915) + "\n";
}

TEST(RinexObservations, HoldsTheEpochsOfVersion3) {
  ObservationCounts counts;
  const std::string text = text_of_version_3();
  const auto epochs = epochs_of(text, &counts);
  ASSERT_EQ(epochs.size(), 2U);
  ASSERT_EQ(epochs[0].satellites.size(), 2U);
  EXPECT_EQ(epochs[0].value(epochs[0].satellites[0], "L1C").value, 300.0);
  EXPECT_EQ(epochs[0].value(epochs[0].satellites[0], "L1C").loss_of_lock, 1);
  EXPECT_EQ(epochs[0].value(epochs[0].satellites[1], "C1C").value, 23629364.158);
  EXPECT_EQ(epochs[0].value(epochs[0].satellites[1], "L1C").value, 0.0);
  EXPECT_EQ(counts.events, 1U);
  EXPECT_EQ(epochs[1].time - epochs[0].time, fsw::duration_of_seconds(60));
}

TEST(RinexObservations, RefuseEachDamageInOneSentence) {
  const std::string old_text = header_of_version_2() + records_of_version_2(), text = text_of_version_3();
  struct Damage {
    const std::string& of;
    std::string_view what, with, error;
  };
  const std::vector<Damage> kinds{
      {old_text, "     2.11", "     1.00", "log.05o:1: found RINEX version 1, expected 2, 3 or 4"},
      {old_text, "OBSERVATION", "NAVIGATION ", "log.05o:1: found a file of type"},
      {old_text, "END OF HEADER", "END OF HEADEX", "expected END OF HEADER"},
      {old_text, "     6    P1", "     7    P1", "log.05o:3: found type 7 of 7 left blank"},
      {old_text, "     6    P1", "   600    P1", "log.05o:3: found 600 types, expected 1 to 99"},
      {old_text, "GPS", "UTX", "log.05o:5: found the time system \"UTX\""},
      {old_text, " 05  3 24 13 10 54", " 05  3 24 13 10 36", "log.05o:14: found an epoch at or before the one before"},
      {old_text, " 05  3 24 13 10 54", " 05 13 24 13 10 54", "log.05o:14: found \" 05 13"},
      {old_text, "  3G12", "  4G12", "log.05o:7: found"},
      {old_text, "  3G12G 9", "  3G12G12", "log.05o:10: found G12 a second time in one epoch"},
      {old_text, "  3G12", "999G12", "log.05o:7: found 999 satellites, expected 0 to 200"},
      {old_text, "23629347.915", "2362934x.915", "log.05o:8: found"},
      {old_text, ".0000000  1  1G12", ".0000000  8  1G12", "log.05o:14: found the flag 8, expected 0 to 6"},
      {text, "E11", "J11", "found the system J without types in the header"},
      {text, "> 2006 03 24 13 10", "X 2006 03 24 13 10", "log.05o:6: found"},
      {text, "  0  2 ", "  0  3 ", "log.05o:9: found"},
      {text, "G    3", "G   -3", "log.05o:2: found -3 types"},
  };
  for (const Damage& kind : kinds) {
    const std::string error = error_of(kind.of, kind.what, kind.with);
    EXPECT_THAT(error, HasSubstr(std::string(kind.error))) << kind.what;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  // Cut short in the middle of an epoch.
  EXPECT_THAT(error_of(text.substr(0, text.find("E11"))), HasSubstr("found the end of the file, expected"));
}

}  // namespace
}  // namespace vbar::observation_files
