#pragma once
// Room: walls of low albedo lit by lamp and boxes, the boxes themselves, and the part of that light that comes back to
// the target.

#include <array>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/tron/bench/scene/light.h"
#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

inline constexpr double kWallAlbedo = 0.04;
/// Irradiance from all sides by what is not drawn (housing of the lamp, tripods, cables), to that of the lamp. Assumed.
inline constexpr double kScatteredByEquipment = 0.01;

class Room {
 public:
  explicit Room(const BenchFile& bench);

  /// Widths of the attributes: corner; normal; albedo, irradiance by the boxes, emitted radiance. Relative to `origin`.
  static constexpr std::array<int, 3> kWidths{3, 3, 3};
  [[nodiscard]] std::vector<float> corners(const std::array<BoxLight, kBoxes>& boxes, const fsw::Vector3& origin,
                                           double unit) const;

  /// Returns the irradiance by reflected light at a place of areas that face +x, -x, +y, -y, +z, -z.
  [[nodiscard]] std::array<double, 6> reflected(const LampBeam& beam, const std::array<BoxLight, kBoxes>& boxes,
                                                const fsw::Vector3& place_m) const;

 private:
  struct Cell {
    std::array<fsw::Vector3, 4> corners;
    fsw::Vector3 normal;
    std::array<std::array<double, kBoxes>, 4> per_radiance;  ///< irradiance of the corners by boxes of unit radiance
    double area_m2;
  };
  void add_wall(const fsw::Vector3& corner, const fsw::Vector3& u, const fsw::Vector3& v,
                const std::array<BoxLight, kBoxes>& unit_boxes);

  std::vector<Cell> cells_;
};

}  // namespace vbar::tron::bench
