#include "host_sim/twins/gnss/formats/ephemeris_formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {

std::span<const EphemerisFormat> ephemeris_formats() {
  static constexpr std::array kFormats{
      EphemerisFormat{"RINEX navigation file (2, 3 or 4)", is_rinex, read_rinex},
      EphemerisFormat{"the table of data/gps", is_ephemeris_table, read_ephemeris_table},
  };
  return kFormats;
}

EphemerisFile read_ephemerides(std::string_view text, const std::string& file, const SystemSet& used) {
  const auto formats = ephemeris_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file, used);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const EphemerisFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("broadcast ephemerides in one of the formats {}", fmt::join(names, ", ")));
}

EphemerisFile read_ephemeris_file(const std::filesystem::path& file, const SystemSet& used) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  return read_ephemerides(stream.view(), file.string(), used);
}

std::string problem_of(const BroadcastRecord& record) {
  constexpr double kLastWeek = 9999.0;  // the year 2171
  const Ephemeris& set = record.elements;
  if (!(record.week >= 0.0 && record.week <= kLastWeek && record.week == std::floor(record.week)))
    return fmt::format("week {} is not an integer from 0 to {}", record.week, kLastWeek);
  if (!(record.toe_s >= 0.0 && record.toe_s < static_cast<double>(kSecondsPerWeek)))
    return fmt::format("toe of {} s does not lie in a week", record.toe_s);
  if (!(std::abs(record.toc_s - record.toe_s) <= kLongestClockAge_s))
    return fmt::format("week and toe are {:.0f} s from the reference time of the clock; they must lie within a day",
                       std::abs(record.toc_s - record.toe_s));
  if (!(set.sqrt_a > 2000.0 && set.sqrt_a < 9000.0))
    return fmt::format("sqrt_a of {} m^(1/2) does not lie between 2000 and 9000", set.sqrt_a);
  if (!(set.e >= 0.0 && set.e < kMaxEccentricity))
    return fmt::format("an eccentricity of {} does not lie between 0 and {}", set.e, kMaxEccentricity);
  return {};
}

Ephemeris ephemeris_of(const BroadcastRecord& record) {
  Ephemeris set = record.elements;
  const System system = record.satellite.system;
  set.satellite = record.satellite;
  set.toe = gps_time_of(system, static_cast<int>(record.week), static_cast<std::int64_t>(record.toe_s));
  set.node_at_toe = record.omega0 - earth_rate(system) * record.toe_s;
  const double elapsed_s = record.toe_s - record.toc_s;
  set.af0 = record.af0 + (record.af1 + record.af2 * elapsed_s) * elapsed_s;
  set.af1 = record.af1 + 2.0 * record.af2 * elapsed_s;
  set.af2 = record.af2;
  return set;
}

}  // namespace vbar::twins::gnss
