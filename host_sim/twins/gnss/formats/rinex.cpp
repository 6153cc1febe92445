// RINEX 2.11 (Gurtner 2007), 3.05 (Romero 2020) and 4.00 (Romero 2021), IGS.

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/formats/ephemeris_formats.h"
#include "host_sim/twins/gnss/formats/rinex_header.h"
#include "host_sim/twins/gnss/formats/rinex_records.h"

namespace vbar::twins::gnss {
namespace {

constexpr std::int64_t kDay_ns = 86400 * fsw::kNanosecondsPerSecond;

fsw::GpsTime noon_of(std::vector<Ephemeris>& sets) {
  const auto median = sets.begin() + static_cast<std::ptrdiff_t>(sets.size() / 2);
  std::vector<std::int64_t> times;
  for (const Ephemeris& set : sets) times.push_back(set.toe.ns);
  std::ranges::sort(times);
  const std::int64_t middle = times[static_cast<std::size_t>(median - sets.begin())];
  return {middle / kDay_ns * kDay_ns + kDay_ns / 2};
}

/// Of each satellite the set whose reference time is nearest to `noon`, the earlier of two as near.
std::vector<Ephemeris> nearest_to(fsw::GpsTime noon, const std::vector<Ephemeris>& sets) {
  const auto distance = [&](const Ephemeris& set) { return std::abs((set.toe - noon).ns); };
  std::map<SatelliteId, Ephemeris> nearest;
  for (const Ephemeris& set : sets) {
    const auto [place, is_new] = nearest.try_emplace(set.satellite, set);
    if (!is_new && distance(set) < distance(place->second)) place->second = set;
  }
  std::vector<Ephemeris> result;
  for (const auto& [satellite, set] : nearest) result.push_back(set);
  return result;
}

}  // namespace

bool is_rinex(std::string_view text) {
  files::TextLines lines(text, "");
  return lines.next() && files::trimmed(lines.columns(61, 80)) == "RINEX VERSION / TYPE";
}

EphemerisFile read_rinex(std::string_view text, const std::string& file) {
  files::TextLines lines(text, file);
  const RinexHeader header = read_rinex_header(lines);
  EphemerisFile result;
  result.corrections = header.corrections;
  RinexRecords records(lines, header.version);
  std::vector<Ephemeris> sets;
  while (const auto record = records.next(result.corrections)) sets.push_back(ephemeris_of(*record));
  if (sets.empty()) lines.refuse("no record of GPS, Galileo or BeiDou", "at least one");
  result.satellites = nearest_to(noon_of(sets), sets);
  return result;
}

}  // namespace vbar::twins::gnss
