#include "host_sim/sensors/gnss/difference_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace vbar::sensors {
namespace {

using fsw::Vector3;
using fsw::gnss::DifferentialEpoch;
using fsw::gnss::DifferentialObservation;
using fsw::gnss::kSignals;
using fsw::gnss::Signal;

/// Fewer pairs say nothing of a correlation.
constexpr std::size_t kFewestPairs = 50;
/// Receivers smooth the code by the phase; after a restart its noise decreases for this long. Correlations are of what
/// follows.
constexpr double kSettled_s = 120.0;
/// Redundant measurements that an epoch must have.
constexpr std::size_t kFewestRedundant = 2;

constexpr std::size_t index_of(Signal signal) {
  return static_cast<std::size_t>(signal);
}

double geometry_m(const DifferentialObservation& d, const Vector3& servicer_eci, const Vector3& target_eci) {
  return (d.target_source_eci - target_eci).norm() - (d.servicer_source_eci - servicer_eci).norm();
}

/// Distance from the nearest integer, cycles.
double fraction(double cycles) {
  return cycles - std::round(cycles);
}

/// A phase difference less geometry and integer.
struct Phase {
  const DifferentialObservation* observation = nullptr;
  double value_m = 0.0;
};

/// The phases of one signal as fractions about their medoid, without those that are not an integer away from it.
void append_fractions(const DifferentialEpoch& differences, const std::vector<double>& cycles, Signal signal,
                      std::vector<Phase>& phases, std::size_t& excluded) {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < differences.count; ++k) {
    const DifferentialObservation& d = differences.observations[k];
    if (d.signal == signal && d.phase_usable) places.push_back(k);
  }
  if (places.size() < 2) return;
  const auto spread = [&](std::size_t reference) {
    double sum = 0.0;
    for (const std::size_t k : places) sum += std::abs(fraction(cycles[k] - cycles[reference]));
    return sum;
  };
  const std::size_t reference = *std::ranges::min_element(places, {}, spread);
  constexpr double kFarthest = 0.25;
  for (const std::size_t k : places) {
    const double from_reference = fraction(cycles[k] - cycles[reference]);
    if (!(std::abs(from_reference) < kFarthest)) {
      ++excluded;
      continue;
    }
    phases.push_back({&differences.observations[k], from_reference * fsw::gnss::wavelength(signal)});
  }
}

/// Column of the offset of a signal; signals without phases have none.
std::array<int, kSignals> offset_columns(const std::vector<Phase>& phases, int& columns) {
  std::array<int, kSignals> column{};
  column.fill(-1);
  for (const Phase& phase : phases) {
    int& own = column[index_of(phase.observation->signal)];
    if (own < 0) own = columns++;
  }
  return column;
}

struct Fit {
  Eigen::VectorXd unknowns, residuals, redundancies;
};

Fit least_squares(const Eigen::MatrixXd& design, const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd weighted = weights.asDiagonal() * design;
  const Eigen::LDLT<Eigen::MatrixXd> normal(design.transpose() * weighted);
  Fit fit;
  fit.unknowns = normal.solve(weighted.transpose() * values);
  fit.residuals = values - design * fit.unknowns;
  const Eigen::MatrixXd gain = normal.solve(weighted.transpose());
  fit.redundancies = Eigen::VectorXd::Ones(values.size()) - (design * gain).diagonal();
  return fit;
}

/// Codes less geometry and the weighted mean of their signal.
void add_codes(std::vector<SignalResidual>& residuals, const std::vector<double>& codes_m) {
  std::array<double, kSignals> weights{}, sums{};
  const auto weight_of = [](const SignalResidual& r) { return 1.0 / (r.code_sigma_m * r.code_sigma_m); };
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    weights[index_of(residuals[k].signal)] += weight_of(residuals[k]);
    sums[index_of(residuals[k].signal)] += weight_of(residuals[k]) * codes_m[k];
  }
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const std::size_t signal = index_of(residuals[k].signal);
    residuals[k].code = {codes_m[k] - sums[signal] / weights[signal], 1.0 - weight_of(residuals[k]) / weights[signal]};
  }
}

}  // namespace

const char* name_of(Signal signal) {
  constexpr std::array<const char*, kSignals> kNames{"GPS L1", "GPS L2", "Galileo E1", "BeiDou B1I"};
  return kNames[index_of(signal)];
}

std::optional<ResidualEpoch> residuals_of(const DifferentialEpoch& differences, const Vector3& servicer_eci,
                                          const Vector3& baseline_eci) {
  const Vector3 target_eci = servicer_eci + baseline_eci;
  std::vector<double> cycles(differences.count);
  for (std::size_t k = 0; k < differences.count; ++k) {
    const DifferentialObservation& d = differences.observations[k];
    cycles[k] = (d.phase_m - geometry_m(d, servicer_eci, target_eci)) / fsw::gnss::wavelength(d.signal);
  }
  ResidualEpoch epoch;
  epoch.time = differences.time;
  std::vector<Phase> phases;
  for (std::size_t s = 0; s < kSignals; ++s)
    append_fractions(differences, cycles, static_cast<Signal>(s), phases, epoch.excluded[s]);
  int columns = 3;
  const std::array<int, kSignals> offset = offset_columns(phases, columns);
  if (phases.size() < static_cast<std::size_t>(columns) + kFewestRedundant) return std::nullopt;

  const auto rows = static_cast<Eigen::Index>(phases.size());
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd values(rows), weights(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Phase& phase = phases[static_cast<std::size_t>(k)];
    const DifferentialObservation& d = *phase.observation;
    design.row(k).head<3>() = (target_eci - d.target_source_eci).normalized().transpose();
    design(k, offset[index_of(d.signal)]) = 1.0;
    values(k) = phase.value_m;
    weights(k) = 1.0 / (d.phase_sigma_m * d.phase_sigma_m);
  }
  const Fit fit = least_squares(design, values, weights);
  if (!fit.residuals.allFinite() || !fit.redundancies.allFinite()) return std::nullopt;
  epoch.baseline_correction_m = fit.unknowns.head<3>();

  std::vector<double> codes_m;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const DifferentialObservation& d = *phases[static_cast<std::size_t>(k)].observation;
    epoch.residuals.push_back({d.satellite,
                               d.signal,
                               {fit.residuals(k), fit.redundancies(k)},
                               {},
                               d.phase_sigma_m,
                               d.code_sigma_m,
                               std::min(d.servicer_lock_s, d.target_lock_s)});
    codes_m.push_back(d.code_m - geometry_m(d, servicer_eci, target_eci + epoch.baseline_correction_m));
  }
  add_codes(epoch.residuals, codes_m);
  return epoch;
}

std::optional<double> DifferenceNoise::Lagged::correlation() const {
  if (pairs < kFewestPairs || !(squares > 0.0)) return std::nullopt;
  return products / squares;
}

void DifferenceNoise::Sums::add(const Residual& residual, double stated_sigma_m) {
  squares += residual.value_m * residual.value_m;
  redundancy += residual.redundancy;
  stated_squares += stated_sigma_m * stated_sigma_m;
}

void DifferenceNoise::Sums::add(std::size_t lag, const Residual& earlier, const Residual& later) {
  Lagged& sums = lagged[lag];
  ++sums.pairs;
  sums.products += earlier.value_m * later.value_m;
  sums.squares += 0.5 * (earlier.value_m * earlier.value_m + later.value_m * later.value_m);
}

void DifferenceNoise::add(const ResidualEpoch& epoch) {
  for (std::size_t s = 0; s < kSignals; ++s) signals_[s].excluded += epoch.excluded[s];
  for (const SignalResidual& residual : epoch.residuals) {
    SignalSums& sums = signals_[index_of(residual.signal)];
    ++sums.measurements;
    sums.phase.add(residual.phase, residual.phase_sigma_m);
    sums.code.add(residual.code, residual.code_sigma_m);
  }
  while (!recent_.empty() && recent_.front().time + kLags.back() < epoch.time) recent_.pop_front();
  for (std::size_t lag = 0; lag < kLags.size(); ++lag) {
    const auto earlier = std::ranges::find(recent_, epoch.time - kLags[lag], &ResidualEpoch::time);
    if (earlier == recent_.end()) continue;
    for (const SignalResidual& later : epoch.residuals) {
      // Restarted since, or not settled at the earlier time: not a stationary series.
      if (!(later.lock_s >= kSettled_s + fsw::seconds(kLags[lag]))) continue;
      const auto same = std::ranges::find_if(earlier->residuals, [&](const SignalResidual& r) {
        return r.satellite == later.satellite && r.signal == later.signal;
      });
      if (same == earlier->residuals.end()) continue;
      SignalSums& sums = signals_[index_of(later.signal)];
      sums.phase.add(lag, same->phase, later.phase);
      sums.code.add(lag, same->code, later.code);
    }
  }
  recent_.push_back(epoch);
}

/// A white and a Gauss-Markov part: the latter alone correlates, by s^2 exp(-lag/T).
void DifferenceNoise::add_wander(const Sums& phase, SignalNoiseRow& row) const {
  const std::optional<double> near = phase.lagged[0].correlation(), far = phase.lagged[1].correlation();
  if (!near || !far) return;
  // A correlation of white noise has a standard deviation of 1/sqrt(pairs).
  constexpr double kSignificant = 4.0;
  const auto is_significant = [](double correlation, const Lagged& lagged) {
    return correlation > kSignificant / std::sqrt(static_cast<double>(lagged.pairs));
  };
  if (!is_significant(*near, phase.lagged[0]) || !is_significant(*far, phase.lagged[1]) || !(*far < *near)) return;
  const double near_s = fsw::seconds(kLags[0]), far_s = fsw::seconds(kLags[1]);
  const double time_s = (far_s - near_s) / std::log(*near / *far);
  const double variance_m2 = phase.variance() * *near * std::exp(near_s / time_s);
  row.phase_wander_time_s = time_s;
  row.phase_wander_sigma_mm = 1e3 * std::sqrt(variance_m2 / 2.0);
}

std::vector<SignalNoiseRow> DifferenceNoise::rows() const {
  std::vector<SignalNoiseRow> rows;
  for (std::size_t s = 0; s < kSignals; ++s) {
    const SignalSums& sums = signals_[s];
    if (sums.measurements + sums.excluded == 0) continue;
    SignalNoiseRow& row = rows.emplace_back();
    row.signal = name_of(static_cast<Signal>(s));
    row.measurements = sums.measurements;
    row.excluded = sums.excluded;
    if (sums.measurements < kFewestPairs) continue;
    const auto count = static_cast<double>(sums.measurements);
    // Two satellites make a double difference.
    row.phase_sigma_mm = 1e3 * std::sqrt(2.0 * sums.phase.variance());
    row.phase_sigma_stated_mm = 1e3 * std::sqrt(2.0 * sums.phase.stated_squares / count);
    row.phase_correlation_10s = sums.phase.lagged[0].correlation();
    row.code_sigma_m = std::sqrt(2.0 * sums.code.variance());
    row.code_sigma_stated_m = std::sqrt(2.0 * sums.code.stated_squares / count);
    row.code_correlation_10s = sums.code.lagged[0].correlation();
    add_wander(sums.phase, row);
  }
  return rows;
}

}  // namespace vbar::sensors
