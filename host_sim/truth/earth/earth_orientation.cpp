#include "host_sim/truth/earth/earth_orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/truth/earth/orientation_formats.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {
namespace {

EarthOrientation& operator+=(EarthOrientation& sum, const EarthOrientation& term) {
  sum.ut1_minus_tai_s += term.ut1_minus_tai_s;
  sum.pole_x += term.pole_x;
  sum.pole_y += term.pole_y;
  sum.cip_dx += term.cip_dx;
  sum.cip_dy += term.cip_dy;
  return sum;
}

EarthOrientation operator*(double factor, const EarthOrientation& orientation) {
  return {factor * orientation.ut1_minus_tai_s, factor * orientation.pole_x, factor * orientation.pole_y,
          factor * orientation.cip_dx, factor * orientation.cip_dy};
}

}  // namespace

EarthOrientationSeries EarthOrientationSeries::load(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the Earth orientation file", file.string()));
  std::vector<Day> days = read_orientation(stream.view(), file.string());
  if (days.size() < 4) {
    throw std::runtime_error(
        fmt::format("{}: {} days of Earth orientation; at least four are needed", file.string(), days.size()));
  }
  return EarthOrientationSeries(std::move(days));
}

EarthOrientationSeries EarthOrientationSeries::unknown(fsw::GpsTime time) {
  EarthOrientationSeries series;
  series.is_constant_ = true;
  series.nodes_.push_back({0.0, {.ut1_minus_tai_s = -tai_minus_utc_s(mjd_utc_of(time))}});
  return series;
}

EarthOrientationSeries::EarthOrientationSeries(std::vector<Day> days) {
  if (days.size() < 4) throw std::invalid_argument("Earth orientation needs at least four days");
  first_ = midnight_utc(days.front().mjd_utc);
  nodes_.reserve(days.size());
  for (const Day& day : days) {
    if (day.mjd_utc != days.front().mjd_utc + static_cast<int>(nodes_.size())) {
      throw std::invalid_argument("days of Earth orientation must follow without gaps");
    }
    nodes_.push_back({fsw::seconds(midnight_utc(day.mjd_utc) - first_), day.orientation});
    if (day.is_predicted && !predicted_from_) {
      // The polynomial reaches two days back.
      const int from = std::max(day.mjd_utc - 2, days.front().mjd_utc);
      predicted_from_ = midnight_utc(from);
    }
  }
}

EarthOrientation EarthOrientationSeries::at(fsw::GpsTime epoch, double seconds) const {
  if (is_constant_) return nodes_.front().orientation;
  const double time = fsw::seconds(epoch - first_) + seconds;
  if (!(time >= 0.0 && time <= nodes_.back().tai_s)) {
    const auto end = first_ + fsw::nearest_duration(nodes_.back().tai_s);
    const auto asked = epoch + fsw::nearest_duration(std::clamp(seconds, -3e9, 3e9));
    throw std::out_of_range(fmt::format("no Earth orientation at {}: the data reach from {} to {}",
                                        asked.ns < 0 ? "a time before 1980" : format_utc(asked, 0),
                                        format_utc(first_, 0), format_utc(end, 0)));
  }
  // Nodes are 86400 s apart, or 86401 s on a day with a leap second: the guess is right or one too late.
  auto interval = std::min(static_cast<std::size_t>(time / kSecondsPerDay), nodes_.size() - 2);
  if (time < nodes_[interval].tai_s) --interval;
  const std::size_t start = std::min(interval == 0 ? 0 : interval - 1, nodes_.size() - 4);

  EarthOrientation sum;
  for (std::size_t i = start; i < start + 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = start; j < start + 4; ++j) {
      if (j != i) weight *= (time - nodes_[j].tai_s) / (nodes_[i].tai_s - nodes_[j].tai_s);
    }
    sum += weight * nodes_[i].orientation;
  }
  return sum;
}

}  // namespace vbar::truth
