#include "host_sim/truth/earth/space_weather.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/truth/earth/daily_table.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/earth/utc_day.h"

namespace vbar::truth {
namespace {

constexpr int kSlotsPerDay = 8;  // of three hours
constexpr fsw::Duration kSlot = fsw::duration_of_seconds(10800);
constexpr int kSlotsOfMemory = 19;  // 57 hours
constexpr std::size_t kFewestDays = 4;

constexpr std::size_t kColumnCount = 12;
constexpr std::string_view kColumns =
    "mjd_utc,ap1,ap2,ap3,ap4,ap5,ap6,ap7,ap8,ap_daily,f107_observed,f107_observed_81d";

// ap on its scale, and a flux that a quiet Sun or a flare can have.
constexpr double kLargestAp = 400.0;
constexpr double kLargestFlux = 1000.0;
constexpr std::string_view kAccepted = "ap of 0 to 400 and fluxes above 0 and up to 1000";

using Row = std::array<double, kColumnCount>;

bool in_range(const Row& row) {
  const auto is_ap = [](double ap) { return ap >= 0.0 && ap <= kLargestAp; };
  const auto is_flux = [](double flux) { return flux > 0.0 && flux <= kLargestFlux; };
  return std::all_of(row.begin() + 1, row.begin() + 10, is_ap) && is_flux(row[10]) && is_flux(row[11]);
}

SpaceWeather::Day day_of(const Row& row) {
  SpaceWeather::Day day;
  day.mjd_utc = static_cast<int>(row[0]);
  std::copy_n(row.begin() + 1, kSlotsPerDay, day.ap.begin());
  day.ap_daily = row[9];
  day.f107 = row[10];
  day.f107_average = row[11];
  return day;
}

/// Three-hourly slot of the day; the leap second belongs to the last.
int slot_of_day(fsw::GpsTime time, int mjd_utc) {
  const std::int64_t slot = (time - midnight_utc(mjd_utc)).ns / kSlot.ns;
  return std::min(static_cast<int>(slot), kSlotsPerDay - 1);
}

}  // namespace

SpaceWeather SpaceWeather::load(const std::filesystem::path& file) {
  std::vector<Day> days;
  read_daily_table<kColumnCount>(file, "space weather", kColumns, [&](int /*mjd_utc*/, const Row& row) {
    days.push_back(day_of(row));
    return std::string(in_range(row) ? "" : kAccepted);
  });
  if (days.size() < kFewestDays) {
    throw std::runtime_error(
        fmt::format("{}: {} days of space weather; at least {} are needed", file.string(), days.size(), kFewestDays));
  }
  return SpaceWeather(std::move(days));
}

SpaceWeather::SpaceWeather(std::vector<Day> days) : days_(std::move(days)) {
  if (days_.size() < kFewestDays) throw std::invalid_argument("space weather needs at least four days");
  ap_.reserve(kSlotsPerDay * days_.size());
  for (std::size_t i = 0; i < days_.size(); ++i) {
    if (days_[i].mjd_utc != days_.front().mjd_utc + static_cast<int>(i)) {
      throw std::invalid_argument("days of space weather must follow without gaps");
    }
    ap_.insert(ap_.end(), days_[i].ap.begin(), days_[i].ap.end());
  }
}

SolarIndices SpaceWeather::indices_at(fsw::GpsTime time, GeomagneticIndex geomagnetic_index) const {
  if (time.ns < 0) refuse(time, geomagnetic_index);
  const int mjd = mjd_utc_of(time);
  const int day = mjd - days_.front().mjd_utc;
  if (day < 1 || day >= static_cast<int>(days_.size())) refuse(time, geomagnetic_index);
  const Day& today = days_[static_cast<std::size_t>(day)];
  const Day& yesterday = days_[static_cast<std::size_t>(day) - 1];

  SolarIndices indices;
  indices.f107 = yesterday.f107;
  indices.f107_average = today.f107_average;
  indices.geomagnetic_index = geomagnetic_index;
  if (geomagnetic_index == GeomagneticIndex::kDaily) {
    indices.ap_daily = today.ap_daily;
    return indices;
  }
  const int slot = kSlotsPerDay * day + slot_of_day(time, mjd);
  if (slot < kSlotsOfMemory) refuse(time, geomagnetic_index);
  indices.ap_history = {ap_before(slot, 0),
                        ap_before(slot, 1),
                        ap_before(slot, 2),
                        ap_before(slot, 3),
                        mean_of_eight_before(slot, 4),
                        mean_of_eight_before(slot, 12)};
  return indices;
}

double SpaceWeather::mean_of_eight_before(int slot, int latest) const {
  double sum = 0.0;
  for (int i = latest; i < latest + 8; ++i) sum += ap_before(slot, i);
  return sum / 8.0;
}

fsw::GpsTime SpaceWeather::next_change_after(fsw::GpsTime time, GeomagneticIndex geomagnetic_index) {
  const int mjd = mjd_utc_of(time);
  const fsw::GpsTime next_midnight = midnight_utc(mjd + 1);
  if (geomagnetic_index == GeomagneticIndex::kDaily) return next_midnight;
  const int next_slot = slot_of_day(time, mjd) + 1;
  if (next_slot == kSlotsPerDay) return next_midnight;
  return midnight_utc(mjd) + fsw::Duration{next_slot * kSlot.ns};
}

void SpaceWeather::refuse(fsw::GpsTime time, GeomagneticIndex geomagnetic_index) const {
  const bool daily = geomagnetic_index == GeomagneticIndex::kDaily;
  const int first = days_.front().mjd_utc;
  const fsw::Duration memory{kSlotsOfMemory * kSlot.ns};
  const fsw::GpsTime begin = daily ? midnight_utc(first + 1) : midnight_utc(first) + memory;
  throw std::out_of_range(
      fmt::format("no {} space weather at {}: the data, with the history that is needed, reach from {} to {}",
                  daily ? "daily" : "three-hourly", time.ns < 0 ? "a time before 1980" : format_utc(time, 0),
                  format_utc(begin, 0), format_utc(midnight_utc(days_.back().mjd_utc + 1), 0)));
}

}  // namespace vbar::truth
