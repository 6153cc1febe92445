#pragma once
// Surfaces of the laboratory as triangles, in metres of the frame of the body that they belong to.

#include <array>
#include <cstdint>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/tron/bench/scene/lab_view.h"
#include "hil_drivers/tron/calibrate/board/board_design.h"
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

}  // namespace vbar::tron::bench
