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

/// Returns one set of each satellite: that whose reference time is nearest to `noon`, the earlier of two as near.
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

EphemerisFile read_rinex(std::string_view text, const std::string& file, const SystemSet& used) {
  files::TextLines lines(text, file);
  const RinexHeader header = read_rinex_header(lines);
  EphemerisFile result;
  result.corrections = header.corrections;
  RinexRecords records(lines, header.version, used);
  std::vector<Ephemeris> sets;
  while (const auto record = records.next(result.corrections)) sets.push_back(ephemeris_of(*record));
  const std::string left_out = records.left_out().text();
  // A run may take its systems from several files.
  if (sets.empty() && !records.has_unused_systems())
    lines.refuse(left_out.empty() ? "no record of a satellite" : fmt::format("nothing but {}", left_out),
                 "at least one set of GPS LNAV, Galileo I/NAV or BeiDou D1 or D2");
  if (!sets.empty()) result.satellites = nearest_to(noon_of(sets), sets);
  if (!left_out.empty()) result.note = fmt::format("{}: not used are {}.", file, left_out);
  if (const int resolved = records.sets_with_resolved_week(); resolved > 0)
    result.note += fmt::format("{}{}: sets whose week is counted modulo 1024 and resolved by their date: {}.",
                               result.note.empty() ? "" : " ", file, resolved);
  return result;
}

}  // namespace vbar::twins::gnss
