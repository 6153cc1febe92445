#pragma once
// Keypoints of a target, chosen on its CAD model: vertices far from each other and seen from most directions.

#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::training {

struct ChosenKeypoint {
  fsw::Vector3 at_body = fsw::Vector3::Zero();  ///< m, from the origin of the body frame
  double seen_share = 0.0;  ///< share of all directions, evenly spread, from which the body does not hide it
};

/// Chooses keypoints by farthest-point sampling of the vertices (Eldar et al. 1997, "The farthest point strategy for
/// progressive image sampling"): the first is the farthest from the centre of mass, each other the farthest from those
/// chosen before. Vertices that are seen from less than a share of all directions are passed over. The share is the
/// highest of 0.85, 0.80 ... kMinSeenShare at which there are `count` vertices kMinSeparation apart, so that corners
/// and tips, which are seen from most directions and from which a network locates both coordinates, precede points on
/// edges and faces. Throws std::runtime_error, naming the model, if there is none.
[[nodiscard]] std::vector<ChosenKeypoint> choose_keypoints(const twins::camera::CadModel& model,
                                                           const fsw::Vector3& centre_of_mass_body, std::size_t count);

inline constexpr double kMaxSeenShare = 0.85, kMinSeenShare = 0.5;
/// Minimum separation in radii of the model: closer ones would merge in a heatmap.
inline constexpr double kMinSeparation = 0.2;

/// Returns the share of all directions from which the surface does not hide a point.
[[nodiscard]] double seen_share(const twins::camera::CadModel& model, const fsw::Vector3& point_body);

/// Returns whether the surface hides a point from an observer far away in a direction (unit vector, body axes).
[[nodiscard]] bool is_hidden(const twins::camera::CadModel& model, const fsw::Vector3& point_body,
                             const fsw::Vector3& direction_body);

/// Draws an SVG: the model from six directions, its keypoints numbered, those hidden in a view drawn hollow.
[[nodiscard]] std::string keypoint_picture(const twins::camera::CadModel& model,
                                           const std::vector<fsw::Vector3>& keypoints_body);

}  // namespace vbar::training
