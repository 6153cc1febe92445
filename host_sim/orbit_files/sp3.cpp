#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "host_sim/orbit_files/ccsds_messages.h"

namespace vbar::orbit_files {
namespace {

using files::TextLines;
using fsw::Vector3;

/// Returns the median step of a track: files that were thinned state the former interval in their first lines.
double median_step_s(const Track& track) {
  std::vector<double> steps_s;
  for (std::size_t k = 1; k < track.states.size(); ++k)
    steps_s.push_back(fsw::seconds(track.states[k].time - track.states[k - 1].time));
  if (steps_s.empty()) return 0.0;
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::ranges::nth_element(steps_s, middle);
  return *middle;
}

class Sp3Reader {
 public:
  Sp3Reader(std::string_view text, const std::string& file) : lines_(text, file) {}

  std::vector<Track> read() {
    read_first_lines();
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.starts_with("EOF")) return finished();
      if (line.starts_with("%c")) take_time_system();
      if (line.starts_with("*")) take_epoch();
      if (line.starts_with("P")) take_position();
      if (line.starts_with("V") && has_velocities_) take_velocity();
    }
    lines_.refuse("the end of the file", "EOF in its last line");
  }

 private:
  void read_first_lines() {
    lines_.next();
    const std::string_view mode = lines_.columns(3, 3);
    if (mode != "P" && mode != "V") lines_.refuse("P or V in column 3 of the first line");
    has_velocities_ = mode == "V";
    if (!lines_.next() || !lines_.line().starts_with("##")) lines_.refuse("## in the second line");
    interval_s_ = lines_.number_in(25, 38, "the interval of the epochs");
    if (!(interval_s_ > 0.0 && interval_s_ <= 86400.0)) lines_.refuse("an interval above 0 and up to 86400 s");
  }

  /// In the first of two lines; version a has none, which means GPS.
  void take_time_system() {
    if (std::exchange(has_time_system_, true)) return;
    const std::string_view name = files::trimmed(lines_.columns(10, 12));
    if (name == "ccc" || name.empty()) return;
    const auto system = time_system_named(name);
    if (!system) lines_.refuse(fmt::format("the time system {}", files::quoted(name)), "GPS, GAL, BDT, TAI or UTC");
    system_ = *system;
  }

  void take_epoch() {
    const auto time =
        instant_of_carried({lines_.integer_in(4, 7, "the year"), lines_.integer_in(9, 10, "the month"),
                            lines_.integer_in(12, 13, "the day"), lines_.integer_in(15, 16, "the hour"),
                            lines_.integer_in(18, 19, "the minute"), lines_.number_in(21, 31, "the seconds")},
                           system_);
    if (!time || lines_.integer_in(9, 10, "the month") == 0) lines_.refuse("a date and a time of day");
    if (time_ && *time <= *time_) lines_.refuse("an epoch at or before the one before", "epochs in ascending order");
    time_ = time;
  }

  Vector3 three_numbers() const {
    return {lines_.number_in(5, 18, "x"), lines_.number_in(19, 32, "y"), lines_.number_in(33, 46, "z")};
  }

  Track& track() {
    const std::string name(files::trimmed(lines_.columns(2, 4)));
    if (name.empty()) lines_.refuse("a satellite in columns 2 to 4");
    if (!time_) lines_.refuse("a position before the first epoch", "an epoch (*) before it");
    Track& one = tracks_[name];
    one.object = name;
    return one;
  }

  void take_position() {
    const Vector3 position_km = three_numbers();
    Track& one = track();
    is_missing_ = position_km.isZero(0.0);
    if (is_missing_) return;
    if (!one.states.empty() && one.states.back().time == *time_)
      lines_.refuse("a second position of one satellite and epoch", "one");
    TimedState state;
    state.time = *time_;
    state.state.position_eci = 1e3 * position_km;
    constexpr double kSmallestRadius = 6.4e6, kLargestRadius = 1e9;
    const double radius = state.state.position_eci.norm();
    if (!(radius > kSmallestRadius && radius < kLargestRadius))
      lines_.refuse(fmt::format("a position {:.6g} km from the Earth's centre", 1e-3 * radius), "6400 to 1e6 km");
    state.clock_s = clock_s();
    one.states.push_back(state);
  }

  /// Microseconds in columns 47 to 60, which a line may lack.
  std::optional<double> clock_s() const {
    constexpr double kMissing_us = 999'999.0;
    const auto clock_us = lines_.number_or_blank_in(47, 60, "the clock");
    return clock_us && std::abs(*clock_us) < kMissing_us ? std::optional(1e-6 * *clock_us) : std::nullopt;
  }

  void take_velocity() {
    if (is_missing_) return;
    const Vector3 velocity_dmps = three_numbers();
    Track& one = track();
    if (one.states.empty() || one.states.back().time != *time_)
      lines_.refuse("a velocity without a position", "a velocity behind the satellite's position");
    ++velocities_[one.object];
    if (velocity_dmps.isZero(0.0)) {
      without_velocity_.insert(one.object);
      return;
    }
    fsw::orbit::CartesianState& state = one.states.back().state;
    state.velocity_eci = 0.1 * velocity_dmps;
    check_state(lines_, state, Frame::kItrf);
  }

  std::vector<Track> finished() {
    std::vector<Track> tracks;
    for (auto& [name, track] : tracks_) {
      if (track.states.empty()) continue;
      track.frame = Frame::kItrf;
      track.has_velocities = has_velocities_ && !without_velocity_.contains(name);
      track.largest_step_s = 1.5 * std::max(interval_s_, median_step_s(track));
      if (has_velocities_ && velocities_[name] != track.states.size())
        lines_.refuse(fmt::format("{} positions and {} velocities of {}", track.states.size(), velocities_[name], name),
                      "a velocity for each position");
      tracks.push_back(std::move(track));
    }
    if (tracks.empty()) lines_.refuse("no position", "at least one");
    return tracks;
  }

  TextLines lines_;
  bool has_velocities_ = false, has_time_system_ = false, is_missing_ = false;
  double interval_s_ = 0.0;
  TimeSystem system_ = TimeSystem::kGps;
  std::optional<fsw::GpsTime> time_;
  std::map<std::string, Track> tracks_;
  std::map<std::string, std::size_t> velocities_;
  std::set<std::string> without_velocity_;
};

}  // namespace

bool is_sp3(std::string_view text) {
  constexpr std::string_view kVersions = "abcd";
  return text.size() > 3 && text[0] == '#' && kVersions.find(text[1]) != std::string_view::npos &&
         (text[2] == 'P' || text[2] == 'V');
}

std::vector<Track> read_sp3(std::string_view text, const std::string& file) {
  return Sp3Reader(text, file).read();
}

}  // namespace vbar::orbit_files
