// SVG of a target with its keypoints, for review.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/training/keypoint_choice.h"

namespace vbar::training {
namespace {

using fsw::Vector3;
using twins::camera::CadModel;

constexpr double kSide = 340.0;  // side of a view, px
constexpr int kColumns = 3;

struct View {
  std::string_view name;
  Vector3 from;  ///< towards the observer, body axes
};

/// Across and up in the plane of a view, z of the body upwards where possible.
struct Axes {
  explicit Axes(const Vector3& from) {
    const Vector3 towards = from.normalized();
    const Vector3 vertical = std::abs(towards.z()) > 0.99 ? Vector3::UnitY() : Vector3::UnitZ();
    across = vertical.cross(towards).normalized();
    up = towards.cross(across);
    depth = towards;
  }
  Vector3 across, up, depth;
};

std::string view_of(const CadModel& model, const std::vector<Vector3>& keypoints, const View& view, double left,
                    double top) {
  const Axes axes(view.from);
  const double scale = 0.44 * kSide / model.radius_m;
  const auto x = [&](const Vector3& p) { return left + 0.5 * kSide + scale * (p - model.centre).dot(axes.across); };
  const auto y = [&](const Vector3& p) { return top + 0.5 * kSide - scale * (p - model.centre).dot(axes.up); };

  std::vector<std::size_t> order(model.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto depth = [&](std::size_t k) {
    const auto& corners = model.triangles[k].corners;
    return (corners[0] + corners[1] + corners[2]).dot(axes.depth);
  };
  std::ranges::sort(order, {}, depth);
  std::string svg = fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">from {}</text>\n", left + 8.0, top + 18.0, view.name);
  for (const std::size_t k : order) {
    const auto& c = model.triangles[k].corners;
    const Vector3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    const double cosine = normal.dot(axes.depth);
    if (cosine <= 0.0) continue;
    const double albedo = 0.35 + 0.65 * std::sqrt(model.materials[model.triangles[k].material].grey_diffuse());
    const int grey = static_cast<int>(255.0 * albedo * (0.35 + 0.6 * cosine));
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" fill=\"#{:02x}{:02x}{:02x}\"/>\n",
                       x(c[0]), y(c[0]), x(c[1]), y(c[1]), x(c[2]), y(c[2]), grey, grey, grey);
  }
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    const bool hidden = is_hidden(model, keypoints[k], axes.depth);
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"4\" class=\"{2}\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "class=\"number\">{5}</text>\n",
        x(keypoints[k]), y(keypoints[k]), hidden ? "hidden" : "seen", x(keypoints[k]) + 6.0, y(keypoints[k]) - 5.0, k);
  }
  return svg;
}

}  // namespace

std::string keypoint_picture(const CadModel& model, const std::vector<Vector3>& keypoints_body) {
  const std::array<View, 6> views{{{"+x +y +z", {1.0, 1.0, 0.8}},
                                   {"-x +y -z", {-1.0, 1.0, -0.8}},
                                   {"-x -y +z", {-1.0, -1.0, 0.8}},
                                   {"+x", {1.0, 0.0, 0.0}},
                                   {"+y", {0.0, 1.0, 0.0}},
                                   {"+z", {0.0, 0.0, 1.0}}}};
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n"
      "<style>.seen{{fill:#d02020}}.hidden{{fill:none;stroke:#d02020}}.number{{fill:#d02020;font-weight:bold}}</"
      "style>\n"
      "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
      kColumns * kSide, 2.0 * kSide);
  for (std::size_t k = 0; k < views.size(); ++k)
    svg += view_of(model, keypoints_body, views[k], static_cast<double>(k % kColumns) * kSide,
                   static_cast<double>(k / kColumns) * kSide);
  return svg + "</svg>\n";
}

}  // namespace vbar::training
