// What a receiver's bytes cost to decode, in bytes a second, and an ephemeris to evaluate. A line at 921,600 baud
// brings 92,160 bytes a second.

#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "fsw/gnss/receiver_decoder.h"
#include "tests/support/paths.h"

namespace {

using namespace vbar::fsw::gnss;
using Bytes = std::vector<std::uint8_t>;

Bytes real_log() {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/oemv_200911218.gps"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// As many open candidates as are followed: headers that announce 8 kB, one after the other.
Bytes false_starts() {
  constexpr std::array<std::uint8_t, 10> kHeader{0xAA, 0x44, 0x12, 28, 43, 0, 0, 0, 0x40, 0x1F};
  Bytes bytes;
  for (int k = 0; k < 5000; ++k) bytes.insert(bytes.end(), kHeader.begin(), kHeader.end());
  return bytes;
}

void decode(benchmark::State& state, const Bytes& bytes) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (auto _ : state) {
    for (const std::uint8_t byte : bytes) benchmark::DoNotOptimize(decoder->push(byte));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}

void evaluate(benchmark::State& state) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (const std::uint8_t byte : real_log()) benchmark::DoNotOptimize(decoder->push(byte));
  vbar::fsw::GpsTime time = decoder->ephemeris().toe;
  for (auto _ : state) {
    time.ns += 1'000'000;
    benchmark::DoNotOptimize(satellite_state(decoder->ephemeris(), time));
  }
}

BENCHMARK_CAPTURE(decode, log, real_log())->Name("gnss_decode/vbar/real_log");
BENCHMARK_CAPTURE(decode, false_starts, false_starts())->Name("gnss_decode/vbar/false_starts");
BENCHMARK(evaluate)->Name("gnss_ephemeris/vbar/state");

}  // namespace
