#include "emulators/grand/samples/gnss_sdr_observables.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "emulators/grand/samples/l1_ca_signal.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::grand::bench {

std::optional<std::uint64_t> ProtobufReader::varint() {
  constexpr std::size_t kMaxBytes = 10;
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < kMaxBytes && k < rest_.size(); ++k) {
    value |= static_cast<std::uint64_t>(rest_[k] & 0x7FU) << (7U * k);
    if ((rest_[k] & 0x80U) != 0) continue;
    rest_ = rest_.subspan(k + 1);
    return value;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> ProtobufReader::fixed(std::size_t count) {
  if (rest_.size() < count) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < count; ++k) value |= static_cast<std::uint64_t>(rest_[k]) << (8U * k);
  rest_ = rest_.subspan(count);
  return value;
}

std::optional<ProtobufReader::Field> ProtobufReader::next() {
  if (malformed_ || rest_.empty()) return std::nullopt;
  malformed_ = true;  // until the field is complete
  const std::optional<std::uint64_t> key = varint();
  if (!key) return std::nullopt;
  Field field;
  field.tag = *key >> 3U;
  field.type = static_cast<Field::Type>(*key & 7U);
  std::optional<std::uint64_t> number;
  switch (field.type) {
    case Field::Type::kVarint:
    case Field::Type::kBytes:
      number = varint();
      break;
    case Field::Type::kFixed64:
      number = fixed(8);
      break;
    case Field::Type::kFixed32:
      number = fixed(4);
      break;
  }
  if (!number) return std::nullopt;
  field.number = *number;
  if (field.type == Field::Type::kBytes) {
    if (*number > rest_.size()) return std::nullopt;
    field.bytes = rest_.first(static_cast<std::size_t>(*number));
    rest_ = rest_.subspan(field.bytes.size());
  }
  malformed_ = false;
  return field;
}

namespace {

constexpr std::size_t kMaxObservables = 64;
constexpr std::size_t kSubframeBits = 300;
constexpr std::string_view kGps = "G";
constexpr std::string_view kL1CodeCa = "1C";
constexpr double kSecondsPerWeek = 604800.0;

bool is(std::span<const std::uint8_t> bytes, std::string_view text) {
  return std::ranges::equal(bytes, text, {}, [](std::uint8_t byte) { return static_cast<char>(byte); });
}

bool within(double value, double low, double high) {
  return value >= low && value <= high;  // false for NaN
}

struct ReadObservable {
  Observable observable;
  bool gps_l1 = true;  ///< an empty field is left out of the message
  bool plausible = true;
};

void take(ReadObservable& read, const ProtobufReader::Field& field) {
  Observable& o = read.observable;
  switch (field.tag) {
    case 1:
      read.gps_l1 = read.gps_l1 && is(field.bytes, kGps);
      break;
    case 2:
      read.gps_l1 = read.gps_l1 && is(field.bytes, kL1CodeCa);
      break;
    case 3:
      o.prn = field.number <= kCaCodes ? static_cast<int>(field.number) : -1;
      break;
    case 4:
      o.channel = field.number < kMaxObservables ? static_cast<int>(field.number) : -1;
      break;
    case 13:
      o.cn0_dbhz = field.as_double();
      break;
    case 14:
      o.doppler_hz = field.as_double();
      break;
    case 15:
      o.carrier_phase_cycles = field.as_double() / (2.0 * std::numbers::pi);
      break;
    case 22:
      o.pseudorange_m = field.as_double();
      break;
    case 23:
      o.rx_time_s = field.as_double();
      break;
    case 24:
      o.valid = field.is_varint() && field.number != 0;
      break;
    default:
      break;
  }
}

bool is_plausible(const Observable& o) {
  if (o.channel < 0 || !within(o.rx_time_s, 0.0, kSecondsPerWeek)) return false;
  if (!o.valid) return true;
  return o.prn >= 1 && within(o.pseudorange_m, 1e6, 1e8) && within(o.carrier_phase_cycles, -1e12, 1e12) &&
         within(o.doppler_hz, -1e5, 1e5) && within(o.cn0_dbhz, 0.0, 99.0);
}

std::optional<ReadObservable> read_observable(std::span<const std::uint8_t> bytes) {
  ReadObservable read;
  ProtobufReader reader(bytes);
  while (const auto field = reader.next()) take(read, *field);
  if (!reader.complete()) return std::nullopt;
  read.plausible = is_plausible(read.observable);
  return read;
}

std::optional<twins::gnss::TransmittedSubframe> words_of(std::span<const std::uint8_t> bits) {
  if (bits.size() != kSubframeBits) return std::nullopt;
  twins::gnss::TransmittedSubframe words{};
  for (std::size_t k = 0; k < kSubframeBits; ++k) {
    if (bits[k] != '0' && bits[k] != '1') return std::nullopt;
    words[k / 30] = words[k / 30] << 1U | static_cast<std::uint32_t>(bits[k] - '0');
  }
  return words;
}

}  // namespace

std::optional<std::vector<Observable>> read_observables(std::span<const std::uint8_t> datagram) {
  std::vector<Observable> observables;
  ProtobufReader reader(datagram);
  std::size_t count = 0;
  while (const auto field = reader.next()) {
    if (field->tag != 1 || field->type != ProtobufReader::Field::Type::kBytes) continue;
    const std::optional<ReadObservable> read = read_observable(field->bytes);
    if (!read || ++count > kMaxObservables) return std::nullopt;
    if (!read->gps_l1) continue;
    if (!read->plausible) return std::nullopt;
    observables.push_back(read->observable);
  }
  if (!reader.complete()) return std::nullopt;
  return observables;
}

std::optional<ReceivedSubframe> read_subframe(std::span<const std::uint8_t> datagram) {
  ReceivedSubframe subframe;
  bool gps_l1 = true;
  std::optional<twins::gnss::TransmittedSubframe> words;
  ProtobufReader reader(datagram);
  while (const auto field = reader.next()) {
    if (field->tag == 1) gps_l1 = gps_l1 && is(field->bytes, kGps);
    if (field->tag == 2) gps_l1 = gps_l1 && is(field->bytes, kL1CodeCa);
    if (field->tag == 3 && field->number <= kCaCodes) subframe.prn = static_cast<int>(field->number);
    if (field->tag == 4 && field->number <= 604'800'000U) subframe.tow_ms = static_cast<std::int64_t>(field->number);
    if (field->tag == 5) words = words_of(field->bytes);
  }
  if (!reader.complete() || !gps_l1 || subframe.prn < 1 || !words) return std::nullopt;
  subframe.words = *words;
  return subframe;
}

namespace {

constexpr std::int64_t kMaxWait_ms = 500;
constexpr double kWholeMillisecond = 1e-3;  // ms: a clock that shows less than a millisecond makes no epoch
constexpr std::int64_t kHalfWeek_ms = 302'400'000;

}  // namespace

void ObservableEpochs::take(const Observable& observable) {
  const double ms = observable.rx_time_s * 1e3;
  const std::int64_t rx_time_ms = std::llround(ms);
  if (observable.rx_time_s <= 0.0 || std::abs(ms - static_cast<double>(rx_time_ms)) > kWholeMillisecond) return;
  if (last_ms_ - rx_time_ms > kHalfWeek_ms) {  // a new week
    pending_.clear();
    locks_.clear();
    newest_ms_ = last_ms_ = 0;
  }
  if (rx_time_ms <= last_ms_) return;
  newest_ms_ = std::max(newest_ms_, rx_time_ms);
  Pending& pending = pending_[rx_time_ms];
  ++pending.received;
  if (observable.valid) pending.by_satellite[observable.prn] = observable;
}

std::optional<ObservableEpoch> ObservableEpochs::next() {
  if (pending_.empty()) return std::nullopt;
  const auto first = pending_.begin();
  if (first->second.received < channels_ && newest_ms_ - first->first < kMaxWait_ms) return std::nullopt;
  ObservableEpoch epoch = finished(first->first, first->second);
  last_ms_ = first->first;
  pending_.erase(first);
  return epoch;
}

ObservableEpoch ObservableEpochs::finished(std::int64_t rx_time_ms, const Pending& pending) {
  ObservableEpoch epoch{rx_time_ms, {}};
  const double wavelength_m = twins::gnss::wavelength_m(twins::gnss::Signal::kGpsL1);
  for (const auto& [prn, observable] : pending.by_satellite) {
    Lock& lock = locks_[prn];
    const bool continues = lock.last_ms != 0 && lock.channel == observable.channel &&
                           rx_time_ms - lock.last_ms <= interval_ms_ + interval_ms_ / 2;
    if (!continues)
      lock = {rx_time_ms, rx_time_ms, observable.channel,
              std::round(observable.pseudorange_m / wavelength_m - observable.carrier_phase_cycles)};
    lock.last_ms = rx_time_ms;
    epoch.satellites.push_back({observable, lock.since_ms, observable.carrier_phase_cycles + lock.added_cycles});
  }
  return epoch;
}

}  // namespace vbar::grand::bench
