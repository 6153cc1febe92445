#pragma once
// Values of a source of light for powers of light, from levels at which its light was measured. Between two
// levels light is a power of the level, light = a level^g, as it is below the lowest: a source that follows one power
// law is met exactly by any two levels.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Irradiance by an even Lambert surface in the shape of a polygon.

/// Returns the irradiance of an area at `point` that faces `normal` (unit), relative to the radiant exitance of the
/// polygon: the contour integral of Lambert over the part above the area's horizon (Baum, Rushmeier, Winget 1989,
/// "Improving radiosity solutions through the use of analytically determined form-factors"). `corners`: a convex
/// polygon in a plane, anticlockwise as seen from its bright side; its other side gives 0. A point in its plane gives
/// 0.
[[nodiscard]] double form_factor(const fsw::Vector3& point, const fsw::Vector3& normal,
                                 std::span<const fsw::Vector3> corners);

inline constexpr std::size_t kLightSources = 1 + kBoxes;
/// Returns the name of a source as in LightTable: "lamp", "box 1" to "box 10".
[[nodiscard]] std::string light_source_name(std::size_t source);

class LightResponse {
 public:
  /// Makes light proportional to the level.
  LightResponse() = default;
  /// Takes levels of the value (share of 65535) and the light there, relative to full power as designed. Levels of zero
  /// are left out. Throws std::invalid_argument, which names the source, unless at least two levels and their light
  /// rise strictly and are in (0, 1] and positive.
  explicit LightResponse(const LightTable& table);

  [[nodiscard]] double light(double level) const;
  /// Returns the level for a light; at most 1.
  [[nodiscard]] double level(double light) const;
  /// Returns the largest power that the source can give.
  [[nodiscard]] double full_light() const { return light(1.0); }

 private:
  std::vector<double> log_level_{-1.0, 0.0}, log_light_{-1.0, 0.0};
};

/// Converts between light and level of lamp and boxes. By default light is proportional to the level.
class PhotometricTable {
 public:
  PhotometricTable() = default;
  /// Throws std::invalid_argument if a source is missing, unknown or given twice.
  explicit PhotometricTable(const std::vector<LightTable>& tables);

  [[nodiscard]] const LightResponse& lamp() const { return responses_[0]; }
  [[nodiscard]] const LightResponse& box(std::size_t box) const { return responses_.at(1 + box); }

 private:
  std::array<LightResponse, kLightSources> responses_;
};

}  // namespace vbar::tron
