// The barrier against the board's own executive, without a line in between; then with a line that does everything
// wrong.

#include "pil_bridge/step_barrier.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boards/common/flight_executive.h"
#include "pil_bridge/link_faults.h"
#include "pil_bridge/test_article.h"
#include "pil_bridge/transport.h"
#include "tests/support/step_packets.h"

namespace vbar::pil::test {
namespace {

// A board in this process, without a line: frames go straight into its executive, and its frames wait to be received.

class LoopbackBoard final : public FrameTransport {
 public:
  using Frame = std::vector<std::uint8_t>;

  LoopbackBoard() {
    boards::Platform platform;
    platform.context = this;
    platform.name = "loopback board";
    platform.send = [](void* context, std::span<const std::uint8_t> frame) {
      static_cast<LoopbackBoard*>(context)->to_host_.emplace_back(frame.begin(), frame.end());
    };
    executive_ = std::make_unique<boards::FlightExecutive>(platform);
  }

  void send(std::span<const std::uint8_t> frame) override { last_activity_ = executive_->on_frame(frame); }

  // With nothing to deliver, time passes at once: a wait that would end in a timeout is over.
  std::span<const std::uint8_t> receive(Clock::time_point /*deadline*/) override {
    if (to_host_.empty()) return {};
    delivered_ = std::move(to_host_.front());
    to_host_.pop_front();
    return delivered_;
  }

  [[nodiscard]] TransportCounters counters() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "loopback"; }
  [[nodiscard]] boards::Activity last_activity() const { return last_activity_; }

 private:
  std::unique_ptr<boards::FlightExecutive> executive_;
  std::deque<Frame> to_host_;
  Frame delivered_;
  boards::Activity last_activity_ = boards::Activity::kIdle;
};

}  // namespace
}  // namespace vbar::pil::test

namespace vbar::pil {
namespace {

using fsw::link::FrameHeader;
using fsw::link::FrameType;
using std::chrono::milliseconds;
using test::LoopbackBoard;
using testing::HasSubstr;
using vbar::test::packet_count;
using vbar::test::step_packets;

constexpr std::uint32_t kSession = 0xC0FFEE01;
constexpr std::uint8_t kSpacecraft = 3;
void watch_nothing() {}

/// A board that gives fixed frames to whatever it is sent.
class ScriptedBoard : public FrameTransport {
 public:
  explicit ScriptedBoard(std::vector<std::pair<FrameHeader, std::string>> replies) : replies_(std::move(replies)) {}
  void send(std::span<const std::uint8_t> /*frame*/) override {
    ++sent;
    next_ = 0;
  }
  std::span<const std::uint8_t> receive(Clock::time_point deadline) override {
    if (next_ == replies_.size()) {
      std::this_thread::sleep_until(deadline);
      return {};
    }
    const auto& [header, payload] = replies_[next_++];
    const std::vector<std::uint8_t> bytes(payload.begin(), payload.end());
    const auto size = fsw::link::write_frame(header, bytes, frame_);
    return std::span(frame_).first(size.value());
  }
  [[nodiscard]] TransportCounters counters() const override { return line; }
  [[nodiscard]] std::string description() const override { return "scripted line"; }
  int sent = 0;
  TransportCounters line;

 private:
  std::vector<std::pair<FrameHeader, std::string>> replies_;
  std::size_t next_ = 0;
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> frame_{};
};

BarrierTiming hasty() {
  BarrierTiming timing;
  timing.poll_after = milliseconds(5);
  timing.poll_limit = milliseconds(20);
  timing.give_up_after = milliseconds(100);
  timing.hello_period = milliseconds(10);
  timing.boot_limit = milliseconds(100);
  return timing;
}

std::string link_error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const LinkError& error) {
    return error.what();
  }
  return "no error";
}

/// Packets of the flight software alone: the executive adds one step report to each answer, at its end.
std::vector<Packet> without_report(std::vector<Packet> answer) {
  answer.pop_back();
  return answer;
}

TEST(StepBarrier, GivesTheSamePacketsAsAFlightSoftwareCalledDirectly) {
  LoopbackBoard board;
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  EXPECT_EQ(barrier.connect(kSpacecraft), "loopback board");
  const auto direct = make_in_process(linked_test_article(), kSpacecraft);
  for (std::uint32_t step = 0; step < 100; ++step) {
    const auto inputs = step_packets(step, packet_count(step));
    ASSERT_EQ(without_report(barrier.exchange(step, inputs)), direct->step(step, inputs).packets) << "step " << step;
  }
  const BarrierCounters counters = barrier.counters();
  EXPECT_EQ(counters.frames_resent, 0U);
  EXPECT_EQ(counters.frames_rejected, 0U);
  EXPECT_EQ(counters.frames_duplicated, 0U);
  EXPECT_EQ(counters.polls, 0U);
}

TEST(StepBarrier, ASnapshotThatIsRefusedOrTooLargeGivesItsStatus) {
  LoopbackBoard board;
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  barrier.connect(kSpacecraft);
  std::vector<std::uint8_t> snapshot = barrier.read_snapshot();
  snapshot.back() ^= 1U;
  EXPECT_EQ(barrier.write_snapshot(snapshot), static_cast<std::int32_t>(fsw::Status::kBadChecksum));
  EXPECT_EQ(barrier.write_snapshot(std::vector<std::uint8_t>(boards::kSnapshotBytes + 1)),
            static_cast<std::int32_t>(fsw::Status::kTooLong));
}

TEST(StepBarrier, GoodbyeEndsTheBoard) {
  LoopbackBoard board;
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  barrier.connect(kSpacecraft);
  barrier.goodbye();
  EXPECT_EQ(board.last_activity(), boards::Activity::kGoodbye);
}

struct NamedFaults {
  const char* name;
  LinkFaults faults;
};
class BadLine : public testing::TestWithParam<NamedFaults> {};

// One frame in ten is hit, in both directions: about 200 of the 2000 frames of this run. The outputs may not change by
// a bit.
TEST_P(BadLine, ChangesNothingButTheCounters) {
  const LinkFaults faults = GetParam().faults;
  const auto line = with_frame_faults(std::make_unique<LoopbackBoard>(), faults);
  StepBarrier barrier(*line, kSession, hasty(), watch_nothing);
  barrier.connect(kSpacecraft);
  const auto direct = make_in_process(linked_test_article(), kSpacecraft);
  for (std::uint32_t step = 0; step < 100; ++step) {
    const auto inputs = step_packets(step, packet_count(step));
    ASSERT_EQ(without_report(barrier.exchange(step, inputs)), direct->step(step, inputs).packets) << "step " << step;
  }
  const BarrierCounters counters = barrier.counters();
  const bool loses = faults.drop_frame > 0.0 || faults.flip_bit_per_frame > 0.0 || faults.delay_frame > 0.0;
  EXPECT_EQ(counters.polls > 0, loses);
  EXPECT_EQ(counters.frames_resent > 0, loses);
  EXPECT_EQ(counters.frames_rejected > 0, loses);
  if (faults.duplicate_frame > 0.0) {
    EXPECT_GT(counters.frames_duplicated, 0U);
  }
}

// Between two steps the state goes to another board, which continues.
TEST_P(BadLine, ASnapshotPassesWhole) {
  const auto line = with_frame_faults(std::make_unique<LoopbackBoard>(), GetParam().faults);
  StepBarrier barrier(*line, kSession, hasty(), watch_nothing);
  barrier.connect(kSpacecraft);
  const auto direct = make_in_process(linked_test_article(), kSpacecraft);
  const auto fly = [&](std::uint32_t step, StepBarrier& on) {
    const auto inputs = step_packets(step, packet_count(step));
    EXPECT_EQ(without_report(on.exchange(step, inputs)), direct->step(step, inputs).packets) << "step " << step;
  };
  for (std::uint32_t step = 0; step < 5; ++step) fly(step, barrier);
  const std::vector<std::uint8_t> snapshot = barrier.read_snapshot();
  EXPECT_EQ(snapshot, direct->snapshot());
  fly(5, barrier);
  const std::vector<std::uint8_t> later = barrier.read_snapshot();
  EXPECT_NE(later, snapshot) << "of the last step, not of the first question";

  const auto other_line = with_frame_faults(std::make_unique<LoopbackBoard>(), GetParam().faults);
  StepBarrier other(*other_line, kSession + 1, hasty(), watch_nothing);
  other.connect(kSpacecraft);
  EXPECT_EQ(other.write_snapshot(later), 0);
  for (std::uint32_t step = 6; step < 10; ++step) fly(step, other);
}

INSTANTIATE_TEST_SUITE_P(Faults, BadLine,
                         testing::Values(NamedFaults{"FlippedBit", {.seed = 11, .flip_bit_per_frame = 0.1}},
                                         NamedFaults{"LostFrame", {.seed = 12, .drop_frame = 0.1}},
                                         NamedFaults{"DuplicatedFrame", {.seed = 13, .duplicate_frame = 0.1}},
                                         NamedFaults{"LateFrame", {.seed = 14, .delay_frame = 0.1}},
                                         NamedFaults{"Everything",
                                                     {.seed = 15,
                                                      .flip_bit_per_frame = 0.1,
                                                      .drop_frame = 0.1,
                                                      .duplicate_frame = 0.1,
                                                      .delay_frame = 0.1}}),
                         [](const auto& tested) { return tested.param.name; });

TEST(StepBarrier, GivesUpOnABoardThatNeverAnswersHello) {
  ScriptedBoard board({});
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  const auto start = Clock::now();
  EXPECT_THAT(link_error_of([&] { barrier.connect(kSpacecraft); }), HasSubstr("no answer to hello within 0.1 s"));
  // Ten hello periods fit the boot limit; the wait ends there, not a poll later. Generous for a loaded machine.
  EXPECT_GE(board.sent, 2);
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
}

TEST(StepBarrier, SaysWhatCameInsteadOfAnAnswer) {
  const auto said = [](const TransportCounters& line) {
    ScriptedBoard board({});
    board.line = line;
    StepBarrier barrier(board, kSession, hasty(), watch_nothing);
    return link_error_of([&] { barrier.connect(kSpacecraft); });
  };
  EXPECT_THAT(said({}), HasSubstr("; nothing came"));
  EXPECT_THAT(said({.bytes_received = 512, .frames_rejected = 2}),
              HasSubstr("; 512 bytes came that are no frame of the link: another rate, or a console"));
  EXPECT_THAT(said({.bytes_received = 40, .foreign_datagrams = 3}),
              HasSubstr("; 3 datagrams came from another address"));
}

TEST(StepBarrier, IgnoresAnAnswerOfAnotherSessionAndCountsIt) {
  ScriptedBoard board({{{.type = FrameType::kHelloAck, .session = kSession + 1}, "board of an older run"}});
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  EXPECT_THAT(link_error_of([&] { barrier.connect(kSpacecraft); }), HasSubstr("no answer to hello"));
  EXPECT_GE(barrier.counters().frames_rejected, 2U);
}

TEST(StepBarrier, PassesOnWhyABoardCannotFly) {
  ScriptedBoard board({{{.type = FrameType::kHelloAck, .session = kSession}, "error: no room for the state"}});
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  EXPECT_EQ(link_error_of([&] { barrier.connect(kSpacecraft); }),
            "the board cannot run its flight software: no room for the state");
}

TEST(StepBarrier, PassesOnWhyABoardHasLostItsSession) {
  ScriptedBoard late({{{.type = FrameType::kHelloAck, .session = kSession}, "the name, once more"},
                      {{.type = FrameType::kHelloAck, .session = kSession}, "error: its watchdog reset it in step 7"}});
  StepBarrier barrier(late, kSession, hasty(), watch_nothing);
  const std::string expected = "the board has lost its session: its watchdog reset it in step 7";
  EXPECT_THROW(barrier.exchange(7, step_packets(7, 1)), SessionLost);
  EXPECT_EQ(link_error_of([&] { barrier.exchange(7, step_packets(7, 1)); }), expected);
  EXPECT_EQ(link_error_of([&] { barrier.receiver_count(Clock::now() + milliseconds(5)); }), expected);
}

TEST(StepBarrier, GivesUpOnABoardThatStallsInAStep) {
  // It acknowledges for ever and never answers: progress once, when the acknowledgement says something new.
  ScriptedBoard board({{{.type = FrameType::kAck, .session = kSession, .step = 7, .index = 1}, ""}});
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  EXPECT_THAT(link_error_of([&] { barrier.exchange(7, step_packets(7, 1)); }),
              HasSubstr("no answer to step 7 within 0.1 s on scripted line"));
  EXPECT_GE(barrier.counters().polls, 2U);
}

TEST(StepBarrier, WatchEndsAHopelessWait) {
  ScriptedBoard board({});
  StepBarrier barrier(board, kSession, hasty(), [] { throw LinkError("its process has ended"); });
  EXPECT_EQ(link_error_of([&] { barrier.connect(kSpacecraft); }), "its process has ended");
  EXPECT_EQ(board.sent, 1);
}

TEST(StepBarrier, ImpossibleAcknowledgementsAndForeignFramesAreCountedNotBelieved) {
  ScriptedBoard board({{{.type = FrameType::kAck, .session = kSession, .step = 7, .index = 9}, ""},
                       {{.type = FrameType::kPoll, .session = kSession, .step = 7}, ""},
                       {{.type = FrameType::kData, .session = kSession, .step = 8, .last = true}, "of a later step"},
                       {{.type = FrameType::kData, .session = kSession, .step = 6, .last = true}, "of an earlier step"},
                       {{.type = FrameType::kData, .session = kSession, .step = 7, .last = true}, "the answer"}});
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  const auto answer = barrier.exchange(7, step_packets(7, 1));
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(std::string(answer[0].begin(), answer[0].end()), "the answer");
  EXPECT_EQ(barrier.counters().frames_rejected, 3U);
  EXPECT_EQ(barrier.counters().frames_duplicated, 1U);
}

TEST(StepBarrier, RefusesABatchWithoutPackets) {
  LoopbackBoard board;
  StepBarrier barrier(board, kSession, hasty(), watch_nothing);
  EXPECT_THROW((void)barrier.exchange(0, {}), LinkError);
}

}  // namespace

}  // namespace vbar::pil
