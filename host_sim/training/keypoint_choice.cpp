#include "host_sim/training/keypoint_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

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

}  // namespace vbar::training
