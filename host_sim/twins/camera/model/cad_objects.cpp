#include "host_sim/twins/camera/model/cad_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::twins::camera {

namespace {

using fsw::Vector2;
using fsw::Vector3;

constexpr int kPoints = 2;  // a pixel, either way

double cross(const Vector2& a, const Vector2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

Silhouette::Silhouette(const CadModel& model) {
  for (const Triangle& triangle : model.triangles)
    corners_body_.insert(corners_body_.end(), triangle.corners.begin(), triangle.corners.end());
}

/// Corners in points of the grid. Row by row, between where the sides cross the row.
void Silhouette::fill(const std::array<Vector2, 3>& corners) {
  const double top = std::min({corners[0].y(), corners[1].y(), corners[2].y()});
  const double bottom = std::max({corners[0].y(), corners[1].y(), corners[2].y()});
  const int first_row = static_cast<int>(std::ceil(std::max(top, 0.0)));
  const int last_row = static_cast<int>(std::floor(std::min(bottom, points_down_ - 1.0)));
  for (int row = first_row; row <= last_row; ++row) {
    double left = 1e30, right = -1e30;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2& a = corners[k];
      const Vector2& b = corners[(k + 1) % 3];
      if ((row < a.y() && row < b.y()) || (row > a.y() && row > b.y())) continue;
      if (a.y() == b.y()) {
        left = std::min({left, a.x(), b.x()});
        right = std::max({right, a.x(), b.x()});
        continue;
      }
      const double x = a.x() + (b.x() - a.x()) * (row - a.y()) / (b.y() - a.y());
      left = std::min(left, x);
      right = std::max(right, x);
    }
    const int first = static_cast<int>(std::ceil(std::max(left, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(right, points_across_ - 1.0)));
    if (first > last) continue;
    const auto begin = points_.begin() + static_cast<std::ptrdiff_t>(row) * points_across_;
    std::fill(begin + first, begin + last + 1, static_cast<unsigned char>(1));
  }
}

void Silhouette::draw(const Projection& optics, const Vector3& origin_camera, const fsw::Matrix3& R_camera_body,
                      const Region& region, std::vector<float>& covered) {
  points_across_ = kPoints * region.width;
  points_down_ = kPoints * region.height;
  points_.assign(static_cast<std::size_t>(points_across_) * static_cast<std::size_t>(points_down_), 0);
  const Vector2 corner(region.x - 0.5, region.y - 0.5);
  const Vector2 half(0.5, 0.5);
  std::array<Vector2, 3> corners;
  for (std::size_t i = 0; i + 2 < corners_body_.size(); i += 3) {
    bool is_seen = true;
    for (std::size_t k = 0; k < 3 && is_seen; ++k) {
      const auto pixel = optics.project(origin_camera + R_camera_body * corners_body_[i + k]);
      is_seen = pixel.has_value();
      if (is_seen) corners[k] = kPoints * (*pixel - corner) - half;
    }
    if (is_seen && cross(corners[1] - corners[0], corners[2] - corners[0]) != 0.0) fill(corners);
  }
  covered.resize(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) {
      const unsigned char* const point =
          &points_[static_cast<std::size_t>(kPoints * y) * static_cast<std::size_t>(points_across_) +
                   static_cast<std::size_t>(kPoints * x)];
      const int sum = point[0] + point[1] + point[points_across_] + point[points_across_ + 1];
      covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(region.width) + static_cast<std::size_t>(x)] =
          0.25F * static_cast<float>(sum);
    }
}

namespace {

struct Models {
  std::map<std::string, TargetRenderer, std::less<>> renderers;
  std::vector<LightSample> samples;  // work space
};

template <class Map>
auto loaded_model(Map& models, const std::string& name) {
  const auto found = models.find(name);
  if (found == models.end())
    throw std::invalid_argument(fmt::format("no CAD model \"{}\" was loaded for the camera", name));
  return found;
}

void render(Models& models, const ObjectView& view, std::vector<LightSample>& out) {
  const auto found = loaded_model(models.renderers, view.model);
  TargetView target;
  target.position_camera = view.position_camera;
  target.R_camera_body = view.R_camera_body;
  target.sun_camera = view.sun_direction_camera;
  target.sun_photons_per_m2_s = view.sun_photons_per_m2_s;
  target.nadir_camera = view.earth_direction_camera;
  target.earth_photons_per_m2_s = view.earth_photons_per_m2_s;
  target.earth_half_angle = view.earth_half_angle;
  target.texel_pitch = 0.5 * view.pixel_rad;
  found->second.render(target, models.samples);
  out.insert(out.end(), models.samples.begin(), models.samples.end());
}

}  // namespace

ObjectRenderer cad_objects(const CadSources& models) {
  const auto loaded = std::make_shared<Models>();
  for (const auto& [name, source] : models) loaded->renderers.try_emplace(name, load_cad_model(source));
  return [loaded](const ObjectView& view, std::vector<LightSample>& out) { render(*loaded, view, out); };
}

ObjectCover cad_covers(const CadSources& models) {
  using Silhouettes = std::map<std::string, Silhouette, std::less<>>;
  const auto loaded = std::make_shared<Silhouettes>();
  for (const auto& [name, source] : models) loaded->try_emplace(name, load_cad_model(source));
  return [loaded](const ObjectView& view, const Projection& optics, const Region& region, std::vector<float>& covered) {
    loaded_model(*loaded, view.model)->second.draw(optics, view.position_camera, view.R_camera_body, region, covered);
  };
}

}  // namespace vbar::twins::camera
