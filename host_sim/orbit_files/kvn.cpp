#include "host_sim/orbit_files/kvn.h"

#include <algorithm>
#include <array>

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

}  // namespace vbar::orbit_files
