// The server answers every batch of a step barrier once, whatever the line loses, corrupts, repeats or delays.

#include "hil_drivers/external/batch_server.h"

#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/io/byte_channels.h"
#include "pil_bridge/link_faults.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/stream_transport.h"

namespace vbar::external {
namespace {

using Packets = std::vector<BatchServer::Packet>;

pil::BarrierTiming quick() {
  pil::BarrierTiming timing;
  timing.poll_after = std::chrono::milliseconds(20);
  timing.poll_limit = std::chrono::milliseconds(80);
  timing.hello_period = std::chrono::milliseconds(10);
  return timing;
}

std::unique_ptr<pil::FrameTransport> stream(io::FileDescriptor socket) {
  return std::make_unique<pil::StreamTransport>(io::adopt_socket(std::move(socket), "test"));
}

/// Every packet of a batch three times, so that answers exceed the window.
Packets tripled(std::span<const BatchServer::Packet> batch) {
  Packets answer;
  for (int k = 0; k < 3; ++k) answer.insert(answer.end(), batch.begin(), batch.end());
  return answer;
}

Packets numbered(std::size_t count, std::uint8_t first) {
  Packets packets;
  for (std::size_t k = 0; k < count; ++k)
    packets.push_back(BatchServer::Packet(1 + k % 7, static_cast<std::uint8_t>(first + k)));
  return packets;
}

void answers_each_batch_once(const pil::LinkFaults& faults) {
  auto [ours, theirs] = io::make_socket_pair();
  auto line = stream(std::move(theirs));
  int served = 0;
  BatchServer server(*line, "tripler", [&](std::span<const BatchServer::Packet> batch) {
    ++served;
    return tripled(batch);
  });
  auto running = std::async(std::launch::async, [&] { server.run(std::chrono::seconds(20)); });
  auto transport = pil::with_frame_faults(stream(std::move(ours)), faults);
  pil::StepBarrier barrier(*transport, 77, quick(), [] {});
  EXPECT_EQ(barrier.connect(1), "tripler");
  constexpr int kSteps = 20;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    const Packets batch = numbered(1 + 9 * step, static_cast<std::uint8_t>(step));
    EXPECT_EQ(barrier.exchange(step, batch), tripled(batch)) << step;
  }
  // A goodbye is not repeated, and this line may lose it: the closed line ends the server then.
  barrier.goodbye();
  transport.reset();
  try {
    running.get();
  } catch (const pil::LinkError&) {
    EXPECT_TRUE(faults.any_frame_fault());
  }
  EXPECT_EQ(served, kSteps);
}

TEST(BatchServer, AnswersBatchesUntilTheGoodbye) {
  answers_each_batch_once({});
}

TEST(BatchServer, AnswersOnceOverABadLine) {
  pil::LinkFaults faults;
  faults.seed = 3;
  faults.drop_frame = 0.05;
  faults.duplicate_frame = 0.05;
  faults.delay_frame = 0.05;
  answers_each_batch_once(faults);
}

TEST(BatchServer, AClosedLineAndASilentRunEndIt) {
  auto [ours, theirs] = io::make_socket_pair();
  auto line = stream(std::move(theirs));
  BatchServer server(*line, "x", tripled);
  EXPECT_THROW(server.run(std::chrono::milliseconds(20)), pil::LinkError);
  ours.reset();
  EXPECT_THROW(server.run(std::chrono::seconds(20)), pil::LinkError);
}

}  // namespace
}  // namespace vbar::external
