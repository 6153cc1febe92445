// What a step costs beside the flight software itself: line coding, and the round trip to a flight computer of every
// kind that is built. The flight software is the link exerciser.

#include <array>
#include <memory>
#include <random>
#include <string>

#include <benchmark/benchmark.h>

#include "fsw/link/cobs.h"
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
