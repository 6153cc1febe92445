#include "host_sim/orbit_files/orbit_file.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/orbit_files/interpolation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_files {
namespace {

bool is_named(const Track& track, std::string_view object) {
  return track.object == object || track.object_id == object;
}

std::string text_of(fsw::GpsTime time) {
  return truth::format_utc(time, 3);
}

}  // namespace

std::span<const OrbitFormat> orbit_formats() {
  static constexpr std::array kFormats{
      OrbitFormat{"CCSDS OEM (KVN)", is_oem, read_oem},
      OrbitFormat{"CCSDS OPM (KVN)", is_opm, read_opm},
      OrbitFormat{"SP3", is_sp3, read_sp3},
  };
  return kFormats;
}

OrbitFile read_orbits(std::string_view text, const std::string& file) {
  const auto formats = orbit_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return {file, std::string(format->name), format->read(text, file)};
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const OrbitFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("an orbit in one of the formats {}", fmt::join(names, ", ")));
}

OrbitFile load_orbits(const std::filesystem::path& file) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the orbit file", file.string()));
  return read_orbits(stream.view(), file.string());
}

OrbitFile tracks_of(const OrbitFile& file, std::string_view object) {
  OrbitFile one{file.file, file.format, {}};
  std::vector<std::string> names;
  for (const Track& track : file.tracks) {
    if (object.empty() || is_named(track, object)) one.tracks.push_back(track);
    if (std::ranges::find(names, track.object) == names.end()) names.push_back(track.object);
  }
  if (one.tracks.empty())
    throw std::runtime_error(
        fmt::format("{}: has no object {}; it has {}", file.file, files::quoted(object), fmt::join(names, ", ")));
  if (object.empty() && names.size() > 1)
    throw std::runtime_error(
        fmt::format("{}: has {} objects: {}; one must be named", file.file, names.size(), fmt::join(names, ", ")));
  return one;
}

FramedState state_at(const OrbitFile& file, fsw::GpsTime time) {
  const Track* not_useable = nullptr;
  for (const Track& track : file.tracks) {
    if (time < track.states.front().time || time > track.states.back().time) continue;
    if (!track.useable || (track.useable->from <= time && time <= track.useable->to))
      return interpolated(track, time, file.file);
    not_useable = &track;
  }
  if (not_useable != nullptr)
    throw std::out_of_range(fmt::format(
        "{}: no state of {} at {}: its file permits their use from {} to {} (USEABLE_START_TIME, USEABLE_STOP_TIME)",
        file.file, not_useable->object, text_of(time), text_of(not_useable->useable->from),
        text_of(not_useable->useable->to)));
  const Track& first = file.tracks.front();
  const Track& last = file.tracks.back();
  throw std::out_of_range(fmt::format("{}: no state of {} at {}; its states reach from {} to {}", file.file,
                                      first.object, text_of(time), text_of(first.states.front().time),
                                      text_of(last.states.back().time)));
}

}  // namespace vbar::orbit_files
