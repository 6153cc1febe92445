// The rows and propagations of a day of bearings, replayed through a Bierman-Thornton UD filter in long double: the
// square-root form that cannot lose positive definiteness (Bierman, Factorization Methods for Discrete Sequential
// Estimation, 1977, chapters V and VI).

#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fsw/measurements/bearings/bearing_aiding.h"
#include "fsw/measurements/source.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::filter {
namespace {

using namespace measurements::test;
using measurements::BearingBias;
using measurements::BrightnessOffset;
using measurements::CentroidWander;

constexpr int kActive = 13;  // ROE, drag, radiation pressure, bearing bias, brightness offset, wander
constexpr std::array<int, kActive> kIndex = {0,
                                             1,
                                             2,
                                             3,
                                             4,
                                             5,
                                             kAt<DifferentialAccelerations>,
                                             kAt<DifferentialAccelerations> + 1,
                                             kAt<BearingBias>,
                                             kAt<BearingBias> + 1,
                                             kAt<BrightnessOffset>,
                                             kAt<CentroidWander>,
                                             kAt<CentroidWander> + 1};
constexpr int kOfHead = 8;

using Real = long double;
using State = Eigen::Matrix<Real, kActive, 1>;
using Square = Eigen::Matrix<Real, kActive, kActive>;

/// P = U D U', U unit upper triangular.
class UdFilter {
 public:
  UdFilter(const State& mean, const Square& covariance) : x(mean) { factorise(covariance); }

  /// Thornton's modified weighted Gram-Schmidt orthogonalisation of [phi U, G] with weights [D, Q], where G Q G' is
  /// the noise.
  void propagate(const State& mean, const Square& phi, const Square& noise) {
    const UdFilter q(mean, noise);
    Eigen::Matrix<Real, kActive, 2 * kActive> w;
    w << phi * u, q.u;
    Eigen::Matrix<Real, 2 * kActive, 1> weight;
    weight << d, q.d;
    x = mean;
    for (int j = kActive - 1; j >= 0; --j) {
      const Eigen::Matrix<Real, 2 * kActive, 1> weighted = weight.cwiseProduct(w.row(j).transpose());
      d(j) = w.row(j).dot(weighted);
      for (int i = 0; i < j; ++i) {
        u(i, j) = d(j) > 0 ? w.row(i).dot(weighted) / d(j) : Real{0};
        w.row(i) -= u(i, j) * w.row(j);
      }
    }
  }

  /// Bierman's update by one scalar.
  void update(const State& h, Real residual, Real variance) {
    const State f = u.transpose() * h;
    const State v = d.cwiseProduct(f);
    State gain = State::Zero();
    Real alpha = variance;
    for (int j = 0; j < kActive; ++j) {
      const Real before = alpha;
      alpha += f(j) * v(j);
      d(j) *= before / alpha;
      const Real p = -f(j) / before;
      for (int i = 0; i < j; ++i) {
        const Real old = u(i, j);
        u(i, j) = old + gain(i) * p;
        gain(i) += old * v(j);
      }
      gain(j) = v(j);
    }
    x += gain * (residual / alpha);
  }

  [[nodiscard]] Real sigma(int i) const {
    Real variance = 0;
    for (int k = 0; k < kActive; ++k) variance += u(i, k) * u(i, k) * d(k);
    return std::sqrt(variance);
  }

  State x;
  Square u = Square::Identity();
  State d = State::Zero();

 private:
  void factorise(Square p) {
    for (int j = kActive - 1; j >= 0; --j) {
      d(j) = p(j, j);
      for (int i = 0; i < j; ++i) u(i, j) = d(j) > 0 ? p(i, j) / d(j) : Real{0};
      for (int i = 0; i < j; ++i) {
        for (int k = 0; k <= i; ++k) {
          p(k, i) -= u(k, j) * d(j) * u(i, j);
          p(i, k) = p(k, i);
        }
      }
    }
  }
};

State mean_of(const Estimate& estimate) {
  State mean;
  for (int k = 0; k < kActive; ++k) mean(k) = static_cast<Real>(estimate.mean(kIndex[static_cast<std::size_t>(k)]));
  return mean;
}

Square covariance_of(const Estimate& estimate) {
  Square covariance;
  for (int r = 0; r < kActive; ++r) {
    for (int c = 0; c < kActive; ++c) {
      covariance(r, c) = static_cast<Real>(
          estimate.covariance(kIndex[static_cast<std::size_t>(r)], kIndex[static_cast<std::size_t>(c)]));
    }
  }
  return covariance;
}

/// The process of a component behind the head.
const GaussMarkov& process_of(int k, const FilterSettings& settings) {
  if (k < 10) return settings.processes.of<BearingBias>();
  return k == 10 ? settings.processes.of<BrightnessOffset>() : settings.processes.of<CentroidWander>();
}

TEST(UdReplay, ADayOfBearingsHasTheSameMeansAndSigmas) {
  const auto filter = std::make_unique<RelativeNavigationFilter>();
  FilterSettings settings;
  settings.earth = scene_earth();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  orbit::CartesianState servicer = scene_servicer();
  orbit::CartesianState target = scene_target(servicer, roe_of_metres(-30.0, -20000.0, 0.0, 500.0, 0.0, 500.0));
  filter->set_states(servicer, target);
  const Vector6 wrong = roe_of_metres(-35.0, -20400.0, 40.0, 460.0, -30.0, 480.0);
  Vector6 sigma;
  sigma << 10.0, 500.0, 50.0, 50.0, 50.0, 50.0;
  sigma /= kA;
  filter->initialize_relative(wrong, sigma.cwiseAbs2().asDiagonal(), SolutionStatus::kEstimated);
  Estimate& estimate = filter->estimate();
  initialize_block<BearingBias>(estimate, settings.processes.of<BearingBias>());
  initialize_block<BrightnessOffset>(estimate, settings.processes.of<BrightnessOffset>());
  initialize_block<CentroidWander>(estimate, settings.processes.of<CentroidWander>());
  UdFilter ud(mean_of(estimate), covariance_of(estimate));

  Noise noise(5);
  GpsTime now = scene_start();
  accuracy::Largest largest_sigma, largest_mean;
  int updates = 0;
  for (int minute = 0; minute < 1440; ++minute) {
    const filter::Propagation truth(now, scene_earth(), scene_sun());
    servicer = truth.coast(servicer, 60.0);
    target = truth.coast(target, 60.0);
    now = now + duration_of_seconds(60);
    const State before = mean_of(estimate);
    filter->advance_to(now, {});
    Square phi = Square::Zero(), q = Square::Zero();
    phi.topLeftCorner<kOfHead, kOfHead>() =
        filter->last_motion().jacobian.topLeftCorner<kOfHead, kOfHead>().cast<Real>();
    q.topLeftCorner<kOfHead, kOfHead>() = filter->last_motion().noise.topLeftCorner<kOfHead, kOfHead>().cast<Real>();
    for (int k = kOfHead; k < kActive; ++k) {
      const double decay = process_of(k, settings).decay(60.0);
      phi(k, k) = static_cast<Real>(decay);
      q(k, k) = static_cast<Real>(process_of(k, settings).renewed_variance(decay));
    }
    const State after = mean_of(estimate);
    ud.propagate(after + phi * (ud.x - before), phi, q);

    const auto bearing = bearing_of(now, servicer, target, 12.0 * kArcsec, 12.0 * kArcsec * noise.normal2());
    MeasurementBatch& batch = filter->workspace();
    ASSERT_EQ(measurements::bearing_rows(*filter, bearing, scene_sun(), {}, batch), Status::kOk);
    const Eigen::Matrix<Real, 2, 2> lower =
        batch.noise.topLeftCorner<2, 2>().cast<Real>().llt().matrixL().toDenseMatrix();
    Eigen::Matrix<Real, 2, kActive> h;
    for (int r = 0; r < 2; ++r) {
      for (int k = 0; k < kActive; ++k) {
        h(r, k) = static_cast<Real>(batch.sensitivity(kIndex[static_cast<std::size_t>(k)], r));
      }
    }
    const State apart = ud.x - after;
    Eigen::Matrix<Real, 2, 1> residual = batch.residual.head<2>().cast<Real>() - h * apart;
    lower.triangularView<Eigen::Lower>().solveInPlace(h);
    lower.triangularView<Eigen::Lower>().solveInPlace(residual);
    ASSERT_TRUE(filter->update({}, batch));
    ud.update(h.row(0).transpose(), residual(0), Real{1});
    // The second residual is that after the first update.
    const State moved = ud.x - (after + apart);
    ud.update(h.row(1).transpose(), residual(1) - h.row(1).dot(moved), Real{1});
    updates += 2;

    const State mean = mean_of(estimate);
    for (int k = 0; k < kActive; ++k) {
      const Real reference = ud.sigma(k);
      ASSERT_GT(reference, 0);
      const int i = kIndex[static_cast<std::size_t>(k)];
      const Real sigma_here = std::sqrt(static_cast<Real>(estimate.variance(i)));
      largest_sigma.add(static_cast<double>(std::abs(sigma_here / reference - 1)));
      largest_mean.add(static_cast<double>(std::abs(mean(k) - ud.x(k)) / reference));
    }
  }
  EXPECT_EQ(updates, 2880);
  accuracy::expect_below("estimator: 1 sigma of each state during a day of bearings", "UD filter in long double",
                         largest_sigma, 1e-6, "relative");
  accuracy::expect_below("estimator: mean of each state during a day of bearings", "UD filter in long double",
                         largest_mean, 1e-3, "sigma");
  // The flight has converged: the comparison is not one of prior values.
  EXPECT_LT(std::sqrt(estimate.variance(1)), 0.3 * sigma(1));
}

// A plain object without pointers: its bytes, saved and restored elsewhere, continue with the same bits.
TEST(FilterMemory, IsPlainAndWithinItsLimit) {
  EXPECT_LE(sizeof(RelativeNavigationFilter) + sizeof(measurements::RecordQueue) + sizeof(measurements::Platform),
            450'000U);
  const auto original = std::make_unique<RelativeNavigationFilter>();
  original->advance_to(scene_start(), {});
  const orbit::CartesianState servicer = scene_servicer();
  original->set_states(servicer, scene_target(servicer, roe_of_metres(0.0, -500.0, 0.0, 50.0, 0.0, 50.0)));
  const auto restored = std::make_unique<RelativeNavigationFilter>();
  std::memcpy(static_cast<void*>(restored.get()), static_cast<const void*>(original.get()),
              sizeof(RelativeNavigationFilter));
  original->advance_to(scene_start() + duration_of_seconds(1000), {});
  EXPECT_NE(original->roe(), restored->roe());
  restored->advance_to(scene_start() + duration_of_seconds(1000), {});
  EXPECT_EQ(original->roe(), restored->roe());
  EXPECT_EQ(original->roe_covariance(), restored->roe_covariance());
  EXPECT_EQ(original->servicer().position_eci, restored->servicer().position_eci);
}

}  // namespace
}  // namespace vbar::fsw::filter
