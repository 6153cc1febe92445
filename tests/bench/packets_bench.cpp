// Cost of the packet contract: a telemetry message into a packet and back, and the CRC of the largest packet.

#include <array>

#include <benchmark/benchmark.h>

#include "fsw/packets/messages.h"

namespace {

using namespace vbar::fsw::packets;

void telemetry_round_trip(benchmark::State& state) {
  vbar::telemetry_navigation message{};
  message.valid = 1;
  PacketHeader header;
  std::array<std::uint8_t, kMaxPacketBytes> buffer{};
  for (auto _ : state) {
    const auto size = encode(header, message, buffer);
    const auto view = parse_packet(std::span(buffer).first(size.value()));
    benchmark::DoNotOptimize(decode<vbar::telemetry_navigation>(view.value()));
  }
}
BENCHMARK(telemetry_round_trip)->Name("packet/vbar/telemetry_round_trip");

}  // namespace
