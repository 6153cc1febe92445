#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "emulators/grand/samples/gnss_sdr_observables.h"

namespace vbar::grand::bench {

namespace {

using Bytes = std::vector<std::uint8_t>;

// Fields by the encoding rules of Protocol Buffers (protobuf.dev, "Encoding").
void varint(Bytes& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7U) out.push_back(static_cast<std::uint8_t>(value | 0x80U));
  out.push_back(static_cast<std::uint8_t>(value));
}
void number(Bytes& out, unsigned tag, std::uint64_t value) {
  varint(out, tag << 3U);
  varint(out, value);
}
void real(Bytes& out, unsigned tag, double value) {
  varint(out, tag << 3U | 1U);
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (unsigned k = 0; k < 64; k += 8) out.push_back(static_cast<std::uint8_t>(bits >> k));
}
void bytes(Bytes& out, unsigned tag, std::span<const std::uint8_t> value) {
  varint(out, tag << 3U | 2U);
  varint(out, value.size());
  out.insert(out.end(), value.begin(), value.end());
}
void text(Bytes& out, unsigned tag, const std::string& value) {
  bytes(out, tag, {reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
}

struct Sent {
  std::string system = "G", signal = "1C";
  std::uint64_t prn = 6;
  double pseudorange_m = 21097944.542;
  double carrier_rad = 2376076.3107;
  double rx_time_s = 230459.8;
};

Bytes observable(const Sent& sent) {
  Bytes inner;
  text(inner, 1, sent.system);
  text(inner, 2, sent.signal);
  number(inner, 3, sent.prn);
  number(inner, 4, 7);
  number(inner, 10, 2'600'000);
  real(inner, 13, 45.39);
  real(inner, 14, -9309.98);
  real(inner, 15, sent.carrier_rad);
  number(inner, 17, 155454975);
  real(inner, 22, sent.pseudorange_m);
  real(inner, 23, sent.rx_time_s);
  number(inner, 24, 1);
  Bytes out;
  bytes(out, 1, inner);
  return out;
}

TEST(MonitorDatagrams, ObservableHasTheFieldsOfGnssSynchro) {
  const auto read = read_observables(observable({}));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 1U);
  const Observable& o = read->front();
  EXPECT_EQ(o.channel, 7);
  EXPECT_EQ(o.prn, 6);
  EXPECT_TRUE(o.valid);
  EXPECT_EQ(o.pseudorange_m, 21097944.542);
  EXPECT_DOUBLE_EQ(o.carrier_phase_cycles, 2376076.3107 / (2.0 * std::numbers::pi));
  EXPECT_EQ(o.doppler_hz, -9309.98);
  EXPECT_EQ(o.cn0_dbhz, 45.39);
  EXPECT_EQ(o.rx_time_s, 230459.8);
}

// A datagram of gnss-sdr 0.0.17 for a channel without a satellite: fields that are zero are not sent.
TEST(MonitorDatagrams, ChannelWithoutSatelliteHasOnlyTheTime) {
  Bytes inner;
  real(inner, 23, 230412.1);
  Bytes datagram;
  bytes(datagram, 1, inner);
  const auto read = read_observables(datagram);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 1U);
  EXPECT_FALSE(read->front().valid);
  EXPECT_EQ(read->front().prn, 0);
}

TEST(MonitorDatagrams, OtherSignalsAreLeftOut) {
  const auto read = read_observables(observable({.system = "E", .signal = "1B"}));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->empty());
}

TEST(MonitorDatagrams, ImplausibleNumbersAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Sent& sent : {Sent{.prn = 0}, Sent{.prn = 33}, Sent{.pseudorange_m = kNan}, Sent{.pseudorange_m = -1.0},
                           Sent{.carrier_rad = kInfinity}, Sent{.rx_time_s = kNan}, Sent{.rx_time_s = 604801.0}})
    EXPECT_FALSE(read_observables(observable(sent)));
}

TEST(MonitorDatagrams, EveryTruncationIsRefused) {
  const Bytes whole = observable({});
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_FALSE(read_observables(std::span(whole).first(size))) << size;
}

TEST(MonitorDatagrams, TooManyObservablesAreRefused) {
  Bytes datagram;
  for (int k = 0; k < 65; ++k) {
    const Bytes one = observable({});
    datagram.insert(datagram.end(), one.begin(), one.end());
  }
  EXPECT_FALSE(read_observables(datagram));
}

// Sent by gnss-sdr 0.0.17 for PRN 32 with samples of the test orbit: subframe 5 of a frame without content.
constexpr const char* kBits =
    "100010110000000000000000010010010010110000000100001010011000110101000000000101110101100100001100111111111001010000"
    "011111001101111001100111111000000011000000010011100000000110101000001110110101110100001110110001000100000011011010"
    "100001001110000011000101001110111101100110001110100000001000000000100100";

TEST(MonitorDatagrams, SubframeHasItsTenWords) {
  Bytes datagram;
  text(datagram, 1, "G");
  text(datagram, 2, "1C");
  number(datagram, 3, 32);
  number(datagram, 4, 230412000);
  text(datagram, 5, kBits);
  const auto read = read_subframe(datagram);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->prn, 32);
  EXPECT_EQ(read->tow_ms, 230412000);
  EXPECT_EQ(read->words[0] >> 22U, 0x8BU);           // preamble
  EXPECT_EQ((read->words[1] >> 13U) * 6U, 230412U);  // time of week in the handover word
}

TEST(MonitorDatagrams, SubframesOfAnotherLengthOrContentAreRefused) {
  for (const std::string& bits : {std::string(kBits).substr(1), std::string(kBits).append("0"),
                                  std::string("2").append(kBits + 1), std::string()}) {
    Bytes datagram;
    number(datagram, 3, 32);
    text(datagram, 5, bits);
    EXPECT_FALSE(read_subframe(datagram));
  }
}

}  // namespace

namespace {

constexpr double kWavelength_m = 299792458.0 / 1575.42e6;

Observable observable(int channel, int prn, double rx_time_s) {
  return {.channel = channel,
          .prn = prn,
          .rx_time_s = rx_time_s,
          .valid = prn != 0,
          .pseudorange_m = 2.1e7,
          .carrier_phase_cycles = 1000.25,
          .doppler_hz = 0.0,
          .cn0_dbhz = 45.0};
}

TEST(ObservableEpochs, AnEpochIsCompleteWithAllChannels) {
  ObservableEpochs epochs(3, 100);
  epochs.take(observable(1, 19, 1000.0));
  epochs.take(observable(0, 6, 1000.0));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(2, 0, 1000.0));
  const auto epoch = epochs.next();
  ASSERT_TRUE(epoch);
  EXPECT_EQ(epoch->rx_time_ms, 1'000'000);
  ASSERT_EQ(epoch->satellites.size(), 2U);
  EXPECT_EQ(epoch->satellites[0].observable.prn, 6);
  EXPECT_EQ(epoch->satellites[1].observable.prn, 19);
}

// The fraction of the phase is kept; the whole cycles added make it the pseudorange's to half a cycle.
TEST(ObservableEpochs, PhaseIsNearThePseudorangeByWholeCycles) {
  ObservableEpochs epochs(1, 100);
  epochs.take(observable(0, 6, 1000.0));
  const auto epoch = epochs.next();
  ASSERT_TRUE(epoch);
  const double cycles = epoch->satellites[0].carrier_phase_cycles;
  EXPECT_NEAR(cycles, 2.1e7 / kWavelength_m, 0.5);
  EXPECT_NEAR(cycles - std::floor(cycles), 0.25, 1e-7);
}

TEST(ObservableEpochs, ALostDatagramDelaysItsEpochByHalfASecond) {
  ObservableEpochs epochs(2, 100);
  epochs.take(observable(0, 6, 1000.0));
  for (int k = 1; k < 5; ++k) {
    epochs.take(observable(0, 6, 1000.0 + 0.1 * k));
    epochs.take(observable(1, 19, 1000.0 + 0.1 * k));
    EXPECT_FALSE(epochs.next()) << k;
  }
  epochs.take(observable(0, 6, 1000.5));
  for (int k = 0; k < 5; ++k) {
    const auto epoch = epochs.next();
    ASSERT_TRUE(epoch) << k;
    EXPECT_EQ(epoch->rx_time_ms, 1'000'000 + 100 * k);
  }
}

TEST(ObservableEpochs, LockTimeRestartsAfterAGapAndOnAnotherChannel) {
  ObservableEpochs epochs(1, 100);
  const auto locked_since = [&epochs](int channel, double rx_time_s) {
    epochs.take(observable(channel, 6, rx_time_s));
    return epochs.next()->satellites[0].locked_ms;
  };
  EXPECT_EQ(locked_since(0, 1000.0), 1'000'000);
  EXPECT_EQ(locked_since(0, 1000.1), 1'000'000);
  EXPECT_EQ(locked_since(0, 1000.3), 1'000'300);
  EXPECT_EQ(locked_since(3, 1000.4), 1'000'400);
}

TEST(ObservableEpochs, LateAndUnsetTimesAreIgnoredAndAWeekBegins) {
  ObservableEpochs epochs(1, 100);
  epochs.take(observable(0, 6, 0.0));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(0, 6, 604799.9));
  EXPECT_TRUE(epochs.next());
  epochs.take(observable(0, 6, 604799.8));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(0, 6, 0.1));
  ASSERT_TRUE(epochs.next());
}

}  // namespace

}  // namespace vbar::grand::bench
