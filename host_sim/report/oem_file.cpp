#include "host_sim/report/oem_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/truth/earth/time_scales.h"

namespace vbar::report {
namespace {

/// A Hermite polynomial of degree 2n - 1 goes through n states with their velocities.
constexpr std::size_t kMostStates = 4;

std::string epoch_text(fsw::GpsTime time, int decimals) {
  std::string text = truth::format_utc(time, decimals);
  text.pop_back();  // the "Z": TIME_SYSTEM says it
  return text;
}

}  // namespace

OemFile::OemFile(const std::filesystem::path& file, const std::string& object, const Span& span) : file_(file) {
  std::string head = fmt::format(
      "CCSDS_OEM_VERS = 2.0\n"
      "CREATION_DATE = {}\n"
      "ORIGINATOR = VBAR\n"
      "\n"
      "META_START\n"
      "OBJECT_NAME = {}\n"
      "OBJECT_ID = {}\n"
      "CENTER_NAME = EARTH\n"
      "REF_FRAME = GCRF\n"
      "TIME_SYSTEM = UTC\n"
      "START_TIME = {}\n"
      "STOP_TIME = {}\n",
      epoch_text(span.created, 0), object, object, epoch_text(span.start, 9), epoch_text(span.stop, 9));
  if (span.states > 1) {
    head +=
        fmt::format("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = {}\n", 2 * std::min(span.states, kMostStates) - 1);
  }
  file_.append(head + "META_STOP\n\n");
}

void OemFile::append(const EphemerisRow& row) {
  const fsw::Vector3 r = 1e-3 * row.state.position_eci, v = 1e-3 * row.state.velocity_eci;
  file_.append(fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", epoch_text(row.time, 9), r.x(), r.y(),
                           r.z(), v.x(), v.y(), v.z()));
}

}  // namespace vbar::report
