#include "emulators/grand/samples/baseband.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "emulators/grand/samples/l1_ca_signal.h"
#include "tests/support/gnss_scene.h"

namespace vbar::grand::bench {

namespace {

using twins::gnss::SatelliteId;
using twins::gnss::Signal;
using twins::gnss::System;
using Complex = std::complex<double>;

constexpr double kSpeedOfLight = 299792458.0;
constexpr double kWavelength_m = kSpeedOfLight / 1575.42e6;
constexpr std::int64_t kStart_ms = test::kGnssStart.ns / 1'000'000;

// A low orbit's motion against a satellite: 7 km/s, 8 m/s^2; the code is delayed and the carrier advanced.
RfSignal signal(int prn, double range_m, double rate_mps, double cn0_dbhz) {
  RfSignal signal;
  signal.satellite = {System::kGps, prn};
  signal.carrier_m.coefficients = {range_m - 6.1, rate_mps, 4.0, -0.003, 1e-5, 0.0};
  signal.code_m.coefficients = {range_m + 9.7, rate_mps, 4.0, -0.003, 1e-5, 0.0};
  signal.cn0_dbhz = cn0_dbhz;
  return signal;
}

RfBlock block_of(std::vector<RfSignal> signals, int number = 0) {
  return {.begin = {(kStart_ms + 100 * number) * 1'000'000}, .snapped = false, .signals = std::move(signals)};
}

// The mean of the samples against the signal of an ideal correlator, displaced by `chips`. Directly from the
// definition: what is received at s was transmitted at s - code_m(s)/c with the carrier's phase -carrier_m(s)/lambda.
Complex correlation(std::span<const std::int8_t> samples, const RfSignal& signal, LnavBits& messages,
                    std::int64_t begin_ms, double rate_hz, double from_s, double until_s, double chips = 0.0) {
  const auto first = static_cast<std::size_t>(std::lround(from_s * rate_hz));
  const auto last = static_cast<std::size_t>(std::lround(until_s * rate_hz));
  Complex sum = 0.0;
  for (std::size_t k = first; k < last; ++k) {
    const double s = static_cast<double>(k) / rate_hz;
    const double transmitted_ms = 1e3 * (s - signal.code_m.at(s) / kSpeedOfLight) + chips / 1023.0;
    const double ms = std::floor(transmitted_ms);
    const auto chip = static_cast<std::size_t>((transmitted_ms - ms) * 1023.0);
    const bool one = ca_code(signal.satellite.prn)[std::min<std::size_t>(chip, 1022)] != 0;
    const bool bit = messages.bit(signal.satellite, begin_ms + static_cast<std::int64_t>(ms));
    const double phase = -2.0 * std::numbers::pi * std::fmod(signal.carrier_m.at(s) / kWavelength_m, 1.0);
    const Complex sample(samples[2 * k], samples[2 * k + 1]);
    sum += sample * std::polar(one != bit ? -1.0 : 1.0, -phase);
  }
  return sum / static_cast<double>(last - first);
}

// Amplitude in units of the noise: C/N0 = A^2 rate / 2.
double amplitude(double cn0_dbhz, double rate_hz) {
  return std::sqrt(2.0 * std::pow(10.0, cn0_dbhz / 10.0) / rate_hz);
}

// A signal far above quantisation, without noise: the phase of every millisecond. What is left is the quantisation of
// phase and amplitude (2048 phases, 8 bits) of 2600 samples.
TEST(Baseband, CarrierPhaseIsMinusTheRangeInEveryMillisecond) {
  const auto constellation = test::constellation(1);
  Baseband baseband({.noise = false}, constellation, 1, "servicer");
  LnavBits messages(constellation);
  for (const double rate_mps : {-6500.0, 900.0, 6900.0}) {
    const RfSignal only = signal(7, 2.31e7, rate_mps, 70.0);
    const auto samples = baseband.samples(block_of({only}));
    for (int ms = 0; ms < 100; ++ms) {
      const Complex mean = correlation(samples, only, messages, kStart_ms, 2.6e6, 1e-3 * ms, 1e-3 * (ms + 1));
      EXPECT_NEAR(std::arg(mean), 0.0, 5e-4) << "ms " << ms;  // 15 um
      EXPECT_NEAR(std::abs(mean), 20.0 * amplitude(70.0, 2.6e6), 0.1) << "ms " << ms;
    }
  }
}

// Early minus late half a chip apart: 0.75 (E-L)/(E+L) chips of delay. 260000 samples place the chips' edges to
// 1/260000 of a chip where their phases are evenly spread, as they are with a Doppler.
TEST(Baseband, CodeDelayIsTheCodeRange) {
  const auto constellation = test::constellation(1);
  Baseband baseband({.noise = false}, constellation, 1, "servicer");
  LnavBits messages(constellation);
  const RfSignal only = signal(11, 2.31e7, 3000.0, 70.0);
  const auto samples = baseband.samples(block_of({only}));
  const double early = std::abs(correlation(samples, only, messages, kStart_ms, 2.6e6, 0.0, 0.1, 0.25));
  const double late = std::abs(correlation(samples, only, messages, kStart_ms, 2.6e6, 0.0, 0.1, -0.25));
  const double delay_chips = 0.75 * (late - early) / (late + early);
  EXPECT_NEAR(delay_chips * kSpeedOfLight / 1.023e6, 0.0, 0.1);
}

struct Correlations {
  Complex prompt, early, late;
};

// Three satellites in noise, correlated over 0.4 s: phase to 1/sqrt(2 C/N0 T), which is 7 mrad at 44 dB-Hz, and
// amplitude to the same fraction; four of these sigmas, and as much again for the other satellites' codes.
TEST(Baseband, CorrelationInNoiseRecoversPhaseDelayAndPower) {
  const auto constellation = test::constellation(1);
  Baseband baseband({}, constellation, 3, "target");
  LnavBits messages(constellation);
  const std::vector<RfSignal> signals{signal(3, 2.1e7, 5000.0, 46.0), signal(19, 2.4e7, -1500.0, 44.0),
                                      signal(22, 2.5e7, 100.0, 48.0)};
  std::vector<Correlations> found(signals.size());
  constexpr int kBlocks = 4;
  for (int number = 0; number < kBlocks; ++number) {
    // The motion begins again in every block: the phase then differs, but is that of the block's own quintic.
    const auto samples = baseband.samples(block_of(signals, number));
    for (std::size_t k = 0; k < signals.size(); ++k) {
      const auto mean = [&](double chips) {
        return correlation(samples, signals[k], messages, kStart_ms + 100 * number, 2.6e6, 0.0, 0.1, chips) /
               static_cast<double>(kBlocks);
      };
      found[k].prompt += mean(0.0);
      found[k].early += mean(0.25);
      found[k].late += mean(-0.25);
    }
  }
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const double cn0_hz = std::pow(10.0, signals[k].cn0_dbhz / 10.0);
    const double sigma = 1.0 / std::sqrt(2.0 * cn0_hz * 0.1 * kBlocks);
    EXPECT_NEAR(std::arg(found[k].prompt), 0.0, 8.0 * sigma);
    EXPECT_NEAR(std::abs(found[k].prompt) / 20.0 / amplitude(signals[k].cn0_dbhz, 2.6e6), 1.0, 8.0 * sigma);
    const double early = found[k].early.real();
    const double late = found[k].late.real();
    // E and L are half a chip apart, so half their noise is common: sigma of (E-L)/(2A) is sqrt(1/2) sigma.
    EXPECT_NEAR(0.75 * (late - early) / (late + early), 0.0, 8.0 * sigma * std::sqrt(0.5));
  }
}

TEST(Baseband, NoiseIsWhiteWithUnitVariance) {
  Baseband baseband({}, test::constellation(1), 3, "target");
  const auto samples = baseband.samples(block_of({}));
  const auto count = static_cast<double>(samples.size());
  double sum = 0.0, squares = 0.0, quadrature = 0.0, next = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    sum += samples[k];
    squares += samples[k] * samples[k];
    if (k % 2 == 0) quadrature += 2.0 * samples[k] * samples[k + 1];
    if (k + 2 < samples.size()) next += samples[k] * samples[k + 2];
  }
  // Four sigmas of the mean, the variance and the correlations of 520000 normal numbers; rounding to whole numbers adds
  // 1/12 to the variance.
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 20.0 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 400.0 + 1.0 / 12.0, 4.0 * 400.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(quadrature / count, 0.0, 4.0 * 400.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(next / count, 0.0, 4.0 * 400.0 / std::sqrt(count));
}

TEST(Baseband, ABlockDependsOnNoOtherBlock) {
  const auto constellation = test::constellation(1);
  Baseband first({}, constellation, 3, "target");
  Baseband second({}, constellation, 3, "target");
  Baseband other({}, constellation, 3, "servicer");
  const RfSignal only = signal(7, 2.31e7, 1000.0, 45.0);
  first.samples(block_of({only}, 0));
  const auto a = first.samples(block_of({only}, 1));
  const auto b = second.samples(block_of({only}, 1));
  const auto c = other.samples(block_of({only}, 1));
  EXPECT_TRUE(std::ranges::equal(a, b));
  EXPECT_FALSE(std::ranges::equal(a, c));
}

TEST(Baseband, OtherRatesAndOtherSignals) {
  const auto constellation = test::constellation(1);
  Baseband baseband({.rate_hz = 4'001'000, .noise = false}, constellation, 1, "servicer");
  LnavBits messages(constellation);
  const RfSignal only = signal(7, 2.31e7, -2000.0, 70.0);
  RfSignal l2 = signal(7, 2.31e7, -2000.0, 70.0);
  l2.signal = Signal::kGpsL2;
  const auto samples = baseband.samples(block_of({only, l2}));
  ASSERT_EQ(samples.size(), 2U * 400'100U);
  const Complex mean = correlation(samples, only, messages, kStart_ms, 4.001e6, 0.0, 0.1);
  EXPECT_NEAR(std::arg(mean), 0.0, 1e-4);
  EXPECT_NEAR(std::abs(mean), 20.0 * amplitude(70.0, 4.001e6), 0.1);
}

TEST(Baseband, InvalidSettingsAndBlocksAreRefused) {
  const auto constellation = test::constellation(1);
  for (const BasebandSettings& settings :
       {BasebandSettings{.rate_hz = 2'600'500}, BasebandSettings{.rate_hz = 1'000'000},
        BasebandSettings{.rate_hz = 60'000'000}, BasebandSettings{.noise_lsb = 0.0},
        BasebandSettings{.noise_lsb = std::nan("")}})
    EXPECT_THROW(Baseband(settings, constellation, 1, "servicer"), std::invalid_argument);
  Baseband baseband({}, constellation, 1, "servicer");
  RfBlock between = block_of({});
  between.begin.ns += 1;
  EXPECT_THROW(baseband.samples(between), std::invalid_argument);
  EXPECT_THROW(baseband.samples(block_of({signal(40, 2.3e7, 0.0, 45.0)})), std::out_of_range);
}

}  // namespace

namespace {

// IS-GPS-200N table 3-Ia, column "first 10 chips octal, C/A".
constexpr std::array<int, kCaCodes> kFirstTenChips{
    01440, 01620, 01710, 01744, 01133, 01455, 01131, 01454, 01626, 01504, 01642, 01750, 01764, 01772, 01775, 01776,
    01156, 01467, 01633, 01715, 01746, 01763, 01063, 01706, 01743, 01761, 01770, 01774, 01127, 01453, 01625, 01712};

TEST(CaCode, FirstTenChipsOfTheInterfaceSpecification) {
  for (int prn = 1; prn <= kCaCodes; ++prn) {
    int chips = 0;
    for (std::size_t k = 0; k < 10; ++k) chips = 2 * chips + ca_code(prn)[k];
    EXPECT_EQ(chips, kFirstTenChips[static_cast<std::size_t>(prn - 1)]) << "PRN " << prn;
  }
}

int correlation(const CaCode& a, const CaCode& b, std::size_t shift) {
  int sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] == b[(k + shift) % b.size()] ? 1 : -1;
  return sum;
}

// Gold (1967): the correlations of a set of length 1023 have three values away from the peak, for codes of one set.
TEST(CaCode, CorrelationsAreThoseOfGoldCodes) {
  for (const int prn : {1, 13, 32})
    for (std::size_t shift = 0; shift < kCaCodeChips; ++shift) {
      const int own = correlation(ca_code(prn), ca_code(prn), shift);
      const int other = correlation(ca_code(prn), ca_code(7), shift);
      if (shift == 0) {
        EXPECT_EQ(own, 1023);
      } else {
        EXPECT_TRUE(own == -1 || own == 63 || own == -65) << prn << ": " << own;
      }
      EXPECT_TRUE(other == -1 || other == 63 || other == -65) << prn << ": " << other;
    }
}

TEST(CaCode, UnknownNumbersAreRefused) {
  for (const int prn : {0, 33, -1, 193}) EXPECT_THROW(ca_code(prn), std::out_of_range) << prn;
}

}  // namespace

namespace {

using twins::gnss::Subframe;

constexpr SatelliteId kSatellite{System::kGps, 7};

// A receiver's view: words whose predecessor ends with D30 = 1 are inverted; the six bits of parity are left out.
Subframe received(LnavBits& bits, std::int64_t begin_ms) {
  Subframe subframe{};
  bool invert = false;
  for (std::size_t word = 0; word < 10; ++word) {
    bool last = false;
    for (std::size_t k = 0; k < 30; ++k) {
      const auto number = static_cast<std::int64_t>(30 * word + k);
      last = bits.bit(kSatellite, begin_ms + number * LnavBits::kBit_ms + 7);
      if (k < 24 && last != invert)
        subframe[3 * word + k / 8] = static_cast<std::uint8_t>(subframe[3 * word + k / 8] | 0x80U >> (k % 8));
    }
    invert = last;
  }
  for (const std::size_t byte : {5U, 29U}) subframe[byte] &= 0xFCU;  // solved for parity
  return subframe;
}

TEST(LnavBits, AFrameHasTheBroadcastSetAndPageEighteen) {
  const auto constellation = test::constellation(1);
  LnavBits bits(constellation);
  std::size_t index = 0;
  while (constellation->id(index) != kSatellite) ++index;
  const twins::gnss::BroadcastSet set = constellation->broadcast_set(index, test::kGnssStart);
  const auto sent = lnav_subframes(set.ephemeris, set.issue, test::kGnssStart);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(received(bits, kStart_ms + static_cast<std::int64_t>(k) * 6000), sent[k]) << "subframe " << k + 1;
  const Subframe fourth = received(bits, kStart_ms + 18000);
  EXPECT_EQ(fourth[0], 0x8B);
  EXPECT_EQ(fourth[6], 0x40 + 56);                        // data identification 01, page 18
  EXPECT_EQ(received(bits, kStart_ms + 24000)[6], 0x40);  // dummy satellite
}

TEST(LnavBits, TimesOfAnyOrderGiveTheSameBits) {
  LnavBits forward(test::constellation(1));
  LnavBits backward(test::constellation(1));
  std::vector<bool> bits;
  for (std::int64_t t = 0; t < 40000; t += 20) bits.push_back(forward.bit(kSatellite, kStart_ms + t));
  for (std::int64_t t = 39980; t >= 0; t -= 20)
    ASSERT_EQ(backward.bit(kSatellite, kStart_ms + t), bits[static_cast<std::size_t>(t / 20)]) << t;
}

TEST(LnavBits, UnknownSatellitesAreRefused) {
  LnavBits bits(test::constellation(1));
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGalileo, 11}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGps, 0}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGps, 77}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(LnavBits(nullptr), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::grand::bench
