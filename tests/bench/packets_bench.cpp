// Cost of the wire formats: messages, checksums, COBS.

#include <array>
#include <cstdint>

#include <benchmark/benchmark.h>
#include <boost/crc.hpp>
#ifdef VBAR_HAVE_ZLIB
#include <zlib.h>
#endif

#include "fsw/link/cobs.h"
#include "fsw/packets/crc.h"
#include "fsw/packets/messages.h"

namespace {

namespace packets = vbar::fsw::packets;
namespace link = vbar::fsw::link;

std::array<std::uint8_t, link::kMaxFrameBytes> some_bytes() {
  std::array<std::uint8_t, link::kMaxFrameBytes> bytes{};
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24U);
  return bytes;
}

void encode_telemetry(benchmark::State& state) {
  std::array<std::uint8_t, packets::kMaxPacketBytes> out{};
  const vbar::telemetry_navigation message{};
  for (auto _ : state) benchmark::DoNotOptimize(packets::encode({}, message, out));
}
BENCHMARK(encode_telemetry)->Name("packet_encode/vbar/telemetry_navigation");

void decode_telemetry(benchmark::State& state) {
  std::array<std::uint8_t, packets::kMaxPacketBytes> out{};
  const auto size = packets::encode({}, vbar::telemetry_navigation{}, out);
  for (auto _ : state) {
    const auto packet = packets::parse_packet(std::span(out).first(size.value()));
    benchmark::DoNotOptimize(packets::decode<vbar::telemetry_navigation>(packet.value()));
  }
}
BENCHMARK(decode_telemetry)->Name("packet_decode/vbar/telemetry_navigation");

void crc16(benchmark::State& state) {
  const auto bytes = some_bytes();
  for (auto _ : state) benchmark::DoNotOptimize(packets::crc16_ccitt_false(bytes));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(crc16)->Name("crc16/vbar/1400");

void crc32(benchmark::State& state) {
  const auto bytes = some_bytes();
  for (auto _ : state) benchmark::DoNotOptimize(packets::crc32_ieee(bytes));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(crc32)->Name("crc32/vbar/1400");

#ifdef VBAR_HAVE_ZLIB
void crc32_of_zlib(benchmark::State& state) {
  const auto bytes = some_bytes();
  for (auto _ : state) benchmark::DoNotOptimize(::crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(crc32_of_zlib)->Name("crc32/zlib/1400");
#endif

void crc16_of_boost(benchmark::State& state) {
  const auto bytes = some_bytes();
  for (auto _ : state) {
    boost::crc_optimal<16, 0x1021, 0xFFFF, 0, false, false> crc;
    crc.process_bytes(bytes.data(), bytes.size());
    benchmark::DoNotOptimize(crc.checksum());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(crc16_of_boost)->Name("crc16/boost/1400");

}  // namespace
