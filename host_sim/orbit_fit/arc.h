#pragma once
// Measured positions of one spacecraft, in GCRF.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/truth/earth/earth_orientation.h"

namespace vbar::orbit_fit {

struct Arc {
  std::string object;
  fsw::GpsTime epoch;                       ///< of the first position
  std::vector<double> seconds;              ///< after the epoch, ascending from 0
  std::vector<fsw::Vector3> positions_eci;  ///< m
  fsw::orbit::CartesianState first;         ///< state at the epoch, by the file's velocity or by interpolation

  [[nodiscard]] double length_s() const { return seconds.back(); }
};

/// Times that an arc holds; what is not given is the file's own begin and end.
struct ArcSpan {
  std::optional<fsw::GpsTime> from, to;
};

inline constexpr std::size_t kMinPositions = 10;
inline constexpr double kMinArc_s = 600.0;

/// Returns the times of the first and the last position that the span permits, without their conversion. `file`: of one
/// object. Throws std::runtime_error that names the file for a span with fewer than kMinPositions, or shorter than
/// kMinArc_s.
[[nodiscard]] ArcSpan span_of(const orbit_files::OrbitFile& file, const ArcSpan& wanted);

/// Returns the positions of a span that span_of() returned. Throws as orbit_files::state_at() where there is no
/// velocity and none can be interpolated.
[[nodiscard]] Arc arc_of(const orbit_files::OrbitFile& file, const ArcSpan& span,
                         std::shared_ptr<const truth::EarthOrientationSeries> orientation);

/// Returns the positions until `seconds`, at least one of them.
[[nodiscard]] Arc until(const Arc& arc, double seconds);

}  // namespace vbar::orbit_fit
