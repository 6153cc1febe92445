#include "host_sim/twins/camera/model/face_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host_sim/engine/wide_loops.h"

namespace vbar::twins::camera {

namespace {

using fsw::Vector3;
using glsl::vec3;

constexpr float kMinFacing = 1e-3F;      // a face turned farther away is seen edge-on
constexpr float kRounding = 2e-5F;       // of depths
constexpr float kSameSurface = 0.02F;    // depth between faces that continue each other
constexpr std::int32_t kManyTexels = 4;  // that say whether a whole face is visible
constexpr float kFarthest = 4.0F;        // depth behind every body

}  // namespace

vec3 single(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::vector<Face> faces_of(const CadModel& model) {
  std::vector<Face> faces;
  faces.reserve(model.triangles.size());
  for (const Triangle& t : model.triangles) {
    Face& face = faces.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      face.corners[k] = single((t.corners[k] - model.centre) / model.radius_m);
      face.normals[k] = single(t.normals[k]);
    }
    face.flat_normal = single((t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]).normalized());
    face.material = static_cast<std::uint32_t>(t.material);
  }
  return faces;
}

FaceMap::FaceMap(int size)
    : size_(size),
      depths_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)),
      nearest_(depths_.size(), kNone) {}

FaceMap::Place FaceMap::place_of(vec3 point) const {
  const float away = dot(viewer_.R_viewer_body[2], point);
  const float inverse = 1.0F / (1.0F + viewer_.reach * away);
  const float scale = 0.5F * static_cast<float>(size_) * inverse / viewer_.half_width;
  return {scale * dot(viewer_.R_viewer_body[0], point), scale * dot(viewer_.R_viewer_body[1], point), away * inverse};
}

/// Texels of each row whose middles lie in a triangle. Neighbours share the sides' crossings to the bit, so that there
/// are no gaps.
VBAR_WIDE_LOOPS void FaceMap::fill(std::int32_t face, const std::array<Place, 3>& corners) {
  const Place *top = &corners[0], *middle = &corners[1], *bottom = &corners[2];
  if (middle->y < top->y) std::swap(top, middle);
  if (bottom->y < middle->y) std::swap(middle, bottom);
  if (middle->y < top->y) std::swap(top, middle);
  const int half = size_ / 2;
  const auto first_after = [half](float at) { return static_cast<int>(std::ceil(at - 0.5F)) + half; };
  const int first_row = std::max(first_after(top->y), 0), end_row = std::min(first_after(bottom->y), size_);
  if (first_row >= end_row) return;
  const float near = std::min({top->depth, middle->depth, bottom->depth});
  const float far = std::max({top->depth, middle->depth, bottom->depth});
  const Plane plane = planes_[static_cast<std::size_t>(face)];
  const auto cross = [](const Place& from, const Place& to, float y) {
    return from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x);
  };
  for (int row = first_row; row < end_row; ++row) {
    const float y = static_cast<float>(row - half) + 0.5F;
    float left = cross(*top, *bottom, y);
    float right = y < middle->y ? cross(*top, *middle, y) : cross(*middle, *bottom, y);
    if (right < left) std::swap(left, right);
    const int first = std::max(first_after(left), 0), end = std::min(first_after(right), size_);
    if (first >= end) continue;
    covered_[static_cast<std::size_t>(face)] += end - first;
    const std::size_t at =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(first);
    float* const depths = &depths_[at];
    std::int32_t* const nearest = &nearest_[at];
    const float start = plane.at_middle + plane.along_y * y + plane.along_x * (static_cast<float>(first - half) + 0.5F);
    for (int k = 0; k < end - first; ++k) {
      const float here = glsl::clamp(start + static_cast<float>(k) * plane.along_x, near, far);
      const bool is_nearer = here < depths[k];
      depths[k] = is_nearer ? here : depths[k];
      nearest[k] = is_nearer ? face : nearest[k];
    }
  }
}

void FaceMap::draw(std::span<const Face> faces, const Viewer& viewer) {
  viewer_ = viewer;
  planes_.resize(faces.size());
  covered_.assign(faces.size(), 0);
  std::fill(depths_.begin(), depths_.end(), kFarthest);
  std::fill(nearest_.begin(), nearest_.end(), kNone);
  const float pitch = 2.0F * viewer.half_width / static_cast<float>(size_);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    // With the normal n, n.p = s in the viewer's axes; x and y over 1 + reach z, and depth, are linear in one another.
    const Face& face = faces[i];
    const float s = dot(face.flat_normal, face.corners[0]);
    const float facing = dot(viewer.R_viewer_body[2], face.flat_normal) + viewer.reach * s;
    const float divisor = std::copysign(std::max(std::abs(facing), kMinFacing), facing);
    planes_[i] = {s / divisor, -pitch * dot(viewer.R_viewer_body[0], face.flat_normal) / divisor,
                  -pitch * dot(viewer.R_viewer_body[1], face.flat_normal) / divisor};
    fill(static_cast<std::int32_t>(i),
         {place_of(face.corners[0]), place_of(face.corners[1]), place_of(face.corners[2])});
  }
  count_visible();
}

void FaceMap::count_visible() {
  won_.assign(planes_.size(), 0);
  for (const std::int32_t face : nearest_)
    if (face != kNone) ++won_[static_cast<std::size_t>(face)];
  extents_.resize(planes_.size());
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const bool is_known = covered_[i] >= kManyTexels;
    extents_[i] = is_known && won_[i] == 0             ? Extent::kNone
                  : is_known && won_[i] == covered_[i] ? Extent::kAll
                                                       : Extent::kSome;
  }
}

float FaceMap::visible(std::size_t face, vec3 of_body) const {
  const Place point = place_of(of_body);
  // A texel's face hides the point if it is in front both where the texel is and, continued, where the point is: faces
  // that meet, at an edge or in a corner, are not in front of each other in both places. A face far behind says
  // nothing: without that, the hidden side of a part would be seen past its outline.
  const Plane own = planes_[face];
  const float x = point.x - 0.5F, y = point.y - 0.5F;
  const float left = std::floor(x), low = std::floor(y);
  const float part_x = x - left, part_y = y - low;
  const int half = size_ / 2;
  const int column = static_cast<int>(left) + half, row = static_cast<int>(low) + half;
  if (row < 0 || row + 1 >= size_ || column < 0 || column + 1 >= size_) return 1.0F;
  const std::int32_t* const lower =
      &nearest_[static_cast<std::size_t>(row) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(column)];
  const std::int32_t* const upper = lower + size_;
  const auto self = static_cast<std::int32_t>(face);
  if (lower[0] == self && lower[1] == self && upper[0] == self && upper[1] == self) return 1.0F;
  float hidden = 0.0F, seen = 0.0F;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const std::int32_t there = j == 0 ? lower[i] : upper[i];
      if (there == kNone) continue;
      const float weight = (i == 0 ? 1.0F - part_x : part_x) * (j == 0 ? 1.0F - part_y : part_y);
      if (there == self) {
        seen += weight;
        continue;
      }
      const Plane& plane = planes_[static_cast<std::size_t>(there)];
      const float here = plane.at_middle + plane.along_x * point.x + plane.along_y * point.y - point.depth;
      const float dx = static_cast<float>(i) - part_x, dy = static_cast<float>(j) - part_y;
      const float at_texel = here + (plane.along_x - own.along_x) * dx + (plane.along_y - own.along_y) * dy;
      if (here < -kRounding && at_texel < -kRounding)
        hidden += weight;
      else if (here < kSameSurface)
        seen += weight;
    }
  return hidden > 0.0F ? seen / (hidden + seen) : 1.0F;
}

}  // namespace vbar::twins::camera
