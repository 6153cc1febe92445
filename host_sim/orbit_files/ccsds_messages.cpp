#include "host_sim/orbit_files/ccsds_messages.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <Eigen/Geometry>
#include <erfa.h>
#include <fmt/format.h>

namespace vbar::orbit_files {

namespace {

using files::TextLines;

/// To GCRF from the mean equator and equinox of J2000: the frame bias of IAU 2006, 23 mas.
Eigen::Matrix3d R_gcrf_eme2000() {
  constexpr double kJ2000 = 2451545.0;
  double bias[3][3], precession[3][3], both[3][3];
  eraBp06(kJ2000, 0.0, bias, precession, both);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&bias[0][0]).transpose();
}

/// Whether the frame is ITRF or one of its realisations: ITRF2014, ITRF-97, ITRF97. They differ by centimetres, 1988
/// from 2020 by a decimetre.
bool is_itrf(std::string_view frame) {
  constexpr std::array<std::string_view, 14> kYears{"88", "89", "90", "91",   "92",   "93",   "94",
                                                    "96", "97", "00", "2000", "2005", "2008", "2014"};
  constexpr std::string_view kName = "ITRF", kLatest = "2020";
  if (!frame.starts_with(kName)) return false;
  frame.remove_prefix(kName.size());
  if (frame.empty()) return true;
  if (frame.starts_with('-')) frame.remove_prefix(1);
  if (frame.starts_with("19") && frame.size() == 4) frame.remove_prefix(2);
  return frame == kLatest || std::ranges::find(kYears, frame) != kYears.end();
}

MessageFrame frame_named(const TextLines& lines, std::string_view frame) {
  if (frame == "GCRF" || frame == "ICRF") return {};
  if (frame == "EME2000" || frame == "J2000") return {Frame::kGcrf, R_gcrf_eme2000()};
  if (is_itrf(frame)) return {.frame = Frame::kItrf};
  lines.refuse(fmt::format("REF_FRAME {}", files::quoted(frame)),
               "GCRF, ICRF, EME2000 or ITRF, also with its year (ITRF2014, ITRF-97)");
}

}  // namespace

std::optional<Keyword> keyword_in(std::string_view line) {
  const auto equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  Keyword keyword{files::trimmed(line.substr(0, equals)), files::trimmed(line.substr(equals + 1)), {}};
  if (keyword.value.ends_with(']')) {
    const auto bracket = keyword.value.rfind('[');
    if (bracket == std::string_view::npos) return keyword;
    keyword.unit = files::trimmed(keyword.value.substr(bracket + 1, keyword.value.size() - bracket - 2));
    keyword.value = files::trimmed(keyword.value.substr(0, bracket));
  }
  return keyword;
}

bool is_comment(const TextLines& lines) {
  const std::string_view line = files::trimmed(lines.line());
  return line.empty() || line == "COMMENT" || line.starts_with("COMMENT ");
}

bool begins_with(std::string_view text, std::string_view version_keyword) {
  TextLines lines(text, "");
  while (lines.next()) {
    if (is_comment(lines)) continue;
    const auto keyword = keyword_in(lines.line());
    return keyword && keyword->name == version_keyword;
  }
  return false;
}

void UniqueKeywords::note(const TextLines& lines, const Keyword& keyword) {
  if (!names_.emplace(keyword.name).second) lines.refuse(fmt::format("a second {}", keyword.name), "one");
}

void check_version(const TextLines& lines, const Keyword& keyword) {
  const auto version = files::number_of(keyword.value);
  if (version != 1.0 && version != 2.0 && version != 3.0)
    lines.refuse(fmt::format("{} {}", keyword.name, files::quoted(keyword.value)), "1.0, 2.0 or 3.0");
}

bool Metadata::take(const TextLines& lines, const Keyword& keyword) {
  unique_.note(lines, keyword);
  if (keyword.name == "OBJECT_NAME") {
    object = keyword.value;
  } else if (keyword.name == "OBJECT_ID") {
    object_id = keyword.value;
  } else if (keyword.name == "CENTER_NAME") {
    if (keyword.value != "EARTH" && keyword.value != "Earth")
      lines.refuse(fmt::format("CENTER_NAME {}", files::quoted(keyword.value)), "EARTH");
    has_centre = true;
  } else if (keyword.name == "REF_FRAME") {
    frame = frame_named(lines, keyword.value);
  } else if (keyword.name == "TIME_SYSTEM") {
    time_system = time_system_named(keyword.value);
    if (!time_system) lines.refuse(fmt::format("TIME_SYSTEM {}", files::quoted(keyword.value)), "UTC, TAI, TT or GPS");
  } else {
    return false;
  }
  return true;
}

void Metadata::check(const TextLines& lines) const {
  const auto need = [&](bool is_there, std::string_view keyword) {
    if (!is_there) lines.refuse(fmt::format("metadata without {}", keyword), fmt::format("{} before it", keyword));
  };
  need(!object.empty(), "OBJECT_NAME");
  need(has_centre, "CENTER_NAME");
  need(frame.has_value(), "REF_FRAME");
  need(time_system.has_value(), "TIME_SYSTEM");
}

fsw::GpsTime Metadata::time(const TextLines& lines, std::string_view text) const {
  const auto time = ccsds_time(text, time_system.value());
  if (!time) lines.refuse(files::quoted(text), "a time as 2026-11-25T12:00:00.000 or 2026-329T12:00:00.000");
  return *time;
}

fsw::orbit::CartesianState Metadata::state(const TextLines& lines, const fsw::Vector3& position_km,
                                           const fsw::Vector3& velocity_kmps) const {
  fsw::orbit::CartesianState state;
  const MessageFrame& axes = frame.value();
  state.position_eci = 1e3 * (axes.R_frame_message * position_km);
  state.velocity_eci = 1e3 * (axes.R_frame_message * velocity_kmps);
  check_state(lines, state, axes.frame);
  return state;
}

void check_state(const TextLines& lines, const fsw::orbit::CartesianState& state, Frame frame) {
  constexpr double kSmallestRadius = 6.4e6, kLargestRadius = 1e9, kSmallestSpeed = 10.0, kLargestSpeed = 12e3;
  constexpr double kEarthRate = 7.292115e-5;  // rad/s: at rest over the ground is 3 km/s in the geostationary orbit
  const fsw::Vector3 rotation(0.0, 0.0, frame == Frame::kItrf ? kEarthRate : 0.0);
  const double radius = state.position_eci.norm();
  const double speed = (state.velocity_eci + rotation.cross(state.position_eci)).norm();
  if (!(radius > kSmallestRadius && radius < kLargestRadius) || !(speed > kSmallestSpeed && speed < kLargestSpeed))
    lines.refuse(fmt::format("a state of {:.6g} km and {:.6g} km/s", 1e-3 * radius, 1e-3 * speed),
                 "an orbit about the Earth: 6400 to 1e6 km from its centre, 0.01 to 12 km/s");
}

namespace {

bool is_same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, [](unsigned char c) { return std::toupper(c); });
}

/// Metadata of a segment hold the fields that OPM has too, the segment's times, and the rule for interpolating its
/// states.
struct SegmentMetadata {
  Metadata common;
  std::string_view start, stop, useable_start, useable_stop, interpolation;
  std::optional<int> degree;

  void take(const TextLines& lines, const Keyword& keyword) {
    if (common.take(lines, keyword)) return;
    const std::array<std::pair<std::string_view, std::string_view*>, 5> texts{{{"START_TIME", &start},
                                                                               {"STOP_TIME", &stop},
                                                                               {"USEABLE_START_TIME", &useable_start},
                                                                               {"USEABLE_STOP_TIME", &useable_stop},
                                                                               {"INTERPOLATION", &interpolation}}};
    for (const auto& [name, text] : texts)
      if (keyword.name == name) *text = keyword.value;
    if (keyword.name == "INTERPOLATION_DEGREE") {
      degree = files::integer_of(keyword.value);
      if (!degree) lines.refuse(files::quoted(keyword.value), "an integer");
    }
  }

  /// The method and degree of the file; none for a method that is not named here, which the standard leaves open.
  [[nodiscard]] std::optional<InterpolationRule> rule(const TextLines& lines) const {
    constexpr int kHermiteDegree = 7, kLagrangeDegree = 9;  // where the file states a method alone
    InterpolationRule rule{.is_published = true};
    int min_degree = 3;
    if (is_same_word(interpolation, "HERMITE")) {
      rule.degree = degree.value_or(kHermiteDegree);
    } else if (is_same_word(interpolation, "LAGRANGE")) {
      rule = {Polynomial::kLagrange, degree.value_or(kLagrangeDegree), true};
      min_degree = 1;
    } else if (is_same_word(interpolation, "LINEAR")) {
      return InterpolationRule{Polynomial::kLagrange, 1, true};
    } else {
      return std::nullopt;
    }
    if (rule.degree < min_degree || rule.degree > kMaxInterpolationDegree)
      lines.refuse(fmt::format("INTERPOLATION {} of degree {}", interpolation, rule.degree),
                   fmt::format("a degree from {} to {}", min_degree, kMaxInterpolationDegree));
    return rule;
  }
};

/// Instants that the metadata of a segment state; the first or the last one there is where they state none.
struct SegmentTimes {
  std::optional<fsw::GpsTime> start, stop, useable_start, useable_stop;

  SegmentTimes(const TextLines& lines, const SegmentMetadata& metadata)
      : start(time(lines, metadata, metadata.start)),
        stop(time(lines, metadata, metadata.stop)),
        useable_start(time(lines, metadata, metadata.useable_start)),
        useable_stop(time(lines, metadata, metadata.useable_stop)) {
    refuse_after(lines, {"START_TIME", start}, {"STOP_TIME", stop});
    refuse_after(lines, {"START_TIME", start}, {"USEABLE_START_TIME", useable_start});
    refuse_after(lines, {"USEABLE_START_TIME", useable_start}, {"USEABLE_STOP_TIME", useable_stop});
    refuse_after(lines, {"USEABLE_STOP_TIME", useable_stop}, {"STOP_TIME", stop});
    refuse_after(lines, {"START_TIME", start}, {"USEABLE_STOP_TIME", useable_stop});
    refuse_after(lines, {"USEABLE_START_TIME", useable_start}, {"STOP_TIME", stop});
  }

  /// States are written to a millisecond by some programs, the times of the metadata to a second.
  void check(const TextLines& lines, fsw::GpsTime state) const {
    constexpr fsw::Duration kRounding = fsw::duration_of_seconds(1);
    if ((start && state + kRounding <= *start) || (stop && state >= *stop + kRounding))
      lines.refuse("a state outside START_TIME to STOP_TIME", "states between the times of their metadata");
  }

 private:
  using Named = std::pair<std::string_view, std::optional<fsw::GpsTime>>;

  static std::optional<fsw::GpsTime> time(const TextLines& lines, const SegmentMetadata& metadata,
                                          std::string_view text) {
    if (text.empty()) return std::nullopt;
    return metadata.common.time(lines, text);
  }

  static void refuse_after(const TextLines& lines, const Named& first, const Named& second) {
    if (first.second && second.second && *first.second > *second.second)
      lines.refuse(fmt::format("{} after {}", first.first, second.first),
                   "START_TIME, USEABLE_START_TIME, USEABLE_STOP_TIME and STOP_TIME in this order");
  }
};

/// Goes through a message segment by segment.
class OemReader {
 public:
  OemReader(std::string_view text, const std::string& file) : lines_(text, file) {}

  std::vector<Track> read() {
    std::vector<Track> tracks;
    UniqueKeywords header;
    while (next()) {
      const std::string_view line = files::trimmed(lines_.line());
      if (line == "META_START") {
        close(tracks);
        tracks.push_back(begin_segment());
      } else if (line == "COVARIANCE_START") {
        skip_covariance();
      } else if (!tracks.empty()) {
        add_state(tracks.back());
      } else {
        take_header(line, header);
      }
    }
    if (tracks.empty()) lines_.refuse("the end of the file", "META_START");
    close(tracks);
    return tracks;
  }

 private:
  bool next() {
    do {
      if (!lines_.next()) return false;
    } while (is_comment(lines_));
    return true;
  }

  void take_header(std::string_view line, UniqueKeywords& header) const {
    const auto keyword = keyword_in(line);
    if (!keyword) lines_.refuse("a keyword of the header or META_START");
    header.note(lines_, *keyword);
    if (keyword->name == "CCSDS_OEM_VERS") check_version(lines_, *keyword);
  }

  Track begin_segment() {
    metadata_ = SegmentMetadata();
    while (next()) {
      if (files::trimmed(lines_.line()) == "META_STOP") {
        metadata_.common.check(lines_);
        times_.emplace(lines_, metadata_);
        Track track{metadata_.common.object, metadata_.common.object_id, metadata_.common.frame.value().frame};
        track.published_rule = metadata_.rule(lines_);
        return track;
      }
      const auto keyword = keyword_in(lines_.line());
      if (!keyword) lines_.refuse("a keyword of the metadata or META_STOP");
      metadata_.take(lines_, *keyword);  // the others say nothing of the states
    }
    lines_.refuse("the end of the file", "META_STOP");
  }

  void skip_covariance() {
    while (next())
      if (files::trimmed(lines_.line()) == "COVARIANCE_STOP") return;
    lines_.refuse("the end of the file", "COVARIANCE_STOP");
  }

  void add_state(Track& track) const {
    constexpr std::size_t kWords = 7, kWordsWithAcceleration = 10;
    const auto words = lines_.words();
    std::array<double, 6> values{};
    const bool has_count = words.size() == kWords || words.size() == kWordsWithAcceleration;
    for (std::size_t k = 0; k < values.size() && has_count; ++k) {
      const auto value = files::number_of(words[k + 1]);
      if (!value) lines_.refuse(files::quoted(words[k + 1]), "a number");
      values[k] = *value;
    }
    if (!has_count) lines_.refuse("a time, a position in km and a velocity in km/s");
    lines_.check_ended();
    const fsw::GpsTime time = metadata_.common.time(lines_, words[0]);
    if (!track.states.empty() && time <= track.states.back().time)
      lines_.refuse(fmt::format("{} at or before the state before it", words[0]), "times in ascending order");
    times_->check(lines_, time);
    track.states.push_back(
        {time, metadata_.common.state(lines_, {values[0], values[1], values[2]}, {values[3], values[4], values[5]})});
  }

  /// The last segment, when all its states are there.
  void close(std::vector<Track>& tracks) const {
    if (tracks.empty()) return;
    Track& track = tracks.back();
    if (track.states.empty()) lines_.refuse("a segment without a state", "states behind META_STOP");
    if (times_->useable_start || times_->useable_stop)
      track.useable = UseableTime{times_->useable_start.value_or(track.states.front().time),
                                  times_->useable_stop.value_or(track.states.back().time)};
  }

  TextLines lines_;
  SegmentMetadata metadata_;
  std::optional<SegmentTimes> times_;
};

}  // namespace

bool is_oem(std::string_view text) {
  return begins_with(text, "CCSDS_OEM_VERS");
}

std::vector<Track> read_oem(std::string_view text, const std::string& file) {
  return OemReader(text, file).read();
}

namespace {

struct Component {
  std::string_view name, unit;
};
constexpr std::array<Component, 6> kComponents{
    {{"X", "km"}, {"Y", "km"}, {"Z", "km"}, {"X_DOT", "km/s"}, {"Y_DOT", "km/s"}, {"Z_DOT", "km/s"}}};

struct StateVector {
  std::string_view epoch;
  std::array<std::optional<double>, kComponents.size()> components;

  void take(const TextLines& lines, const Keyword& keyword) {
    if (keyword.name == "CCSDS_OPM_VERS") check_version(lines, keyword);
    if (keyword.name == "EPOCH") {
      epoch = keyword.value;
      lines.check_ended();
    }
    for (std::size_t k = 0; k < kComponents.size(); ++k) {
      if (keyword.name != kComponents[k].name) continue;
      if (!keyword.unit.empty() && keyword.unit != kComponents[k].unit)
        lines.refuse(fmt::format("{} in {}", keyword.name, files::quoted(keyword.unit)), kComponents[k].unit);
      components[k] = files::number_of(keyword.value);
      if (!components[k]) lines.refuse(files::quoted(keyword.value), "a number");
      if (keyword.unit.empty()) lines.check_ended();
    }
  }

  void check(const TextLines& lines) const {
    if (epoch.empty()) lines.refuse("a message without EPOCH", "EPOCH of the state vector");
    for (std::size_t k = 0; k < kComponents.size(); ++k)
      if (!components[k])
        lines.refuse(fmt::format("a message without {}", kComponents[k].name), "X, Y, Z, X_DOT, Y_DOT and Z_DOT");
  }
};

}  // namespace

bool is_opm(std::string_view text) {
  return begins_with(text, "CCSDS_OPM_VERS");
}

std::vector<Track> read_opm(std::string_view text, const std::string& file) {
  TextLines lines(text, file);
  Metadata metadata;
  StateVector vector;
  while (lines.next()) {
    if (is_comment(lines)) continue;
    const auto keyword = keyword_in(lines.line());
    if (!keyword) lines.refuse("NAME = value");
    if (keyword->name.starts_with("MAN_"))
      lines.refuse(fmt::format("the maneuver's {}", keyword->name), "a state without maneuvers");
    if (!metadata.take(lines, *keyword)) vector.take(lines, *keyword);
  }
  metadata.check(lines);
  vector.check(lines);
  const auto at = [&](std::size_t k) { return vector.components[k].value(); };
  Track track{metadata.object, metadata.object_id, metadata.frame.value().frame};
  track.states.push_back(
      {metadata.time(lines, vector.epoch), metadata.state(lines, {at(0), at(1), at(2)}, {at(3), at(4), at(5)})});
  return {track};
}

}  // namespace vbar::orbit_files
