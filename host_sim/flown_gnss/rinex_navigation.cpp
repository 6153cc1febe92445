#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "host_sim/flown_gnss/ephemeris_fit.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::flown_gnss {
namespace {

using twins::gnss::Ephemeris;

constexpr int kSecondsPerWeek = 604800;

/// A number in 19 columns with 13 digits.
std::string field(double value) {
  return fmt::format("{:19.12E}", value);
}

std::string line_of(const std::array<double, 4>& values) {
  std::string line(4, ' ');
  for (const double value : values) line += field(value);
  return line + "\n";
}

std::string record_of(const Ephemeris& set) {
  const twins::gnss::WeekTime toe = week_time(set.satellite.system, set.toe);
  const double toe_s = toe.seconds_of_week();
  // GPS time as a calendar: UTC without leap seconds.
  const twins::gnss::CalendarTime toc = twins::gnss::utc_calendar(set.toe, {});
  // The longitude of the node at the begin of the week; the message counts it from -pi to pi.
  const double omega0 = std::remainder(set.node_at_toe + twins::gnss::earth_rate(set.satellite.system) * toe_s,
                                       2.0 * 3.14159265358979323846);
  // A new issue each time, for as long as a decoder keeps two sets.
  const double issue = static_cast<double>(toe.ns_of_week / 900'000'000'000 % 256);
  std::string text = fmt::format("{} {:04} {:02} {:02} {:02} {:02} {:02}", name_of(set.satellite), toc.year, toc.month,
                                 toc.day, toc.hour, toc.minute, toc.millisecond / 1000);
  text += field(set.af0) + field(set.af1) + field(set.af2) + "\n";
  text += line_of({issue, set.crs, set.delta_n, set.m0});
  text += line_of({set.cuc, set.e, set.cus, set.sqrt_a});
  text += line_of({toe_s, set.cic, omega0, set.cis});
  text += line_of({set.i0, set.crc, set.omega, set.omega_dot});
  text += line_of({set.i_dot, 0.0, static_cast<double>(toe.week), 0.0});
  text += line_of({0.0, 0.0, set.group_delay_s, issue});
  text += line_of({toe_s - 7200.0 < 0.0 ? toe_s - 7200.0 + kSecondsPerWeek : toe_s - 7200.0, 0.0, 0.0, 0.0});
  return text;
}

}  // namespace

std::string rinex_navigation(const std::vector<FittedSet>& sets, const twins::gnss::BroadcastCorrections& corrections) {
  const auto header = [](std::string_view content, std::string_view label) {
    return fmt::format("{:<60}{:<20}\n", content, label);
  };
  std::string text =
      header(fmt::format("{:>9.2f}{:11}{:<20}{:<20}", 3.04, "", "NAVIGATION DATA", "GPS"), "RINEX VERSION / TYPE");
  text += header("vbar_fit_ephemerides", "PGM / RUN BY / DATE");
  text += header("Elements fitted to a precise orbit, not as broadcast", "COMMENT");
  const auto& ionosphere = corrections.klobuchar;
  if (!(ionosphere == twins::gnss::KlobucharCoefficients{})) {
    const auto four = [](std::string_view name, const std::array<double, 4>& values) {
      std::string line(name);
      line += ' ';
      for (const double value : values) line += fmt::format("{:12.4E}", value);
      return line;
    };
    text += header(four("GPSA", ionosphere.alpha), "IONOSPHERIC CORR");
    text += header(four("GPSB", ionosphere.beta), "IONOSPHERIC CORR");
  }
  text += header("", "END OF HEADER");
  for (const FittedSet& set : sets) text += record_of(set.elements);
  return text;
}

}  // namespace vbar::flown_gnss
