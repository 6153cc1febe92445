#include <array>

#include <fmt/format.h>

#include "host_sim/orbit_files/kvn.h"

namespace vbar::orbit_files {
namespace {

using files::TextLines;

/// Goes through a message segment by segment.
class OemReader {
 public:
  OemReader(std::string_view text, const std::string& file) : lines_(text, file) {}

  std::vector<Track> read() {
    std::vector<Track> tracks;
    while (next()) {
      const std::string_view line = files::trimmed(lines_.line());
      if (line == "META_START") {
        close(tracks);
        metadata_ = read_metadata();
        tracks.push_back({metadata_.object, metadata_.object_id});
      } else if (line == "COVARIANCE_START") {
        skip_covariance();
      } else if (!tracks.empty()) {
        add_state(tracks.back());
      } else if (!keyword_in(line)) {
        lines_.refuse("a keyword of the header or META_START");
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

  Metadata read_metadata() {
    Metadata metadata;
    while (next()) {
      if (files::trimmed(lines_.line()) == "META_STOP") {
        metadata.check(lines_);
        return metadata;
      }
      const auto keyword = keyword_in(lines_.line());
      if (!keyword) lines_.refuse("a keyword of the metadata or META_STOP");
      metadata.take(lines_, *keyword);  // the others say nothing of the states
    }
    lines_.refuse("the end of the file", "META_STOP");
  }

  void skip_covariance() {
    while (next())
      if (files::trimmed(lines_.line()) == "COVARIANCE_STOP") return;
    lines_.refuse("the end of the file", "COVARIANCE_STOP");
  }

  void add_state(Track& track) {
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
    const fsw::GpsTime time = metadata_.time(lines_, words[0]);
    if (!track.states.empty() && time <= track.states.back().time)
      lines_.refuse(fmt::format("{} at or before the state before it", words[0]), "times in ascending order");
    track.states.push_back(
        {time, metadata_.state(lines_, {values[0], values[1], values[2]}, {values[3], values[4], values[5]})});
  }

  void close(const std::vector<Track>& tracks) const {
    if (!tracks.empty() && tracks.back().states.empty())
      lines_.refuse("a segment without a state", "states behind META_STOP");
  }

  TextLines lines_;
  Metadata metadata_;
};

}  // namespace

bool is_oem(std::string_view text) {
  return begins_with(text, "CCSDS_OEM_VERS");
}

std::vector<Track> read_oem(std::string_view text, const std::string& file) {
  return OemReader(text, file).read();
}

}  // namespace vbar::orbit_files
