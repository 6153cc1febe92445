#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "host_sim/orbit_files/kvn.h"

namespace vbar::orbit_files {
namespace {

using files::TextLines;

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

}  // namespace vbar::orbit_files
