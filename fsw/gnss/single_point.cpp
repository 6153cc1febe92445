#include "fsw/gnss/single_point.h"

#include <array>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

constexpr std::size_t kMaxSatellites = gnss::kMaxObservations;
constexpr int kMaxIterations = 12;

// Upper bound of the ionospheric difference between two frequencies.
constexpr double kMaxDispersion_m = 200.0;
// A residual beyond this number of sigma is an outlier.
constexpr double kWorstResidual = 5.0;
// Clock offsets of the other constellations from GPS time: keeps the equations regular without them.
constexpr double kSystemOffsetSigma_m = 300.0;
// Low orbits, and the surface for bench tests.
constexpr double kMinRadius = 6.3e6;
constexpr double kGreatestRadius = 9.5e6;

struct Range {
  SignalSource source;
  double corrected_m = 0.0;  ///< pseudorange plus the satellite clock
  double sigma_m = 0.0;
  std::size_t system = 0;
  bool used = true;
};

struct Ranges {
  std::array<Range, kMaxSatellites> of{};
  std::size_t count = 0;
};

/// One range per satellite: ionosphere-free for GPS if L2 is available.
Ranges ranges_of(const gnss::ObservationEpoch& epoch, const EphemerisStore& ephemerides, const EarthFrame& frame,
                 const RangeErrors& errors) {
  constexpr double kGamma = (gnss::kL1_Hz / gnss::kL2_Hz) * (gnss::kL1_Hz / gnss::kL2_Hz);
  Ranges ranges;
  for (std::size_t k = 0; k < epoch.count; ++k) {
    const gnss::Observation& first = epoch.observations[k];
    if (first.signal == gnss::Signal::kGpsL2) continue;
    const auto source = signal_source(first.satellite, first.pseudorange_m, epoch.receiver_time, ephemerides, frame);
    if (!source.ok()) continue;
    Range range{.source = source.value()};
    range.system = static_cast<std::size_t>(first.satellite.constellation);
    double pseudorange = first.pseudorange_m;
    double noise = first.pseudorange_sigma_m;
    double unmodelled = errors.ionosphere_sigma_m;
    if (first.signal == gnss::Signal::kGpsL1 && k + 1 < epoch.count &&
        epoch.observations[k + 1].satellite == first.satellite) {
      const gnss::Observation& second = epoch.observations[k + 1];
      if (!(math::abs(second.pseudorange_m - first.pseudorange_m) < kMaxDispersion_m)) continue;
      pseudorange = (kGamma * first.pseudorange_m - second.pseudorange_m) / (kGamma - 1.0);
      noise = math::hypot(kGamma * first.pseudorange_sigma_m, second.pseudorange_sigma_m) / (kGamma - 1.0);
      unmodelled = 0.0;
    }
    range.corrected_m = pseudorange + range.source.clock_m;
    range.sigma_m =
        math::sqrt(noise * noise + unmodelled * unmodelled + errors.broadcast_sigma_m * errors.broadcast_sigma_m);
    if (math::is_finite(range.corrected_m + range.sigma_m)) ranges.of[ranges.count++] = range;
  }
  return ranges;
}

/// Position, clock, and the offsets of Galileo and BeiDou from it.
using Unknowns = Vector6;

double residual_of(const Range& range, const Unknowns& x) {
  const double offset = range.system == 0 ? 0.0 : x(3 + static_cast<int>(range.system));
  return range.corrected_m - (range.source.position_eci - x.head<3>()).norm() - x(3) - offset;
}

Vector6 row_of(const Range& range, const Unknowns& x) {
  Vector6 row = Vector6::Zero();
  row.head<3>() = (x.head<3>() - range.source.position_eci).normalized();
  row(3) = 1.0;
  if (range.system > 0) row(3 + static_cast<int>(range.system)) = 1.0;
  return row;
}

struct Fit {
  Unknowns x = Unknowns::Zero();
  Matrix6 covariance = Matrix6::Zero();
  Status status = Status::kDidNotConverge;
};

Fit fit(const Ranges& ranges, Unknowns x) {
  Fit result;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    normal(4, 4) = normal(5, 5) = 1.0 / (kSystemOffsetSigma_m * kSystemOffsetSigma_m);
    right(4) = -normal(4, 4) * x(4);
    right(5) = -normal(5, 5) * x(5);
    for (std::size_t k = 0; k < ranges.count; ++k) {
      const Range& range = ranges.of[k];
      if (!range.used) continue;
      const Vector6 row = row_of(range, x);
      const double weight = 1.0 / (range.sigma_m * range.sigma_m);
      normal += (weight * row).lazyProduct(row.transpose());
      right += weight * residual_of(range, x) * row;
    }
    const math::Cholesky6 factor(normal);
    if (!factor.ok()) {
      result.status = Status::kSingular;
      return result;
    }
    const Vector6 step = factor.solve(right);
    x += step;
    if (!math::is_finite(x.squaredNorm())) return result;
    if (step.head<4>().norm() < 1e-4) {
      result.status = Status::kOk;
      result.x = x;
      for (int k = 0; k < 6; ++k) result.covariance.col(k) = factor.solve(Vector6::Unit(k));
      return result;
    }
  }
  return result;
}

std::size_t used_count(const Ranges& ranges) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < ranges.count; ++k) count += ranges.of[k].used ? 1U : 0U;
  return count;
}

std::size_t unknown_count(const Ranges& ranges) {
  std::array<bool, gnss::kConstellations> present{};
  for (std::size_t k = 0; k < ranges.count; ++k) {
    if (ranges.of[k].used) present[ranges.of[k].system] = true;
  }
  std::size_t count = 3;
  for (const bool is_present : present) count += is_present ? 1U : 0U;
  return count;
}

/// Removes the range with the worst residual; false if all of them fit. An outlier moves the solution, so that its own
/// residual decreases and those of others increase: each is compared with the standard deviation that the fit leaves it
/// (Baarda 1968: w-test).
bool drop_worst(Ranges& ranges, const Fit& fitted) {
  // Below it a range alone determines an unknown, and its residual says nothing.
  constexpr double kMinRedundancy = 1e-3;
  double worst = kWorstResidual * kWorstResidual;
  std::size_t place = ranges.count;
  for (std::size_t k = 0; k < ranges.count; ++k) {
    const Range& range = ranges.of[k];
    if (!range.used) continue;
    const double variance = range.sigma_m * range.sigma_m;
    const Vector6 row = row_of(range, fitted.x);
    const double redundancy = 1.0 - row.dot(fitted.covariance * row) / variance;
    const double residual = residual_of(range, fitted.x);
    if (!(redundancy > kMinRedundancy) || !(residual * residual > worst * redundancy * variance)) continue;
    worst = residual * residual / (redundancy * variance);
    place = k;
  }
  if (place == ranges.count) return false;
  ranges.of[place].used = false;
  return true;
}

}  // namespace

Result<SinglePoint> single_point(const gnss::ObservationEpoch& epoch, const EphemerisStore& ephemerides,
                                 const EarthFrame& frame, const RangeErrors& errors) {
  Ranges ranges = ranges_of(epoch, ephemerides, frame, errors);
  const std::size_t max_dropped = ranges.count / 4;
  Unknowns x = Unknowns::Zero();
  // The first iteration starts at the Earth's centre; a metre along any axis keeps directions defined.
  x(0) = 1.0;
  for (std::size_t dropped = 0; dropped <= max_dropped; ++dropped) {
    if (used_count(ranges) < unknown_count(ranges) + 1) return Status::kNotReady;
    const Fit fitted = fit(ranges, x);
    if (fitted.status != Status::kOk) return fitted.status;
    x = fitted.x;
    if (drop_worst(ranges, fitted)) continue;
    const double radius = x.head<3>().norm();
    if (radius < kMinRadius || radius > kGreatestRadius) return Status::kDidNotConverge;
    const Matrix3 covariance_m2 = fitted.covariance.topLeftCorner<3, 3>();
    return SinglePoint{.position_eci = x.head<3>(),
                       .clock_m = x(3),
                       .sigma_m = math::sqrt(covariance_m2.trace() / 3.0),
                       .covariance_m2 = covariance_m2,
                       .used = used_count(ranges)};
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::gnss
