#include "emulators/grand/samples/baseband.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "emulators/grand/samples/l1_ca_signal.h"
#include "fsw/gnss/constants.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {
namespace {

constexpr std::int64_t kBlock_ms = RfBlock::kLength.ns / 1'000'000;
constexpr double kPeriod_ms = 1.0;  // period of the C/A code

// Sums are kept with this number of units to one standard deviation of the noise: 11 signals of 50 dB-Hz and 5 sigma of
// noise stay below 2^15.
constexpr double kUnitsPerSigma = 1024.0;

constexpr unsigned kPhaseIndexBits = 11;
constexpr std::size_t kPhases = std::size_t{1} << kPhaseIndexBits;
constexpr unsigned kPhaseShift = 64 - kPhaseIndexBits;
constexpr std::uint16_t kHalfCycle = kPhases / 2;  // added to the index by an exclusive or

// Code phase: chips in units of 2^-52.
constexpr unsigned kChipShift = 52;
constexpr double kChipUnit = 0x1p52;
constexpr std::uint64_t kCodeEnd = std::uint64_t{kCaCodeChips} << kChipShift;

constexpr unsigned kNoiseIndexBits = 12;
constexpr std::size_t kNoiseLevels = std::size_t{1} << kNoiseIndexBits;

// I in the upper, Q in the lower half: one addition adds both (a negative Q borrows from I, which unpacking returns).
std::uint32_t packed(double i, double q) {
  return static_cast<std::uint32_t>(std::lround(i)) * 65536U + static_cast<std::uint32_t>(std::lround(q));
}

std::int32_t lower(std::uint32_t sum) {
  return static_cast<std::int16_t>(sum & 0xFFFFU);
}
std::int32_t upper(std::uint32_t sum) {
  return static_cast<std::int16_t>((sum - static_cast<std::uint32_t>(lower(sum))) >> 16U);
}

// Fraction of a number of cycles, in units of 2^-64 cycles.
std::uint64_t cycle_fraction(double cycles) {
  const double fraction = cycles - std::floor(cycles);
  return fraction < 1.0 ? static_cast<std::uint64_t>(fraction * 0x1p64) : 0;
}

}  // namespace

struct Baseband::Tables {
  std::array<std::array<std::uint16_t, kCaCodeChips>, kCaCodes> half_cycles{};  ///< half cycle of each chip
  std::array<double, kPhases> cosine{};
  std::array<std::int32_t, kNoiseLevels> noise{};  ///< quantiles, in units of the sums
  std::array<std::uint32_t, kPhases> carrier{};    ///< carrier of the signal being added

  Tables() {
    for (int prn = 1; prn <= kCaCodes; ++prn)
      std::ranges::transform(ca_code(prn), half_cycles[static_cast<std::size_t>(prn - 1)].begin(),
                             [](std::uint8_t chip) { return chip != 0 ? kHalfCycle : std::uint16_t{0}; });
    for (std::size_t k = 0; k < kPhases; ++k)
      cosine[k] = std::cos(2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(kPhases));
    fill_noise();
  }

  void fill_noise() {
    std::vector<double> quantiles(kNoiseLevels);
    double sum_of_squares = 0.0;
    for (std::size_t k = 0; k < kNoiseLevels; ++k) {
      quantiles[k] = engine::normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(kNoiseLevels));
      sum_of_squares += quantiles[k] * quantiles[k];
    }
    // The quantiles leave out the tails: to unit variance.
    const double scale = kUnitsPerSigma / std::sqrt(sum_of_squares / static_cast<double>(kNoiseLevels));
    for (std::size_t k = 0; k < kNoiseLevels; ++k)
      noise[k] = static_cast<std::int32_t>(std::lround(scale * quantiles[k]));
  }

  void fill_carrier(double amplitude_units) {
    for (std::size_t k = 0; k < kPhases; ++k)
      carrier[k] = packed(amplitude_units * cosine[k], amplitude_units * cosine[(k + kPhases - kPhases / 4) % kPhases]);
  }
};

// One signal during a millisecond.
struct Baseband::Chunk {
  const std::array<std::uint16_t, kCaCodeChips>* half_cycles = nullptr;
  std::size_t first = 0;    ///< sample of the block
  std::uint64_t phase = 0;  ///< phase of the carrier at the first sample, 2^-64 cycles
  std::uint64_t phase_step = 0;
  std::uint64_t code = 0;  ///< chips since the period began, 2^-52
  std::uint64_t code_step = 0;
  std::array<bool, 3> bits{};  ///< message bits in the code's period at the first sample and in the next two
};

void check(const BasebandSettings& settings) {
  constexpr std::int64_t kMin_hz = 2'046'000;  // main lobe of the C/A code
  constexpr std::int64_t kMax_hz = 50'000'000;
  if (settings.rate_hz < kMin_hz || settings.rate_hz > kMax_hz || settings.rate_hz % 1000 != 0)
    throw std::invalid_argument(fmt::format("samples: rate_hz is {}; accepted are multiples of 1000 from {} to {}",
                                            settings.rate_hz, kMin_hz, kMax_hz));
  if (!(settings.noise_lsb >= 1.0 && settings.noise_lsb <= 40.0))
    throw std::invalid_argument(fmt::format("samples: noise_lsb is {}; accepted is 1 to 40", settings.noise_lsb));
}

Baseband::Baseband(const BasebandSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                   std::uint64_t seed, const std::string& name)
    : settings_((check(settings), settings)),
      messages_(std::move(constellation)),
      noise_(seed, "grand/samples/" + name),
      tables_(std::make_unique<Tables>()),
      samples_per_ms_(static_cast<std::size_t>(settings.rate_hz / 1000)),
      sums_(samples_per_ms_ * kBlock_ms),
      output_(2 * sums_.size()) {}

Baseband::~Baseband() = default;

std::span<const std::int8_t> Baseband::samples(const RfBlock& block) {
  if (block.begin.ns < 0 || block.begin.ns % 1'000'000 != 0)
    throw std::invalid_argument(fmt::format("samples: a block begins at {} ns, not at a whole ms", block.begin.ns));
  const std::int64_t begin_ms = block.begin.ns / 1'000'000;
  std::ranges::fill(sums_, 0U);
  for (const RfSignal& signal : block.signals)
    if (signal.signal == twins::gnss::Signal::kGpsL1) add_signal(signal, begin_ms);
  add_noise_and_quantise(begin_ms);
  return output_;
}

void Baseband::add_signal(const RfSignal& signal, std::int64_t begin_ms) {
  using fsw::gnss::kSpeedOfLight;
  // Power of the carrier A^2, of the noise 2 (I and Q) in a bandwidth of the sampling rate.
  const double cn0_hz = std::pow(10.0, 0.1 * signal.cn0_dbhz);
  tables_->fill_carrier(kUnitsPerSigma * std::sqrt(2.0 * cn0_hz / static_cast<double>(settings_.rate_hz)));
  ca_code(signal.satellite.prn);  // throws for a number without a code
  const auto cycles_at = [&](double s) { return -signal.carrier_m.at(s) / wavelength_m(signal.signal); };
  // Periods of the code (ms of the satellite's time) since the beginning of the block.
  const auto periods_at = [&](double s) { return 1e3 * (s - signal.code_m.at(s) / kSpeedOfLight) / kPeriod_ms; };
  const auto count = static_cast<double>(samples_per_ms_);

  Chunk chunk;
  chunk.half_cycles = &tables_->half_cycles[static_cast<std::size_t>(signal.satellite.prn - 1)];
  double cycles = cycles_at(0.0);
  double periods = periods_at(0.0);
  for (std::int64_t ms = 0; ms < kBlock_ms; ++ms) {
    const double end_s = 1e-3 * static_cast<double>(ms + 1);
    const double next_cycles = cycles_at(end_s);
    const double next_periods = periods_at(end_s);
    chunk.phase = cycle_fraction(cycles);
    chunk.phase_step = static_cast<std::uint64_t>(std::llround((next_cycles - cycles) / count * 0x1p64));
    const double period = std::floor(periods);
    chunk.code = static_cast<std::uint64_t>(
        std::min((periods - period) * kCaCodeChips * kChipUnit, static_cast<double>(kCodeEnd - 1)));
    chunk.code_step = static_cast<std::uint64_t>((next_periods - periods) * kCaCodeChips / count * kChipUnit);
    for (std::size_t k = 0; k < chunk.bits.size(); ++k)
      chunk.bits[k] =
          messages_.bit(signal.satellite, begin_ms + static_cast<std::int64_t>(period) + static_cast<std::int64_t>(k));
    add_chunk(chunk);
    chunk.first += samples_per_ms_;
    cycles = next_cycles;
    periods = next_periods;
  }
}

void Baseband::add_chunk(const Chunk& chunk) {
  const std::uint32_t* const carrier = tables_->carrier.data();
  const std::uint16_t* const half_cycles = chunk.half_cycles->data();
  std::uint32_t* const sums = sums_.data() + chunk.first;
  std::uint64_t phase = chunk.phase;
  std::uint64_t code = chunk.code;
  std::size_t k = 0;
  for (const bool bit : chunk.bits) {
    const std::uint16_t message = bit ? kHalfCycle : 0;
    // Samples until the code's period ends.
    const std::size_t left = (kCodeEnd - code + chunk.code_step - 1) / chunk.code_step;
    const std::size_t end = std::min(samples_per_ms_, k + left);
    for (; k < end; ++k) {
      sums[k] += carrier[(phase >> kPhaseShift) ^ half_cycles[code >> kChipShift] ^ message];
      phase += chunk.phase_step;
      code += chunk.code_step;
    }
    if (k == samples_per_ms_) return;
    code -= kCodeEnd;
  }
}

void Baseband::add_noise_and_quantise(std::int64_t begin_ms) {
  constexpr unsigned kShift = 16;
  const auto scale =
      static_cast<std::int32_t>(std::lround(settings_.noise_lsb / kUnitsPerSigma * static_cast<double>(1U << kShift)));
  const auto quantised = [scale](std::int32_t value) {
    constexpr std::int32_t kHalf = 1 << (kShift - 1);
    return static_cast<std::int8_t>(std::clamp((value * scale + kHalf) >> kShift, -127, 127));
  };
  // 64 random bits serve two samples.
  noise_.seek(static_cast<std::uint64_t>(begin_ms) * ((samples_per_ms_ + 1) / 2));
  const std::array<std::int32_t, kNoiseLevels>& level = tables_->noise;
  constexpr std::uint64_t kMask = kNoiseLevels - 1;
  std::uint64_t random = 0;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    std::int32_t i = upper(sums_[k]);
    std::int32_t q = lower(sums_[k]);
    if (settings_.noise) {
      random = k % 2 == 0 ? noise_.bits() : random >> 32U;
      i += level[random & kMask];
      q += level[random >> 16U & kMask];
    }
    output_[2 * k] = quantised(i);
    output_[2 * k + 1] = quantised(q);
  }
}

}  // namespace vbar::grand::bench
