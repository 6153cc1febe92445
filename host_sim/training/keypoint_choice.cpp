#include "host_sim/training/keypoint_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::training {

namespace {

using fsw::Vector3;
using twins::camera::CadModel;
using twins::camera::Triangle;

constexpr int kDirections = 300;

/// On a Fibonacci lattice of the sphere.
Vector3 direction(int k) {
  constexpr double kGoldenAngle = std::numbers::pi * (3.0 - 2.2360679774997896);
  const double z = 1.0 - (2.0 * k + 1.0) / kDirections;
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(kGoldenAngle * k), r * std::sin(kGoldenAngle * k), z};
}

/// Distance along a ray to a triangle, infinite beside it (Moeller and Trumbore 1997).
double distance_to(const Triangle& t, const Vector3& from, const Vector3& along) {
  constexpr double kBeside = std::numeric_limits<double>::infinity();
  const Vector3 first = t.corners[1] - t.corners[0], second = t.corners[2] - t.corners[0];
  const Vector3 p = along.cross(second);
  const double determinant = first.dot(p);
  if (std::abs(determinant) < 1e-15) return kBeside;
  const Vector3 s = from - t.corners[0];
  const double u = s.dot(p) / determinant;
  const Vector3 q = s.cross(first);
  const double v = along.dot(q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return kBeside;
  return second.dot(q) / determinant;
}

/// The vertices of a model, and from how many directions they are seen as far as that was asked.
class Candidates {
 public:
  Candidates(const CadModel& model, const Vector3& centre_of_mass_body)
      : model_(model), centre_of_mass_body_(centre_of_mass_body) {
    for (const Triangle& triangle : model.triangles)
      places_.insert(places_.end(), triangle.corners.begin(), triangle.corners.end());
    const auto key = [](const Vector3& p) { return std::array{p.x(), p.y(), p.z()}; };
    std::ranges::sort(places_, {}, key);
    const auto are_same = [&](const Vector3& a, const Vector3& b) { return key(a) == key(b); };
    places_.erase(std::unique(places_.begin(), places_.end(), are_same), places_.end());
    seen_shares_.resize(places_.size());
  }

  /// At most `count` vertices, each seen from at least this share of all directions.
  std::vector<ChosenKeypoint> farthest(std::size_t count, double min_seen_share) {
    std::vector<double> distances;  // from those chosen, negative if passed over
    for (const Vector3& place : places_) distances.push_back((place - centre_of_mass_body_).norm());
    std::vector<ChosenKeypoint> chosen;
    while (chosen.size() < count) {
      const auto k = static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
      if (distances[k] < (chosen.empty() ? 0.0 : kMinSeparation * model_.radius_m)) break;
      if (seen_share_of(k) < min_seen_share) {
        distances[k] = -1.0;
        continue;
      }
      const bool is_first = chosen.empty();
      chosen.push_back({places_[k], seen_share_of(k)});
      for (std::size_t j = 0; j < places_.size(); ++j) {
        const double distance = (places_[j] - places_[k]).norm();
        if (distances[j] >= 0.0) distances[j] = is_first ? distance : std::min(distances[j], distance);
      }
    }
    return chosen;
  }

 private:
  double seen_share_of(std::size_t k) {
    if (!seen_shares_[k]) seen_shares_[k] = seen_share(model_, places_[k]);
    return *seen_shares_[k];
  }

  const CadModel& model_;
  Vector3 centre_of_mass_body_;
  std::vector<Vector3> places_;
  std::vector<std::optional<double>> seen_shares_;
};

}  // namespace

bool is_hidden(const CadModel& model, const Vector3& point_body, const Vector3& direction_body) {
  // Beyond the faces that meet in the point.
  const double least = 1e-3 * model.radius_m;
  return std::ranges::any_of(model.triangles, [&](const Triangle& triangle) {
    const double distance = distance_to(triangle, point_body, direction_body);
    return distance > least && distance < std::numeric_limits<double>::infinity();
  });
}

double seen_share(const CadModel& model, const Vector3& point_body) {
  int seen = 0;
  for (int k = 0; k < kDirections; ++k)
    if (!is_hidden(model, point_body, direction(k))) ++seen;
  return static_cast<double>(seen) / kDirections;
}

std::vector<ChosenKeypoint> choose_keypoints(const CadModel& model, const Vector3& centre_of_mass_body,
                                             std::size_t count) {
  Candidates candidates(model, centre_of_mass_body);
  std::size_t found = 0;
  constexpr double kStep = 0.05;
  for (double min_share = kMaxSeenShare; min_share > kMinSeenShare - 0.5 * kStep; min_share -= kStep) {
    std::vector<ChosenKeypoint> chosen = candidates.farthest(count, min_share);
    if (chosen.size() == count) return chosen;
    found = chosen.size();
  }
  throw std::runtime_error(
      fmt::format("{}: {} vertices that half of all directions see and that lie {:.3f} m apart; required are {}",
                  model.source, found, kMinSeparation * model.radius_m, count));
}

// SVG of a target with its keypoints, for review.

namespace {

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
