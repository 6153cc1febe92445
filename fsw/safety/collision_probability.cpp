#include "fsw/safety/collision_probability.h"

#include <array>
#include <cstddef>

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/math/quadrature.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::safety {

namespace {

constexpr double kSqrtHalf = 0.70710678118654752440;
constexpr double kInverseSqrtTwoPi = 0.39894228040143267794;
constexpr double kTail = 8.5;  ///< standard deviations; the probability beyond is less than 1e-16

double density(double z) {
  return kInverseSqrtTwoPi * math::exp(-0.5 * z * z);
}

/// Returns the probability of a standard normal number between low and high, without cancellation in the tails.
double interval(double low, double high) {
  if (low > 0.0) return 0.5 * (math::erfc(low * kSqrtHalf) - math::erfc(high * kSqrtHalf));
  if (high < 0.0) return 0.5 * (math::erfc(-high * kSqrtHalf) - math::erfc(-low * kSqrtHalf));
  return 0.5 * (math::erf(high * kSqrtHalf) - math::erf(low * kSqrtHalf));
}

double clamp(double x, double low, double high) {
  return x < low ? low : (x > high ? high : x);
}

double probability(double p) {
  return clamp(p, 0.0, 1.0);
}

/// Holds a normally distributed coordinate.
struct Normal {
  double mean = 0.0;
  double sigma = 1.0;

  [[nodiscard]] double density_at(double x) const { return density((x - mean) / sigma) / sigma; }
  [[nodiscard]] double between(double low, double high) const {
    return interval((low - mean) / sigma, (high - mean) / sigma);
  }
  /// The radius that remains for the other coordinates: |x| below it is outside the integral of this one.
  [[nodiscard]] double nearest() const {
    const double reach = math::abs(mean) - kTail * sigma;
    return reach > 0.0 ? reach : 0.0;
  }
};

/// Returns the integral over |x| <= limit of density(x) inner(x). x = limit sin(angle) removes the root of chords at
/// the rim; only the interval of non-negligible density is sampled.
template <class Inner>
double integrate_chords(const Normal& x, double limit, const Inner& inner) {
  const double low = math::asin(clamp((x.mean - kTail * x.sigma) / limit, -1.0, 1.0));
  const double high = math::asin(clamp((x.mean + kTail * x.sigma) / limit, -1.0, 1.0));
  if (!(high > low)) return 0.0;
  const auto integrand = [&](double angle) {
    const double position = limit * math::sin(angle);
    return limit * math::cos(angle) * x.density_at(position) * inner(position);
  };
  const double middle = 0.5 * (low + high);
  return math::integrate(integrand, low, middle) + math::integrate(integrand, middle, high);
}

/// Returns half the chord of a circle or sphere of `radius` at `x`.
double half_chord(double radius, double x) {
  const double squared = (radius - x) * (radius + x);
  return squared > 0.0 ? math::sqrt(squared) : 0.0;
}

/// Holds the principal axes of a covariance in order of increasing standard deviations, with the mean in these axes.
template <int N>
struct Principal {
  std::array<Normal, static_cast<std::size_t>(N)> axis;
};

template <int N>
Result<Principal<N>> principal_axes(const Eigen::Matrix<double, N, 1>& mean,
                                    const Eigen::Matrix<double, N, N>& covariance) {
  if (!math::is_finite(mean.squaredNorm())) return Status::kNotFinite;
  const Result<math::SymmetricEigen<N>> eigen = math::symmetric_eigen<N>(covariance);
  if (!eigen.ok()) return eigen.status();
  const Eigen::Matrix<double, N, 1> along = eigen.value().vectors.transpose() * mean;
  Principal<N> principal;
  for (int k = 0; k < N; ++k) {
    const double variance = eigen.value().values(k);
    if (!(variance > 0.0)) return Status::kOutOfRange;
    principal.axis[static_cast<std::size_t>(k)] = {.mean = along(k), .sigma = math::sqrt(variance)};
  }
  return principal;
}

Status check_radius(double radius) {
  if (!math::is_finite(radius)) return Status::kNotFinite;
  return radius >= 0.0 ? Status::kOk : Status::kOutOfRange;
}

/// Holds relative position and covariance in the plane perpendicular to the relative velocity, first axis along the
/// miss.
struct Encounter {
  Vector2 miss = Vector2::Zero();
  Matrix2 covariance = Matrix2::Zero();
};

Result<Encounter> encounter_plane(const Vector3& r, const Vector3& v, const Matrix3& covariance) {
  if (!math::is_finite(r.squaredNorm()) || !math::is_finite(v.squaredNorm())) return Status::kNotFinite;
  const double speed = math::sqrt(v.squaredNorm());
  if (speed <= 0.0) return Status::kOutOfRange;
  const Vector3 along = v / speed;
  Vector3 across = r - r.dot(along) * along;
  const double miss = math::sqrt(across.squaredNorm());
  across = miss > 0.0 ? Vector3(across / miss) : along.unitOrthogonal();
  Eigen::Matrix<double, 2, 3> plane;
  plane.row(0) = across;
  plane.row(1) = along.cross(across);
  return Encounter{.miss = Vector2(miss, 0.0), .covariance = plane * covariance * plane.transpose()};
}

}  // namespace

Result<double> collision_probability_isotropic(double distance, double sigma, double radius) {
  if (!math::is_finite(distance + sigma + radius)) return Status::kNotFinite;
  if (distance < 0.0 || sigma <= 0.0 || radius < 0.0) return Status::kOutOfRange;
  // For distances near zero the two densities cancel. The relative error of the limit is (distance / sigma)^2.
  constexpr double kConcentric = 1e-5;
  const double reach = radius / sigma;
  const double offset = distance / sigma;
  if (offset < kConcentric) return probability(interval(-reach, reach) - 2.0 * reach * density(reach));
  const double far = offset + reach;
  const double near = offset - reach;
  return probability(interval(near, far) + (density(far) - density(near)) / offset);
}

Result<double> collision_probability(const Vector3& mean, const Matrix3& covariance, double radius) {
  if (const Status status = check_radius(radius); status != Status::kOk) return status;
  const Result<Principal<3>> principal = principal_axes<3>(mean, covariance);
  if (!principal.ok()) return principal.status();
  // Closed form along the axis x of the smallest sigma, whose distribution may be far narrower than the ball.
  const Normal& x = principal.value().axis[0];
  const Normal& y = principal.value().axis[1];
  const Normal& z = principal.value().axis[2];
  const double limit = half_chord(radius, x.nearest());
  if (limit <= 0.0) return 0.0;
  return probability(integrate_chords(z, limit, [&](double at_z) {
    const double disk = half_chord(limit, at_z);
    if (disk <= 0.0) return 0.0;
    const double section = half_chord(radius, at_z);
    return integrate_chords(y, disk, [&](double at_y) {
      const double chord = half_chord(section, at_y);
      return x.between(-chord, chord);
    });
  }));
}

Result<double> collision_probability_in_plane(const Vector2& mean, const Matrix2& covariance, double radius) {
  if (const Status status = check_radius(radius); status != Status::kOk) return status;
  const Result<Principal<2>> principal = principal_axes<2>(mean, covariance);
  if (!principal.ok()) return principal.status();
  const Normal& x = principal.value().axis[0];
  const Normal& y = principal.value().axis[1];
  const double limit = half_chord(radius, x.nearest());
  if (limit <= 0.0) return 0.0;
  return probability(integrate_chords(y, limit, [&](double at_y) {
    const double chord = half_chord(radius, at_y);
    return x.between(-chord, chord);
  }));
}

Result<double> collision_probability_short_encounter(const Vector3& relative_position, const Vector3& relative_velocity,
                                                     const Matrix3& covariance, double radius) {
  const Result<Encounter> encounter = encounter_plane(relative_position, relative_velocity, covariance);
  if (!encounter.ok()) return encounter.status();
  return collision_probability_in_plane(encounter.value().miss, encounter.value().covariance, radius);
}

Result<double> maximum_probability_short_encounter(const Vector3& relative_position, const Vector3& relative_velocity,
                                                   const Matrix3& covariance, double radius) {
  if (const Status status = check_radius(radius); status != Status::kOk) return status;
  const Result<Encounter> encounter = encounter_plane(relative_position, relative_velocity, covariance);
  if (!encounter.ok()) return encounter.status();
  const Matrix2& c = encounter.value().covariance;
  if (!math::is_finite(c.squaredNorm())) return Status::kNotFinite;
  const double determinant = c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0);
  if (!(c(0, 0) > 0.0) || !(determinant > 0.0)) return Status::kOutOfRange;
  const double miss = encounter.value().miss.x();
  if (miss <= radius) return 1.0;
  const double mahalanobis_squared = miss * miss * c(1, 1) / determinant;
  constexpr double kE = 2.71828182845904523536;
  return probability(radius * radius / (kE * math::sqrt(determinant) * mahalanobis_squared));
}

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
