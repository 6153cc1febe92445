#include "emulators/grand/receiver/tracking_loops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::grand::bench {

const NormalTable& NormalTable::instance() {
  static const NormalTable table;
  return table;
}

// Cubic Hermite: value and derivative (the inverse of the density) of the quantile at both ends of each cell.
NormalTable::NormalTable() {
  constexpr double kWidth = 1.0 / static_cast<double>(kCells);
  const auto value = [](std::size_t node) { return engine::normal_quantile(static_cast<double>(node) * kWidth); };
  const auto derivative = [&value](std::size_t node) {
    const double x = value(node);
    return kWidth * std::sqrt(2.0 * std::numbers::pi) * std::exp(x * x / 2.0);
  };
  for (std::size_t k = kTail; k < kCells - kTail; ++k) {
    const double low = value(k);
    const double high = value(k + 1);
    const double at_low = derivative(k);
    const double at_high = derivative(k + 1);
    cells_[k] = {low, at_low, 3.0 * (high - low) - 2.0 * at_low - at_high, 2.0 * (low - high) + at_low + at_high};
  }
}

namespace {

using twins::gnss::Signal;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kFrequencyGain = 0.25;  ///< gain of the frequency loop, per update
constexpr double kPullInSpacing_chips = 1.0;
constexpr double kPullInCodeBandwidth_hz = 5.0;
// An exponential mean with the variance of a mean over 100 updates.
constexpr double kLockMeanWeight = 2.0 / 101.0;
constexpr double kMinAmplitude = 1.0;    ///< 17 dB-Hz
constexpr double kFirstAmplitude = 8.0;  ///< 35 dB-Hz, until it has been measured

double square(double x) {
  return x * x;
}

}  // namespace

TrackingLoops::TrackingLoops(const LoopSettings& settings, Signal signal)
    : wavelength_m_(twins::gnss::wavelength_m(signal)),
      chip_m_(fsw::gnss::kSpeedOfLight / twins::gnss::structure(signal).chip_rate_hz),
      spacing_(twins::gnss::structure(signal).correlator_spacing_chips),
      code_bandwidth_hz_(signal == Signal::kGpsL2 ? settings.code_bandwidth_l2_hz : settings.code_bandwidth_hz) {
  const double b = settings.carrier_bandwidth_hz;
  if (settings.carrier_order == 3) {
    const double w = b / 0.7845;
    gain_acceleration_ = w * w * w * kUpdate_s;
    gain_rate_ = 1.1 * w * w * kUpdate_s;
    gain_phase_ = 2.4 * w * kUpdate_s;
  } else {
    const double w = b / 0.53;
    gain_acceleration_ = 0.0;
    gain_rate_ = w * w * kUpdate_s;
    gain_phase_ = std::numbers::sqrt2 * w * kUpdate_s;
  }
}

void TrackingLoops::start(double phase_cycles, double rate_hz, double code_m) {
  phase_ = phase_cycles;
  rate_ = rate_hz;
  code_m_ = code_m;
  before_ = {};
  last_ = {phase_cycles, rate_hz, 0.0, code_m};
  amplitude_estimate_ = kFirstAmplitude;
  set_mode(LoopMode::kPullIn);
}

void TrackingLoops::set_mode(LoopMode mode) {
  mode_ = mode;
  acceleration_ = 0.0;
  cos_2x_ = 0.0;
  before_ = {};
  set_amplitude_estimate(amplitude_estimate_);
}

void TrackingLoops::set_amplitude_estimate(double amplitude) {
  amplitude_estimate_ = amplitude;
  const double bandwidth = mode_ == LoopMode::kPullIn ? kPullInCodeBandwidth_hz : code_bandwidth_hz_;
  code_gain_ = 4.0 * bandwidth * kUpdate_s / (2.0 * std::max(amplitude, kMinAmplitude)) * chip_m_;
}

TrackingLoops::Correlation TrackingLoops::correlate(const LoopInput& input, double x, double y,
                                                    NormalNoise& noise) const {
  const double spacing = mode_ == LoopMode::kPullIn ? kPullInSpacing_chips : spacing_;
  const double a = input.amplitude;
  const double correlation = a * std::max(0.0, 1.0 - std::abs(y));
  const double cosine = std::cos(x);
  Correlation now;
  now.i = correlation * cosine + noise();
  now.q = correlation * std::sin(x) + noise();
  // Beyond half the spacing the two correlators stand on one flank: the difference no longer grows.
  const double seen = std::abs(y) < 1.0 ? std::clamp(y, -spacing / 2.0, spacing / 2.0) : 0.0;
  now.early_minus_late = 2.0 * a * seen * cosine + std::sqrt(2.0 * spacing) * noise();
  return now;
}

void TrackingLoops::update_frequency(const Correlation& now) {
  const double cross = before_.i * now.q - before_.q * now.i;
  const double dot = before_.i * now.i + before_.q * now.q;
  const double error_hz = dot != 0.0 ? std::atan(cross / dot) / (kTwoPi * kUpdate_s) : 0.0;
  rate_ += kFrequencyGain * error_hz;
  correction_ = 0.0;
  before_ = now;
}

void TrackingLoops::update_phase(double dx_cycles) {
  acceleration_ += gain_acceleration_ * dx_cycles;
  rate_ += acceleration_ * kUpdate_s + gain_rate_ * dx_cycles;
  correction_ = gain_phase_ * dx_cycles;
}

void TrackingLoops::advance(const LoopInput& input, NormalNoise& noise, LoopSnapshot* snapshots,
                            BlockSeries& motion_m) {
  power_ = 0.0;
  const bool radiated = input.signal != nullptr;
  for (std::size_t k = 0; k < kUpdatesPerBlock; ++k) {
    const double s = static_cast<double>(k) * kUpdate_s;
    double error_cycles = 0.0;
    double y = 1.0;  // without a signal nothing correlates
    if (radiated) {
      const double oscillator_m = (*input.oscillator_m)[k];
      error_cycles = (input.signal->carrier_m.at(s) + oscillator_m) / wavelength_m_ - phase_;
      y = (input.signal->code_m.at(s) + oscillator_m - code_m_) / chip_m_;
    }
    const double x = kTwoPi * (error_cycles - std::nearbyint(error_cycles));
    const Correlation now = correlate(input, x, y, noise);
    const double power = square(now.i) + square(now.q);
    power_ += power;
    cos_2x_ += kLockMeanWeight * ((square(now.i) - square(now.q)) / power - cos_2x_);

    if (mode_ == LoopMode::kPullIn) {
      update_frequency(now);
    } else {
      update_phase(std::atan(now.q / now.i) / kTwoPi);
    }
    // The sign of I holds the data bit and half cycles.
    code_m_ += code_gain_ * std::copysign(1.0, now.i) * now.early_minus_late;
    phase_error_cycles_ = error_cycles - correction_;
    last_ = {phase_ + correction_, rate_, acceleration_, code_m_};
    if (((input.snapshots >> k) & 1U) != 0) snapshots[k] = last_;

    const double step = correction_ + rate_ * kUpdate_s + acceleration_ * kUpdate_s * kUpdate_s / 2.0;
    phase_ += step;
    motion_m[k] = step * wavelength_m_;
    code_m_ += input.aiding_m != nullptr ? (*input.aiding_m)[k] : motion_m[k];
  }
}

}  // namespace vbar::grand::bench
