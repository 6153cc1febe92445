#include <array>
#include <utility>

#include <fmt/format.h>

#include "host_sim/orbit_files/kvn.h"

namespace vbar::orbit_files {
namespace {

using files::TextLines;

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
