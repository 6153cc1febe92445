#include "host_sim/truth/earth/earth_orientation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>

#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/earth/utc_day.h"

namespace vbar::truth {
namespace {

constexpr int kMjdOfGpsEpoch = 44244;
constexpr int kLastMjd = 88068;  // 2099-12-31: beyond it a file is no record of observations
constexpr std::string_view kColumns = "mjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec";

/// The six numbers of a row; false if there are not exactly six.
bool parse_row(std::string_view line, double (&values)[6]) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (int column = 0; column < 6; ++column) {
    const auto [next, error] = std::from_chars(at, end, values[column]);
    if (error != std::errc{} || !std::isfinite(values[column])) return false;
    at = next;
    if (column < 5 && (at == end || *at++ != ',')) return false;
  }
  return at == end;
}

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
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot open the Earth orientation file", file.string()));
  std::vector<Day> days;
  std::string line;
  bool header_seen = false;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with('#')) continue;
    if (!header_seen) {
      if (line != kColumns) {
        throw std::runtime_error(
            fmt::format("{}:{}: found \"{}\", expected the columns {}", file.string(), number, line, kColumns));
      }
      header_seen = true;
      continue;
    }
    double row[6];
    if (!parse_row(line, row) || row[0] != std::floor(row[0]) || row[0] < kMjdOfGpsEpoch || row[0] > kLastMjd) {
      throw std::runtime_error(
          fmt::format("{}:{}: found \"{}\", expected six numbers: {}", file.string(), number, line, kColumns));
    }
    const int mjd_utc = static_cast<int>(row[0]);
    if (!days.empty() && mjd_utc != days.back().mjd_utc + 1) {
      throw std::runtime_error(fmt::format("{}:{}: day {} follows day {}; days must follow without gaps", file.string(),
                                           number, mjd_utc, days.back().mjd_utc));
    }
    days.push_back({mjd_utc,
                    {row[3] - tai_minus_utc_s(mjd_utc), row[1] * ERFA_DAS2R, row[2] * ERFA_DAS2R, row[4] * ERFA_DAS2R,
                     row[5] * ERFA_DAS2R}});
  }
  if (days.size() < 4) {
    throw std::runtime_error(
        fmt::format("{}: {} days of Earth orientation; at least four are needed", file.string(), days.size()));
  }
  return EarthOrientationSeries(std::move(days));
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
  }
}

EarthOrientation EarthOrientationSeries::at(fsw::GpsTime epoch, double seconds) const {
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
