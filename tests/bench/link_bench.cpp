// What a step costs beside the flight software itself: line coding, and the round trip to a flight computer of every
// kind that is built. The flight software is the link exerciser.

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include <benchmark/benchmark.h>
#include <boost/crc.hpp>

#include "fsw/link/frame.h"
#include "pil_bridge/make_flight_computer.h"
#include "tests/support/paths.h"
#include "tests/support/step_packets.h"

namespace {

using namespace vbar::pil;
namespace link = vbar::fsw::link;

std::array<std::uint8_t, link::kMaxFrameBytes> random_frame() {
  std::array<std::uint8_t, link::kMaxFrameBytes> frame{};
  std::mt19937 random(1);
  for (std::uint8_t& byte : frame) byte = static_cast<std::uint8_t>(random() >> 24U);
  return frame;
}

void cobs_round_trip(benchmark::State& state) {
  const auto frame = random_frame();
  std::array<std::uint8_t, link::kMaxCobsFrameBytes> coded{};
  link::CobsDecoder decoder;
  for (auto _ : state) {
    const auto size = link::cobs_encode(frame, coded);
    for (std::size_t i = 0; i < size.value(); ++i) benchmark::DoNotOptimize(decoder.push(coded[i]));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(frame.size()));
}

void frame_check(benchmark::State& state) {
  const auto payload = random_frame();
  std::array<std::uint8_t, link::kMaxFrameBytes> frame{};
  const auto room = link::kMaxFrameBytes - link::kFrameHeaderBytes - link::kFrameCrcBytes;
  const auto size = link::write_frame({.type = link::FrameType::kData}, std::span(payload).first(room), frame);
  for (auto _ : state) benchmark::DoNotOptimize(link::parse_frame(std::span(frame).first(size.value())));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(size.value()));
}

/// Steps of two packets: one of up to 1376 bytes and the tick.
void step(benchmark::State& state, Target target, LinkKind kind, const std::string& image) {
  FlightComputerOptions options;
  options.target = target;
  options.link = kind;
  options.library = vbar::tests::build_path("libvbar_echo_article.so");
  options.image = image;
  std::unique_ptr<FlightComputer> computer;
  try {
    computer = make_flight_computer(options);
  } catch (const FlightComputerError& error) {
    state.SkipWithError(error.what());
    return;
  }
  std::uint32_t number = 0;
  std::int64_t packets = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto inputs = vbar::test::step_packets(number, 2);
    state.ResumeTiming();
    packets += static_cast<std::int64_t>(computer->step(number++, inputs).packets.size());
  }
  state.counters["packets_out"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}

/// Steps of one camera image, 500 x 800 px at 12 bits: 461 tiles and the tick.
void image_step(benchmark::State& state, Target target, LinkKind kind, const std::string& image) {
  FlightComputerOptions options;
  options.target = target;
  options.link = kind;
  options.image = image;
  std::unique_ptr<FlightComputer> computer;
  try {
    computer = make_flight_computer(options);
  } catch (const FlightComputerError& error) {
    state.SkipWithError(error.what());
    return;
  }
  std::uint32_t number = 0;
  std::int64_t bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto inputs = vbar::test::image_packets(number);
    for (const Packet& packet : inputs) bytes += static_cast<std::int64_t>(packet.size());
    state.ResumeTiming();
    benchmark::DoNotOptimize(computer->step(number++, inputs));
  }
  state.SetBytesProcessed(bytes);
}

const std::string kHostFlight = vbar::tests::build_path("vbar_flight");
const std::string kZynqFlight = vbar::tests::source_path("build/zynq/vbar_zynq7000.elf");
const std::string kHost = vbar::tests::build_path("vbar_flight_echo");
const std::string kZynq = vbar::tests::source_path("build/zynq/vbar_zynq7000_echo.elf");
const std::string kArmLinux = vbar::tests::source_path("build/zynq-linux/vbar_flight_echo");

BENCHMARK(cobs_round_trip)->Name("link/cobs/1400");
BENCHMARK(frame_check)->Name("link/frame_crc/1400");
BENCHMARK_CAPTURE(step, in_process, Target::kInProcess, LinkKind::kSerial, std::string())
    ->Name("link/in_process/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, host_serial, Target::kHostProcess, LinkKind::kSerial, kHost)
    ->Name("link/host_process_serial/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, host_pty, Target::kHostProcess, LinkKind::kPty, kHost)
    ->Name("link/host_process_pty/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, host_udp, Target::kHostProcess, LinkKind::kUdp, kHost)
    ->Name("link/host_process_udp/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, arm_linux, Target::kZynqLinuxQemu, LinkKind::kSerial, kArmLinux)
    ->Name("link/zynq_linux_qemu_serial/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, zynq_serial, Target::kZynqQemu, LinkKind::kSerial, kZynq)
    ->Name("link/zynq_qemu_serial/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(step, zynq_udp, Target::kZynqQemu, LinkKind::kUdp, kZynq)
    ->Name("link/zynq_qemu_udp/step")
    ->UseRealTime();
BENCHMARK_CAPTURE(image_step, host_udp, Target::kHostProcess, LinkKind::kUdp, kHostFlight)
    ->Name("link/host_process_udp/image")
    ->UseRealTime();
BENCHMARK_CAPTURE(image_step, zynq_udp, Target::kZynqQemu, LinkKind::kUdp, kZynqFlight)
    ->Name("link/zynq_qemu_udp/image")
    ->UseRealTime();

}  // namespace

// Cost of the wire formats: messages, checksums, COBS.

#ifdef VBAR_HAVE_ZLIB
#include <zlib.h>
#endif

#include "fsw/link/frame.h"
#include "fsw/packets/crc.h"
#include "fsw/packets/messages.h"

namespace {

namespace packets = vbar::fsw::packets;

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
