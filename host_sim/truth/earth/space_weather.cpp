#include "host_sim/truth/earth/space_weather.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/earth/weather_formats.h"

namespace vbar::truth {
namespace {

constexpr int kSlotsPerDay = 8;  // slots of three hours
constexpr fsw::Duration kSlot = fsw::duration_of_seconds(10800);
constexpr int kSlotsOfMemory = 19;  // 57 hours
constexpr std::size_t kFewestDays = 4;

/// Three-hourly slot of the day; the leap second belongs to the last.
int slot_of_day(fsw::GpsTime time, int mjd_utc) {
  const std::int64_t slot = (time - midnight_utc(mjd_utc)).ns / kSlot.ns;
  return std::min(static_cast<int>(slot), kSlotsPerDay - 1);
}

}  // namespace

SpaceWeather SpaceWeather::load(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the space weather file", file.string()));
  std::vector<Day> days = read_weather(stream.view(), file.string());
  if (days.size() < kFewestDays) {
    throw std::runtime_error(
        fmt::format("{}: {} days of space weather; at least {} are needed", file.string(), days.size(), kFewestDays));
  }
  return SpaceWeather(std::move(days));
}

SpaceWeather SpaceWeather::constant(double f107, double ap) {
  SpaceWeather weather;
  SolarIndices& indices = weather.constant_.emplace();
  indices.f107 = indices.f107_average = f107;
  indices.ap_daily = ap;
  indices.ap_history.fill(ap);
  return weather;
}

const SpaceWeather::Day* SpaceWeather::find_first(Kind kind, fsw::GpsTime begin, fsw::GpsTime end) const {
  constexpr int kDaysOfMemory = 3;
  if (constant_) return nullptr;
  const int first = mjd_utc_of(begin) - kDaysOfMemory, last = mjd_utc_of(end);
  const auto found = std::ranges::find_if(
      days_, [&](const Day& day) { return day.kind == kind && day.mjd_utc >= first && day.mjd_utc <= last; });
  return found == days_.end() ? nullptr : &*found;
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
  if (constant_) {
    SolarIndices indices = *constant_;
    indices.geomagnetic_index = geomagnetic_index;
    return indices;
  }
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
