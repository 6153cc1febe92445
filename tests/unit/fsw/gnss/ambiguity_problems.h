#pragma once
// Float ambiguity problems whose integers are known, for tests and benchmarks: of satellite geometry, as a receiver
// pair meets them, and of arbitrary covariances, as an algorithm has to stand.

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>

namespace vbar::fsw::gnss::problems {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Random = std::mt19937_64;

/// Double-difference ambiguities in cycles: float = integers + noise of the covariance.
struct Problem {
  Vector integers;
  Vector ambiguities;
  Matrix covariance;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(ambiguities.size()); }
};

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Vector standard_normal(Random& random, Eigen::Index n) {
  std::normal_distribution<double> normal;
  return Vector::NullaryExpr(n, [&] { return normal(random); });
}

/// New noise and new integers (within 10^5 cycles) on a given covariance.
inline Problem draw(const Matrix& covariance, Random& random) {
  const Eigen::Index n = covariance.rows();
  std::uniform_int_distribution<std::int64_t> integer(-100'000, 100'000);
  Problem problem;
  problem.covariance = covariance;
  problem.integers = Vector::NullaryExpr(n, [&] { return static_cast<double>(integer(random)); });
  const Eigen::LLT<Matrix> factor(covariance);
  problem.ambiguities = problem.integers + factor.matrixL() * standard_normal(random, n);
  return problem;
}

/// How a receiver pair has seen its satellites.
struct Session {
  int frequencies = 1;           ///< L1, or L1 and L2
  int epochs = 60;               ///< of the oldest satellite, 10 s apart
  int youngest_epochs = 60;      ///< of the newest one; the others between
  double code_sigma_m = 0.5;     ///< zenith, of an undifferenced pseudorange
  double phase_sigma_m = 0.001;  ///< the same of a carrier phase
  bool static_baseline = false;  ///< one baseline for all epochs, or each epoch its own
};

/// Covariance of n double-difference float ambiguities of a session with satellites at random over a low orbit: least
/// squares on code and phase, baseline free (each epoch or once), single differences with 1 / (0.3 + sin elevation)
/// noise, line of sight turning by 1e-3 rad/s about an axis of the satellite's own.
inline Matrix session_covariance(const Session& session, Eigen::Index n, Random& random) {
  const int frequencies = n % session.frequencies == 0 ? session.frequencies : 1;
  const Eigen::Index pairs = n / frequencies;  // satellites besides the reference
  constexpr double kWavelength[2] = {0.190293672798, 0.244210213425};
  struct Satellite {
    Eigen::Vector3d los, axis;
    int first_epoch;
  };
  std::vector<Satellite> satellites;
  for (Eigen::Index s = 0; s <= pairs; ++s) {
    const double up = s == 0 ? 0.97 : uniform(random, 0.05, 1.0);
    const double azimuth = uniform(random, 0.0, 6.283185307179586);
    const double flat = std::sqrt(1.0 - up * up);
    const int age =
        s == 0 ? session.epochs : std::uniform_int_distribution<int>(session.youngest_epochs, session.epochs)(random);
    satellites.push_back({{flat * std::sin(azimuth), flat * std::cos(azimuth), up},
                          standard_normal(random, 3).normalized(),
                          session.epochs - age});
  }
  // Normal equations of baseline and ambiguities; the baseline is eliminated, each epoch or at the end.
  Matrix ambiguity_normal = Matrix::Zero(n, n);
  Eigen::Matrix3d baseline_normal = Eigen::Matrix3d::Zero();
  Matrix mixed = Matrix::Zero(3, n);
  const auto eliminate = [&] {
    ambiguity_normal -= mixed.transpose() * baseline_normal.ldlt().solve(mixed);
    baseline_normal.setZero();
    mixed.setZero();
  };
  for (int epoch = 0; epoch < session.epochs; ++epoch) {
    std::vector<Eigen::Index> seen;
    for (Eigen::Index s = 1; s <= pairs; ++s) {
      if (satellites[static_cast<std::size_t>(s)].first_epoch <= epoch) seen.push_back(s);
    }
    if (seen.size() < 3) continue;
    const auto m = static_cast<Eigen::Index>(seen.size());
    const auto line_of_sight = [&](Eigen::Index s) -> Eigen::Vector3d {
      const Satellite& satellite = satellites[static_cast<std::size_t>(s)];
      const double angle = 1e-3 * 10.0 * (epoch - session.epochs);
      return (satellite.los + angle * satellite.axis.cross(satellite.los)).normalized();
    };
    const auto variance = [&](Eigen::Index s) {
      const double sigma = 1.0 / (0.3 + std::max(0.0, satellites[static_cast<std::size_t>(s)].los.z()));
      return 2.0 * sigma * sigma;  // of a single difference, in units of the zenith variance
    };
    Matrix design(m, 3);
    Matrix noise = Matrix::Constant(m, m, variance(0));
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index s = seen[static_cast<std::size_t>(i)];
      design.row(i) = (line_of_sight(0) - line_of_sight(s)).transpose();
      noise(i, i) += variance(s);
    }
    const Matrix weight = noise.inverse();
    for (int f = 0; f < frequencies; ++f) {
      const double code = 1.0 / (session.code_sigma_m * session.code_sigma_m);
      const double phase = 1.0 / (session.phase_sigma_m * session.phase_sigma_m);
      baseline_normal += (code + phase) * design.transpose() * weight * design;
      const Matrix weighted = phase * kWavelength[f] * design.transpose() * weight;
      for (Eigen::Index i = 0; i < m; ++i) {
        const Eigen::Index column = f * pairs + seen[static_cast<std::size_t>(i)] - 1;
        mixed.col(column) += weighted.col(i);
        for (Eigen::Index j = 0; j < m; ++j) {
          const Eigen::Index row = f * pairs + seen[static_cast<std::size_t>(j)] - 1;
          ambiguity_normal(row, column) += phase * kWavelength[f] * kWavelength[f] * weight(j, i);
        }
      }
    }
    if (!session.static_baseline) eliminate();
  }
  if (session.static_baseline) eliminate();
  const Matrix covariance = ambiguity_normal.inverse();
  return 0.5 * (covariance + covariance.transpose());
}

/// A session of random kind: strong to weak, short and long arcs, one or two frequencies, kinematic or static.
inline Matrix random_session_covariance(Eigen::Index n, Random& random) {
  Session session;
  session.frequencies = std::uniform_int_distribution<int>(1, 2)(random);
  session.epochs = std::uniform_int_distribution<int>(1, 60)(random);
  session.youngest_epochs = std::uniform_int_distribution<int>(1, session.epochs)(random);
  session.code_sigma_m = std::pow(10.0, uniform(random, -1.0, 0.5));
  session.phase_sigma_m = uniform(random, 0.0005, 0.005);
  session.static_baseline = uniform(random, 0.0, 1.0) < 0.3;
  return session_covariance(session, n, random);
}

/// Symmetric positive definite without structure: random axes, eigenvalues log-uniform over `decades`, mean variance
/// `scale` (cycles^2).
inline Matrix random_covariance(Eigen::Index n, double decades, double scale, Random& random) {
  Matrix gaussian(n, n);
  for (Eigen::Index j = 0; j < n; ++j) gaussian.col(j) = standard_normal(random, n);
  const Matrix axes = gaussian.householderQr().householderQ();
  const Vector eigenvalues =
      Vector::NullaryExpr(n, [&] { return scale * std::pow(10.0, -uniform(random, 0.0, decades)); });
  const Matrix covariance = axes * eigenvalues.asDiagonal() * axes.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace vbar::fsw::gnss::problems
