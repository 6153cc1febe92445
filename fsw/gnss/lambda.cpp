#include "fsw/gnss/lambda.h"

#include <algorithm>
#include <utility>

#include "fsw/math/math.h"

namespace vbar::fsw::gnss {

namespace {

constexpr double kLargestFloat = 2251799813685248.0;  // 2^51
constexpr double kLargestWhole = 4503599627370496.0;  // 2^52
constexpr double kLargestFactor = 2147483647.0;       // 2^31 - 1

/// A conditional variance smaller than this part of the variance is the rounding error of the preceding subtractions:
/// kMaxAmbiguities of them leave 24 * 2.2e-16 of the variance, 0.5 % of this.
constexpr double kSmallestPivot = 1e-12;

/// An exchange is made if it reduces the later variance by at least 1 % (Lovasz' condition): a smaller gain
/// saves the search less than the exchange costs (measured: 0.9 doubles the nodes of hard problems).
constexpr double kWorthwhile = 0.99;

/// A multiple from which on the other elements of its column are reduced too, to prevent their growth
/// (Xie, Chang, Al Borno 2011, section 3.2).
constexpr double kLargeFactor = 2.0;

}  // namespace

Status Decorrelation::compute(std::span<const double> ambiguities, std::span<const double> covariance) {
  if (const Status status = load(ambiguities, covariance); status != Status::kOk) return status;
  if (const Status status = factorise(); status != Status::kOk) return status;
  if (const Status status = reduce(); status != Status::kOk) return status;
  return check_magnitudes();
}

Status Decorrelation::load(std::span<const double> ambiguities, std::span<const double> covariance) {
  const std::size_t n = ambiguities.size();
  if (n == 0 || n > kMaxAmbiguities || covariance.size() != n * n) return Status::kInvalidArgument;
  count_ = n;
  double sum = 0.0;  // NaN if any value is not finite
  for (std::size_t i = 0; i < n; ++i) {
    sum += 0.0 * ambiguities[i];
    double* row = l_.row(i);
    for (std::size_t j = 0; j <= i; ++j) {
      row[j] = covariance[i + j * n];
      sum += 0.0 * row[j];
    }
  }
  if (!math::is_finite(sum)) return Status::kNotFinite;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(math::abs(ambiguities[i]) < kLargestFloat)) return Status::kOutOfRange;
    whole_[i] = nearest_integer(ambiguities[i]);
    z_[i] = ambiguities[i] - whole_[i];
    column_[i] = static_cast<std::uint8_t>(i);
    double* column = back_column(i);
    for (std::size_t j = 0; j < n; ++j) column[j] = i == j ? 1.0 : 0.0;
  }
  return Status::kOk;
}

/// Factors Q = L' D L from the last row upwards: the next component is the one of minimum variance given those before.
Status Decorrelation::factorise() {
  std::array<double, kMaxAmbiguities> variance{};
  for (std::size_t i = 0; i < count_; ++i) variance[i] = l_.row(i)[i];
  for (std::size_t k = count_; k-- > 0;) {
    std::size_t sharpest = k;
    double minimum = l_.row(k)[k];
    for (std::size_t i = k; i-- > 0;) {
      if (l_.row(i)[i] < minimum) {
        sharpest = i;
        minimum = l_.row(i)[i];
      }
    }
    if (sharpest != k) {
      bring_to(sharpest, k);
      std::swap(variance[sharpest], variance[k]);
    }
    if (!(minimum > kSmallestPivot * variance[k])) return Status::kSingular;
    const double inverse = 1.0 / minimum;
    if (!math::is_finite(inverse)) return Status::kSingular;
    d_[k] = minimum;
    double* pivot_row = l_.row(k);
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = pivot_row[i] * inverse;
      double* row = l_.row(i);
      for (std::size_t j = 0; j <= i; ++j) row[j] -= factor * pivot_row[j];
    }
    for (std::size_t j = 0; j < k; ++j) pivot_row[j] *= inverse;
    pivot_row[k] = 1.0;
  }
  return Status::kOk;
}

/// Exchanges components `from` < `to` of the part not yet factored, and of the columns of the rows that are.
void Decorrelation::bring_to(std::size_t from, std::size_t to) {
  double* low = l_.row(from);
  double* high = l_.row(to);
  for (std::size_t j = 0; j < from; ++j) std::swap(low[j], high[j]);
  for (std::size_t i = from + 1; i < to; ++i) std::swap(l_.row(i)[from], high[i]);
  std::swap(low[from], high[to]);
  for (std::size_t i = to + 1; i < count_; ++i) std::swap(l_.row(i)[from], l_.row(i)[to]);
  std::swap(z_[from], z_[to]);
  std::swap(column_[from], column_[to]);
}

Status Decorrelation::reduce() {
  if (count_ == 1) return Status::kOk;
  // The product of the leading variances falls by kWorthwhile with every exchange and is bounded from below, so this
  // ends; hard problems of 24 ambiguities (condition number 1e8) take 7,000 visits.
  constexpr std::size_t kMaxVisits = 100'000;
  const std::size_t last = count_ - 2;
  std::size_t k = last;
  for (std::size_t visit = 0; visit < kMaxVisits; ++visit) {
    const double correlation = l_.row(k + 1)[k];
    const double factor = nearest_integer(correlation);
    const double rest = correlation - factor;
    const double exchanged = d_[k] + rest * rest * d_[k + 1];
    if (exchanged < kWorthwhile * d_[k + 1]) {
      if (const Status status = subtract(k, k + 1, factor); status != Status::kOk) return status;
      if (math::abs(factor) >= kLargeFactor) {
        for (std::size_t i = k + 2; i < count_; ++i) {
          const Status status = subtract(k, i, nearest_integer(l_.row(i)[k]));
          if (status != Status::kOk) return status;
        }
      }
      exchange(k, exchanged);
      if (k < last) ++k;
    } else {
      if (k == 0) return Status::kOk;
      --k;
    }
  }
  return Status::kDidNotConverge;
}

/// Integer Gauss transform: component `first` less a multiple of the later component `second`.
Status Decorrelation::subtract(std::size_t first, std::size_t second, double factor) {
  if (factor == 0.0) return Status::kOk;
  if (!(math::abs(factor) <= kLargestFactor)) return Status::kSingular;
  for (std::size_t i = second; i < count_; ++i) {
    double* row = l_.row(i);
    row[first] -= factor * row[second];
  }
  z_[first] -= factor * z_[second];
  const double* added = back_column(first);
  double* column = back_column(second);
  for (std::size_t i = 0; i < count_; ++i) column[i] += factor * added[i];
  return Status::kOk;
}

/// Exchanges components k and k + 1 and restores the triangle (Chang, Yang, Zhou 2005, equation 9). `new_d` is the
/// variance of component k when k + 1 is not known.
void Decorrelation::exchange(std::size_t k, double new_d) {
  double* upper = l_.row(k);
  double* lower = l_.row(k + 1);
  const double correlation = lower[k];
  const double inverse = 1.0 / new_d;
  const double kept = d_[k] * inverse;
  const double rotated = d_[k + 1] * correlation * inverse;
  d_[k] = kept * d_[k + 1];
  d_[k + 1] = new_d;
  lower[k] = rotated;
  for (std::size_t j = 0; j < k; ++j) {
    const double old = upper[j];
    upper[j] = lower[j] - correlation * old;
    lower[j] = kept * old + rotated * lower[j];
  }
  for (std::size_t i = k + 2; i < count_; ++i) std::swap(l_.row(i)[k], l_.row(i)[k + 1]);
  std::swap(z_[k], z_[k + 1]);
  std::swap(column_[k], column_[k + 1]);
}

Status Decorrelation::check_magnitudes() {
  largest_back_ = 0.0;
  for (std::size_t i = 0; i < count_ * count_; ++i) largest_back_ = std::max(largest_back_, math::abs(back_[i]));
  double largest = largest_back_;
  for (std::size_t k = 0; k < count_; ++k) largest = std::max(largest, math::abs(z_[k]));
  return largest < kLargestFactor ? Status::kOk : Status::kSingular;
}

Status Decorrelation::to_original(std::span<double> z) const {
  if (z.size() != count_) return Status::kInvalidArgument;
  double largest = 0.0;
  for (const double whole : z) largest = std::max(largest, math::abs(whole));
  // Products and sums of integers are exact below 2^53.
  if (!(static_cast<double>(count_) * largest * largest_back_ < kLargestWhole)) return Status::kOutOfRange;
  std::array<double, kMaxAmbiguities> sum = whole_;
  for (std::size_t k = 0; k < count_; ++k) {
    const double* column = back_column(k);
    for (std::size_t i = 0; i < count_; ++i) sum[i] += z[k] * column[i];
  }
  std::copy(sum.begin(), sum.begin() + static_cast<std::ptrdiff_t>(count_), z.begin());
  return Status::kOk;
}

namespace {

/// One component of the current vector.
struct Level {
  double centre = 0.0;     ///< float value given the integers of the later components
  double whole = 0.0;      ///< current integer
  double step = 0.0;       ///< to the next candidate: 1, -2, 3, ... or -1, 2, -3, ...
  double distance2 = 0.0;  ///< squared distance of the later components
  double weight = 0.0;     ///< 1 / conditional variance
};

void enter(Level& level, double centre, double distance2) {
  level.centre = centre;
  level.whole = nearest_integer(centre);
  level.step = __builtin_copysign(1.0, centre - level.whole);
  level.distance2 = distance2;
}

void next_candidate(Level& level) {
  level.whole += level.step;
  level.step = -level.step - __builtin_copysign(1.0, level.step);
}

/// Writes the current vector to its place.
void keep(const std::array<Level, kMaxAmbiguities>& levels, std::size_t n, double norm2, NearestIntegers& nearest) {
  std::array<double, kMaxAmbiguities>* place = &nearest.second;
  if (norm2 < nearest.best_norm2) {
    nearest.second = nearest.best;
    nearest.second_norm2 = nearest.best_norm2;
    nearest.best_norm2 = norm2;
    place = &nearest.best;
  } else {
    nearest.second_norm2 = norm2;
  }
  for (std::size_t k = 0; k < n; ++k) (*place)[k] = levels[k].whole;
  nearest.found = std::min<std::size_t>(nearest.found + 1, 2);
}

}  // namespace

Status search_integers(const Decorrelation& problem, const SearchLimits& limits, NearestIntegers& nearest) {
  const std::size_t n = problem.count();
  std::array<Level, kMaxAmbiguities> levels{};
  for (std::size_t k = 0; k < n; ++k) levels[k].weight = 1.0 / problem.d()[k];
  // Row k: centres of components 0 to k given the integers of those after k.
  LowerTriangle centres;
  std::copy(problem.z().begin(), problem.z().end(), centres.row(n - 1));
  nearest.found = 0;
  nearest.best_norm2 = limits.norm2;
  nearest.second_norm2 = limits.norm2;
  std::size_t k = n - 1;
  enter(levels[k], centres.row(k)[k], 0.0);
  for (std::size_t node = 0; node < limits.nodes; ++node) {
    Level& level = levels[k];
    const double residual = level.centre - level.whole;
    const double distance2 = level.distance2 + residual * residual * level.weight;
    if (!(distance2 < nearest.second_norm2)) {
      // Further candidates are only more distant: this component is exhausted.
      if (++k == n) return Status::kOk;
      next_candidate(levels[k]);
    } else if (k > 0) {
      const double* from = centres.row(k);
      const double* correlation = problem.l().row(k);
      double* to = centres.row(k - 1);
      for (std::size_t j = 0; j < k; ++j) to[j] = from[j] - residual * correlation[j];
      --k;
      enter(levels[k], to[k], distance2);
    } else {
      keep(levels, n, distance2, nearest);
      next_candidate(level);
    }
  }
  return Status::kDidNotConverge;
}

double bootstrap_success_rate(std::span<const double> conditional_variances) {
  double rate = 1.0;
  // 2 Phi(1 / (2 sigma)) - 1 = erf(1 / sqrt(8 sigma^2)).
  for (const double variance : conditional_variances) rate *= math::erf(math::sqrt(0.125 / variance));
  return rate;
}

double adop(std::span<const double> conditional_variances) {
  double log_determinant = 0.0;  // the determinant itself can underflow or overflow
  for (const double variance : conditional_variances) log_determinant += math::log(variance);
  return math::exp(0.5 * log_determinant / static_cast<double>(conditional_variances.size()));
}

Result<IntegerSolution> resolve_decorrelated(const Decorrelation& problem) {
  NearestIntegers nearest;
  if (const Status status = search_integers(problem, {}, nearest); status != Status::kOk) return status;
  if (nearest.found < 2) return Status::kOutOfRange;
  const std::size_t n = problem.count();
  if (const Status status = problem.to_original(std::span(nearest.best).first(n)); status != Status::kOk) return status;
  if (const Status status = problem.to_original(std::span(nearest.second).first(n)); status != Status::kOk) {
    return status;
  }
  return IntegerSolution{.count = n,
                         .best = nearest.best,
                         .second = nearest.second,
                         .best_norm2 = nearest.best_norm2,
                         .second_norm2 = nearest.second_norm2,
                         .success_rate = bootstrap_success_rate(problem.d())};
}

Result<IntegerSolution> resolve_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance) {
  Decorrelation problem;
  if (const Status status = problem.compute(ambiguities, covariance); status != Status::kOk) return status;
  return resolve_decorrelated(problem);
}

}  // namespace vbar::fsw::gnss
