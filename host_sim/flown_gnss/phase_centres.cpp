#include <optional>

#include <fmt/format.h>

#include "fsw/gnss/constants.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/flown_gnss/ephemeris_fit.h"
#include "host_sim/orbit_files/published_time.h"

namespace vbar::flown_gnss {
namespace {

using files::TextLines;
using fsw::GpsTime;

std::string_view label_of(const TextLines& lines) {
  return files::trimmed(lines.columns(61, 80));
}

GpsTime instant(const TextLines& lines) {
  const auto time =
      orbit_files::instant_of_carried({lines.integer_in(1, 6, "the year"), lines.integer_in(7, 12, "the month"),
                                       lines.integer_in(13, 18, "the day"), lines.integer_in(19, 24, "the hour"),
                                       lines.integer_in(25, 30, "the minute"), lines.number_in(31, 43, "the seconds")},
                                      orbit_files::TimeSystem::kGps);
  if (!time) lines.refuse("a date and a time of day from 1980 on");
  return *time;
}

/// One antenna of the file.
struct Antenna {
  std::optional<int> gps_satellite;
  bool is_valid = true;  ///< at the time that is asked for
  std::optional<double> first_m, second_m;
};

/// Reads the lines of an antenna behind its first one.
Antenna read_antenna(TextLines& lines, GpsTime time) {
  Antenna antenna;
  std::string frequency;
  while (lines.next()) {
    const std::string_view label = label_of(lines);
    if (label == "END OF ANTENNA") return antenna;
    if (label == "TYPE / SERIAL NO" && lines.columns(21, 21) == "G") {
      const auto number = files::integer_of(lines.columns(22, 23));
      if (number && files::trimmed(lines.columns(24, 40)).empty()) antenna.gps_satellite = number;
    }
    if (!antenna.gps_satellite) continue;
    if (label == "VALID FROM" && time < instant(lines)) antenna.is_valid = false;
    if (label == "VALID UNTIL" && time > instant(lines)) antenna.is_valid = false;
    if (label == "START OF FREQUENCY") frequency = files::trimmed(lines.columns(1, 60));
    if (label == "NORTH / EAST / UP") {
      const double offset_m = 1e-3 * lines.number_in(21, 30, "the offset along z");
      if (frequency == "G01") antenna.first_m = offset_m;
      if (frequency == "G02") antenna.second_m = offset_m;
    }
  }
  lines.refuse("the end of the file", "END OF ANTENNA");
}

}  // namespace

PhaseCentres read_phase_centres(std::string_view text, const std::string& file, GpsTime time) {
  TextLines lines(text, file);
  if (!lines.next() || label_of(lines) != "ANTEX VERSION / SYST")
    lines.refuse("ANTEX VERSION / SYST in columns 61 to 80 of the first line");
  PhaseCentres centres;
  while (lines.next()) {
    if (label_of(lines) != "START OF ANTENNA") continue;
    const Antenna antenna = read_antenna(lines, time);
    if (!antenna.gps_satellite || !antenna.is_valid || !antenna.first_m || !antenna.second_m) continue;
    constexpr double kGamma = (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz) * (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz);
    const double offset_m = (kGamma * *antenna.first_m - *antenna.second_m) / (kGamma - 1.0);
    constexpr double kLargest_m = 10.0;
    if (!(offset_m > -kLargest_m && offset_m < kLargest_m))
      lines.refuse(fmt::format("an offset of {:.6g} m", offset_m), "one below 10 m");
    centres[*antenna.gps_satellite] = offset_m;
  }
  if (centres.empty()) lines.refuse("no antenna of a GPS satellite in orbit at that time", "at least one");
  return centres;
}

}  // namespace vbar::flown_gnss
