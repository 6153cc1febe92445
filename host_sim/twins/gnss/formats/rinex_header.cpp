#include "host_sim/twins/gnss/formats/rinex_header.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::twins::gnss {
namespace {

using files::TextLines;

std::string_view label_of(const TextLines& lines) {
  return files::trimmed(lines.columns(61, 80));
}

int version_of(const TextLines& lines) {
  if (label_of(lines) != "RINEX VERSION / TYPE") lines.refuse("RINEX VERSION / TYPE in columns 61 to 80");
  const double version = lines.number_in(1, 9, "the version of RINEX");
  if (!(version >= 2.0 && version < 5.0)) lines.refuse(fmt::format("RINEX version {}", version), "2, 3 or 4");
  return static_cast<int>(version);
}

void check_type(const TextLines& lines, int version) {
  const std::string_view type = lines.columns(21, 21), system = lines.columns(41, 41);
  constexpr std::string_view kAccepted = "navigation data (N) of GPS, Galileo, BeiDou or mixed systems";
  // Version 2 has a type for each system: N is GPS, G is GLONASS, H are geostationary ones.
  if (type != "N") lines.refuse(fmt::format("a file of type {}", files::quoted(lines.columns(21, 40))), kAccepted);
  // A simulator of signals writes version 3.00 without a system; the records name theirs.
  constexpr std::string_view kSystems = "GECM";
  if (version > 2 && !files::trimmed(system).empty() && kSystems.find(system) == std::string_view::npos)
    lines.refuse(fmt::format("the satellite system {}", files::quoted(files::trimmed(lines.columns(41, 60)))),
                 kAccepted);
}

/// Four coefficients from column `first` on.
void read_four(const TextLines& lines, std::size_t first, std::array<double, 4>& to) {
  constexpr std::size_t kWidth = 12;
  for (std::size_t k = 0; k < to.size(); ++k)
    to[k] = lines.number_in(first + kWidth * k, first + kWidth * k + kWidth - 1, "a coefficient of the ionosphere");
}

void take(const TextLines& lines, BroadcastCorrections& corrections) {
  const std::string_view label = label_of(lines), kind = lines.columns(1, 4);
  if (label == "ION ALPHA") read_four(lines, 3, corrections.klobuchar.alpha);
  if (label == "ION BETA") read_four(lines, 3, corrections.klobuchar.beta);
  if (label == "IONOSPHERIC CORR" && kind == "GPSA") read_four(lines, 6, corrections.klobuchar.alpha);
  if (label == "IONOSPHERIC CORR" && kind == "GPSB") read_four(lines, 6, corrections.klobuchar.beta);
  if (label == "DELTA-UTC: A0,A1,T,W") {
    corrections.utc_a0_s = lines.number_in(4, 22, "A0 of UTC");
    corrections.utc_a1 = lines.number_in(23, 41, "A1 of UTC");
  }
  if (label == "TIME SYSTEM CORR" && kind == "GPUT") {
    corrections.utc_a0_s = lines.number_in(6, 22, "A0 of UTC");
    corrections.utc_a1 = lines.number_in(23, 38, "A1 of UTC");
  }
}

}  // namespace

RinexHeader read_rinex_header(TextLines& lines) {
  RinexHeader header;
  if (!lines.next()) lines.refuse("an empty file", "a RINEX navigation file");
  header.version = version_of(lines);
  check_type(lines, header.version);
  while (lines.next()) {
    if (label_of(lines) == "END OF HEADER") return header;
    take(lines, header.corrections);
  }
  lines.refuse("the end of the file", "END OF HEADER");
}

}  // namespace vbar::twins::gnss
