#include "fsw/safety/drift_probability.h"

#include <array>

#include "fsw/math/math.h"
#include "fsw/safety/collision_probability.h"

namespace vbar::fsw::safety {
namespace {

constexpr double kBeyondSigmas = 8.0;  ///< the probability beyond is below 1e-14

/// Holds position and covariance in N of the axes, and the distance of the distribution from the body.
template <int N>
struct Candidate {
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Identity();
  double sigmas = 2.0 * kBeyondSigmas;  ///< from the mean to the sphere, along the line to its centre
};

/// Keeps the few samples nearest to the body in standard deviations.
template <int N>
class Nearest {
 public:
  void add(const Eigen::Matrix<double, N, 1>& mean, const Eigen::Matrix<double, N, N>& covariance, double radius) {
    const double distance = math::sqrt(mean.squaredNorm());
    const double variance = distance > 0.0 ? mean.dot(covariance * mean) / (distance * distance) : covariance.trace();
    if (!(variance > 0.0)) return;
    const double sigmas = (distance - radius) / math::sqrt(variance);
    std::size_t place = candidates_.size();
    while (place > 0 && sigmas < candidates_[place - 1].sigmas) --place;
    if (place == candidates_.size()) return;
    for (std::size_t k = candidates_.size() - 1; k > place; --k) candidates_[k] = candidates_[k - 1];
    candidates_[place] = {mean, covariance, sigmas};
  }

  /// Returns the largest `probability(mean, covariance)` of these samples.
  template <class Probability>
  Result<double> largest(const Probability& probability) const {
    double largest = 0.0;
    for (const Candidate<N>& candidate : candidates_) {
      if (candidate.sigmas > kBeyondSigmas) break;
      const Result<double> p = probability(candidate.mean, candidate.covariance);
      if (!p.ok()) return p;
      if (p.value() > largest) largest = p.value();
    }
    return largest;
  }

 private:
  std::array<Candidate<N>, 3> candidates_{};
};

}  // namespace

Result<DriftProbability> drift_probability(const LinearDrift& drift, const Vector6& a_roe_m,
                                           const Matrix6& covariance_m2, double radius) {
  if (!math::is_finite(a_roe_m.squaredNorm()) || !math::is_finite(covariance_m2.squaredNorm())) {
    return Status::kNotFinite;
  }
  Nearest<3> spatial;
  Nearest<2> radial_normal;
  for (int sample = 0; sample < drift.samples(); ++sample) {
    const PositionMap map = drift.map_at(sample);
    const Vector3 mean = map * a_roe_m;
    const Matrix3 covariance = map * covariance_m2 * map.transpose();
    spatial.add(mean, covariance, radius);
    Matrix2 in_plane;
    in_plane << covariance(0, 0), covariance(0, 2), covariance(2, 0), covariance(2, 2);
    radial_normal.add(Vector2(mean(0), mean(2)), in_plane, radius);
  }
  const Result<double> in_space = spatial.largest(
      [&](const Vector3& mean, const Matrix3& covariance) { return collision_probability(mean, covariance, radius); });
  const Result<double> in_plane = radial_normal.largest([&](const Vector2& mean, const Matrix2& covariance) {
    return collision_probability_in_plane(mean, covariance, radius);
  });
  if (!in_space.ok()) return in_space.status();
  if (!in_plane.ok()) return in_plane.status();
  return DriftProbability{.spatial = in_space.value(), .radial_normal = in_plane.value()};
}

}  // namespace vbar::fsw::safety
