#pragma once
// Surfaces of the laboratory as triangles, in metres of the frame of the body that they belong to.

#include <array>
#include <cstdint>
#include <vector>

#include "emulators/tron/scene/lab_view.h"
#include "emulators/tron/scene/radiometry.h"
#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::tron::bench {

struct Facet {
  std::array<fsw::Vector3, 3> corners;
  std::array<fsw::Vector3, 3> normals;            ///< normals of the smooth surface; zero: flat
  std::array<double, 3> albedo_factors{1, 1, 1};  ///< factors of the Lambert part at the corners
  std::size_t material = 0;
};

inline constexpr double kCornerErrorM = 0.5e-3;  ///< root mean square of the mock-up's corners
inline constexpr double kAlbedoNoise = 0.10;     ///< root mean square
inline constexpr double kAlbedoGrainM = 0.02;

/// Returns a number uniform on [0, 1), the same on every computer.
[[nodiscard]] double hashed(std::int64_t i, std::int64_t j, std::int64_t k, std::uint64_t seed);

/// Returns noise of zero mean, unit variance on average over places, varying over `grain_m`: trilinear between hashed
/// numbers on a grid.
[[nodiscard]] double smooth_noise(const fsw::Vector3& place_m, double grain_m, std::uint64_t seed);

/// Returns the model at `scale`.
[[nodiscard]] std::vector<Facet> scaled_facets(const twins::camera::CadModel& model, double scale);

/// Moves corners by kCornerErrorM; those near each other move together, so that no gap opens.
void move_corners(std::vector<Facet>& facets, std::uint64_t seed);

void add_albedo_noise(std::vector<Facet>& facets, std::uint64_t seed);

/// Returns facets with every edge no longer than `longest_m`. An edge is divided by its length alone, so neighbours
/// stay neighbours.
[[nodiscard]] std::vector<Facet> subdivided(const std::vector<Facet>& facets, double longest_m);

/// Adds the facets of a limb in the frame of its ends.
void add_limb(const Limb& limb, std::size_t material, std::vector<Facet>& facets);

/// Returns the board in B: squares, the plate a little behind them, its back.
[[nodiscard]] std::vector<Facet> board_facets(const calibrate::BoardDesign& design, std::size_t white,
                                              std::size_t black, double longest_m);

/// Widths of the attributes: corner; normal; flat normal and material; factor of the albedo. `origin` becomes zero.
inline constexpr std::array<int, 4> kFacetWidths{3, 3, 4, 1};
[[nodiscard]] std::vector<float> interleaved(const std::vector<Facet>& facets, const fsw::Vector3& origin);

// Bodies that hold the target, and those of the camera's own arm in its view.

/// Returns the arms' limbs, the rod between flange and target (or board) and the pedestal, without those that surround
/// the camera, such as its own housing.
[[nodiscard]] std::vector<Limb> limbs_in_view(const TestbedDesign& bench, const LabView& view);

// Room: walls of low albedo lit by lamp and boxes, the boxes themselves, and the part of that light that comes back to
// the target.

inline constexpr double kWallAlbedo = 0.04;
/// Irradiance from all sides by what is not drawn (housing of the lamp, tripods, cables), to that of the lamp. Assumed.
inline constexpr double kScatteredByEquipment = 0.01;

class Room {
 public:
  explicit Room(const TestbedDesign& bench);

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
