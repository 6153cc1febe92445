#include "hil_drivers/grand/bench/samples/gnss_sdr/monitor_datagrams.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "hil_drivers/grand/bench/samples/ca_code.h"
#include "hil_drivers/grand/bench/samples/gnss_sdr/protobuf_reader.h"

namespace vbar::grand::bench {
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

}  // namespace vbar::grand::bench
