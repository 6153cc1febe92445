// The board's side of the step barrier, frame by frame, as frame.h describes it.

#include "boards/common/flight_executive.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "tests/unit/boards/common/fake_gnc.h"
#include "tests/unit/boards/common/reference_host.h"

namespace vbar::boards {
namespace {

using fsw::link::FrameHeader;
using fsw::link::FrameType;
using testing::Bytes;
using testing::fake_gnc_settings;
using testing::make_frame;
using testing::tick_packet;

constexpr std::uint32_t kSession = 0xC0FFEE01;

/// A frame the board sent, with its own bytes.
struct Sent {
  FrameHeader header;
  Bytes payload;
};

class FlightExecutiveTest : public ::testing::Test {
 protected:
  FlightExecutiveTest() { testing::reset_fake_gnc(); }

  static Platform platform(FlightExecutiveTest* test) {
    Platform platform;
    platform.context = test;
    platform.name = "unit";
    platform.send = [](void* context, std::span<const std::uint8_t> bytes) {
      const auto frame = fsw::link::parse_frame(bytes);
      ASSERT_TRUE(frame.ok());
      const auto payload = frame.value().payload;
      static_cast<FlightExecutiveTest*>(context)->sent_.push_back(
          {frame.value().header, Bytes(payload.begin(), payload.end())});
    };
    platform.counter = [](void* context) { return static_cast<FlightExecutiveTest*>(context)->counter_ += 1000; };
    platform.stack_high_water = [](void*) { return std::uint32_t{4321}; };
    platform.counter_unit = CounterUnit::kCycles;
    return platform;
  }

  /// What the board sends on a frame.
  std::vector<Sent> on(FrameType type, std::uint32_t step = 0, std::uint16_t index = 0, const Bytes& payload = {},
                       bool last = false, std::uint32_t session = kSession, bool acknowledge_now = false) {
    FrameHeader header;
    header.type = type;
    header.session = session;
    header.step = step;
    header.index = index;
    header.last = last;
    header.acknowledge_now = acknowledge_now;
    sent_.clear();
    activity_ = board_->on_frame(make_frame(header, payload));
    return sent_;
  }

  std::string hello(std::uint32_t session = kSession) {
    const std::vector<Sent> answer = on(FrameType::kHello, 0, 0, {1}, false, session);
    EXPECT_EQ(answer.size(), 1U);
    EXPECT_EQ(answer.front().header.type, FrameType::kHelloAck);
    EXPECT_EQ(answer.front().header.session, session);
    return {answer.front().payload.begin(), answer.front().payload.end()};
  }

  /// A step whose only input is its tick; the answer's frames.
  std::vector<Sent> tick(std::uint32_t step) { return on(FrameType::kData, step, 0, tick_packet(step, step), true); }

  static vbar::step_report report_of(const std::vector<Sent>& answer) {
    EXPECT_FALSE(answer.empty());
    EXPECT_TRUE(answer.back().header.last);
    const auto packet = fsw::packets::parse_packet(answer.back().payload);
    EXPECT_TRUE(packet.ok());
    const auto report = fsw::packets::decode<vbar::step_report>(packet.value());
    EXPECT_TRUE(report.ok());
    return report.value();
  }

  static void expect_refusal(const std::vector<Sent>& answer, const std::string& why) {
    ASSERT_EQ(answer.size(), 1U);
    EXPECT_EQ(answer[0].header.type, FrameType::kHelloAck);
    const std::string text(answer[0].payload.begin(), answer[0].payload.end());
    EXPECT_THAT(text, ::testing::AllOf(::testing::StartsWith("error: "), ::testing::HasSubstr(why)));
  }

  static void say(int count, std::size_t size = 30) {
    fake_gnc_settings().step_output = [count, size](std::uint64_t) {
      std::vector<Bytes> packets;
      for (int i = 0; i < count; ++i) packets.emplace_back(size, static_cast<std::uint8_t>(i));
      return packets;
    };
  }

  std::uint64_t counter_ = 0;
  std::vector<Sent> sent_;
  Activity activity_ = Activity::kIdle;
  std::unique_ptr<FlightExecutive> board_ = std::make_unique<FlightExecutive>(platform(this));
};

TEST_F(FlightExecutiveTest, HelloIsAnsweredWithTheBoardsName) {
  EXPECT_EQ(hello(), "unit");
}

TEST_F(FlightExecutiveTest, NothingButHelloIsHeardBeforeHello) {
  for (const FrameType type :
       {FrameType::kHelloAck, FrameType::kData, FrameType::kAck, FrameType::kPoll, FrameType::kGoodbye}) {
    EXPECT_TRUE(on(type, 0, 0, tick_packet(0, 0), true, 0).empty());
    EXPECT_EQ(activity_, Activity::kIdle);
  }
}

TEST_F(FlightExecutiveTest, ATickClosesTheStepAndTheReportClosesTheAnswer) {
  say(2);
  hello();
  EXPECT_TRUE(on(FrameType::kData, 5, 0, testing::fake_output(1, 1)).empty());
  EXPECT_EQ(activity_, Activity::kIdle);
  const std::vector<Sent> answer = on(FrameType::kData, 5, 1, tick_packet(5, 123456789), true);
  EXPECT_EQ(activity_, Activity::kStepped);
  ASSERT_EQ(answer.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(answer[i].header.type, FrameType::kData);
    EXPECT_EQ(answer[i].header.session, kSession);
    EXPECT_EQ(answer[i].header.step, 5U);
    EXPECT_EQ(answer[i].header.index, i);
    EXPECT_EQ(answer[i].header.last, i == 2);
  }
  EXPECT_EQ(answer[0].payload, Bytes(30, 0));
  EXPECT_EQ(answer[1].payload, Bytes(30, 1));
  const vbar::step_report report = report_of(answer);
  EXPECT_EQ(report.step, 5);
  EXPECT_EQ(report.unit, static_cast<std::int8_t>(CounterUnit::kCycles));
  EXPECT_EQ(report.count, 1000);  // the counter gains 1000 from one reading to the next
  EXPECT_EQ(report.stack_bytes, 4321);
  EXPECT_EQ(report.frames_received, 3);  // hello and two packets
  EXPECT_EQ(report.frames_rejected, 0);
  EXPECT_EQ(report.frames_duplicated, 0);
  EXPECT_EQ(report.frames_resent, 0);
  const auto packet = fsw::packets::parse_packet(answer[2].payload);
  EXPECT_EQ(packet.value().header.time.ns, 123456789);
  EXPECT_EQ(packet.value().header.spacecraft, 1);
}

TEST_F(FlightExecutiveTest, HelloOfTheSameSessionForgetsNothing) {
  hello();
  tick(0);
  EXPECT_EQ(hello(), "unit");
  tick(0);  // had it been forgotten, this would step again
  EXPECT_EQ(testing::fake_gnc_steps(), 1);
  EXPECT_EQ(tick(1).back().header.step, 1U);
}

TEST_F(FlightExecutiveTest, HelloOfAnotherSessionStartsAnew) {
  hello();
  const std::vector<Sent> first = tick(0);
  tick(1);
  hello(kSession + 1);
  EXPECT_TRUE(tick(2).empty());  // the old session
  const std::vector<Sent> again = on(FrameType::kData, 0, 0, tick_packet(0, 0), true, kSession + 1);
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t i = 0; i + 1 < first.size(); ++i) EXPECT_EQ(again[i].payload, first[i].payload);
  EXPECT_EQ(report_of(again).frames_rejected, 1);
}

struct Misfit {
  const char* why;
  void (*spoil)(testing::FakeGncSettings&);
};

class FlightExecutiveMisfit : public FlightExecutiveTest, public ::testing::WithParamInterface<Misfit> {};

TEST_P(FlightExecutiveMisfit, IsRefusedWithAReasonAndNeverRun) {
  GetParam().spoil(fake_gnc_settings());
  EXPECT_THAT(hello(), ::testing::StartsWith("error: "));
  EXPECT_THAT(hello(), ::testing::HasSubstr(GetParam().why));  // also when asked again
  expect_refusal(tick(0), GetParam().why);
  expect_refusal(on(FrameType::kPoll, 0), GetParam().why);
  EXPECT_EQ(testing::fake_gnc_steps(), 0);
  testing::reset_fake_gnc();
  EXPECT_EQ(hello(kSession + 1), "unit");
}

INSTANTIATE_TEST_SUITE_P(
    Misfits, FlightExecutiveMisfit,
    ::testing::Values(Misfit{"version", [](testing::FakeGncSettings& s) { s.abi_version = VBAR_GNC_ABI_VERSION + 1; }},
                      Misfit{"larger", [](testing::FakeGncSettings& s) { s.state_size = kGncStateBytes + 1; }},
                      Misfit{"alignment", [](testing::FakeGncSettings& s) { s.state_alignment = 128; }},
                      Misfit{"alignment", [](testing::FakeGncSettings& s) { s.state_alignment = 0; }},
                      Misfit{"start", [](testing::FakeGncSettings& s) { s.init_status = 1; }}));

class FlightExecutiveWithKey : public FlightExecutiveTest {
 protected:
  FlightExecutiveWithKey() {
    for (std::size_t k = 0; k < security_.key.size(); ++k) security_.key[k] = static_cast<std::uint8_t>(3 * k);
    Platform keyed = platform(this);
    keyed.telecommand_security = &security_;
    keyed.telecommands_accepted = [](void* context, std::uint64_t sequence) {
      auto* const self = static_cast<FlightExecutiveWithKey*>(context);
      self->accepted_.push_back({sequence, testing::fake_gnc_steps()});
    };
    board_ = std::make_unique<FlightExecutive>(keyed);
  }

  struct Accepted {
    std::uint64_t sequence;
    int steps;  ///< run before
  };
  fsw::packets::TelecommandSecurity security_{.index = 7, .sequence = 1000};
  std::vector<Accepted> accepted_;
};

TEST_F(FlightExecutiveWithKey, GivesTheKeyToEachFlightSoftwareAndTellsTheHost) {
  EXPECT_EQ(hello(), std::string("unit") + kAuthenticates);
  ASSERT_EQ(testing::fake_gnc_keys().size(), 1U);
  const testing::FakeKey& given = testing::fake_gnc_keys().front();
  EXPECT_TRUE(std::ranges::equal(given.key, security_.key));
  EXPECT_EQ(given.index, 7);
  EXPECT_EQ(given.sequence, 1000U);
}

// Otherwise a hello would make telecommands of the session before acceptable again.
TEST_F(FlightExecutiveWithKey, ANewSessionBeginsWithTheSequenceNumberThatTheOldOneReached) {
  hello();
  fake_gnc_settings().sequence_reached = 5000;
  tick(0);
  hello(kSession + 1);
  fake_gnc_settings().sequence_reached = 4000;  // a flight software that counts backwards
  hello(kSession + 2);
  ASSERT_EQ(testing::fake_gnc_keys().size(), 3U);
  EXPECT_EQ(testing::fake_gnc_keys()[1].sequence, 5000U);
  EXPECT_EQ(testing::fake_gnc_keys()[2].sequence, 5000U);
}

TEST_F(FlightExecutiveWithKey, TheBoardIsToldTheSequenceNumberBeforeTheStep) {
  hello();
  fake_gnc_settings().sequence_reached = 2000;
  tick(0);
  fake_gnc_settings().sequence_reached = 3000;
  tick(1);
  ASSERT_EQ(accepted_.size(), 2U);
  EXPECT_EQ(accepted_[0].sequence, 2000U);
  EXPECT_EQ(accepted_[0].steps, 0);
  EXPECT_EQ(accepted_[1].sequence, 3000U);
  EXPECT_EQ(accepted_[1].steps, 1);
}

TEST_F(FlightExecutiveWithKey, AFlightSoftwareThatRefusesTheKeyIsNeverRun) {
  fake_gnc_settings().authenticate_status = 1;
  EXPECT_THAT(hello(), ::testing::HasSubstr("refused the key"));
  expect_refusal(tick(0), "refused the key");
  EXPECT_EQ(testing::fake_gnc_steps(), 0);
}

TEST_F(FlightExecutiveTest, GivesNoKeyThatItDoesNotHave) {
  hello();
  EXPECT_TRUE(testing::fake_gnc_keys().empty());
}

/// Of a spacecraft without a receiver on a line, with a budget (big-endian).
Bytes hello_with_budget(std::uint8_t budget_high, std::uint8_t budget_low) {
  return {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, budget_high, budget_low};
}

// The counter gains 1000 in a step.
TEST_F(FlightExecutiveTest, AStepBeyondItsBudgetIsTheLastOne) {
  say(1);
  on(FrameType::kHello, 0, 0, hello_with_budget(0x03, 0xE8));  // 1000
  EXPECT_EQ(tick(0).size(), 2U);
  EXPECT_EQ(tick(1).size(), 2U);
  on(FrameType::kHello, 0, 0, hello_with_budget(0x03, 0xE7), false, kSession + 1);  // 999
  const std::vector<Sent> answer = on(FrameType::kData, 0, 0, tick_packet(0, 0), true, kSession + 1);
  EXPECT_EQ(report_of(answer).count, 1000);
  const int steps = testing::fake_gnc_steps();
  expect_refusal(on(FrameType::kData, 1, 0, tick_packet(1, 1), true, kSession + 1), "exceeded its budget");
  expect_refusal(on(FrameType::kPoll, 1, 0, {}, false, kSession + 1), "exceeded its budget");
  EXPECT_EQ(testing::fake_gnc_steps(), steps);
  EXPECT_EQ(report_of(on(FrameType::kPoll, 0, 0, {}, false, kSession + 1)).count, 1000) << "the answer remains";
  EXPECT_EQ(hello(kSession + 2), "unit") << "the next session flies";
  EXPECT_EQ(on(FrameType::kData, 0, 0, tick_packet(0, 0), true, kSession + 2).size(), 2U);
}

TEST_F(FlightExecutiveTest, AHelloWithoutABudgetLeavesThatOfTheBoard) {
  Platform platform = FlightExecutiveTest::platform(this);
  platform.step_budget = 999;
  board_ = std::make_unique<FlightExecutive>(platform);
  hello();
  EXPECT_FALSE(tick(0).empty());
  expect_refusal(tick(1), "exceeded its budget");
  on(FrameType::kHello, 0, 0, hello_with_budget(0x03, 0xE8), false, kSession + 1);
  EXPECT_FALSE(on(FrameType::kData, 0, 0, tick_packet(0, 0), true, kSession + 1).empty());
  EXPECT_EQ(report_of(on(FrameType::kData, 1, 0, tick_packet(1, 1), true, kSession + 1)).step, 1);
}

TEST_F(FlightExecutiveTest, WithoutACounterThereIsNoBudget) {
  Platform platform = FlightExecutiveTest::platform(this);
  platform.counter = nullptr;
  platform.step_budget = 1;
  board_ = std::make_unique<FlightExecutive>(platform);
  on(FrameType::kHello, 0, 0, hello_with_budget(0, 1));
  for (std::uint32_t step = 0; step < 3; ++step) EXPECT_EQ(report_of(tick(step)).step, step);
}

TEST_F(FlightExecutiveTest, TheBoardIsToldOfSessionsAndSteps) {
  static std::string told;
  told.clear();
  Platform platform = FlightExecutiveTest::platform(this);
  platform.session_begins = [](void*, std::uint32_t session, std::uint64_t budget) {
    told += "session " + std::to_string(session - kSession) + " " + std::to_string(budget) + "; ";
  };
  platform.step_begins = [](void*, std::uint32_t step) { told += "step " + std::to_string(step); };
  platform.step_ends = [](void*, bool within) { told += within ? " ends; " : " ends late; "; };
  board_ = std::make_unique<FlightExecutive>(platform);
  on(FrameType::kHello, 0, 0, hello_with_budget(0x03, 0xE7));
  on(FrameType::kHello, 0, 0, hello_with_budget(0x03, 0xE7));  // again: the same session
  tick(4);
  on(FrameType::kHello, 0, 0, {1}, false, kSession + 1);
  on(FrameType::kData, 5, 0, testing::fake_output(1, 1), false, kSession + 1);
  on(FrameType::kData, 5, 1, tick_packet(5, 5), true, kSession + 1);
  EXPECT_EQ(told, "session 0 999; step 4 ends late; session 1 0; step 5 ends; ");
}

// As after a reset: the board has no other memory of the session.
TEST_F(FlightExecutiveTest, TheHostOfALostSessionIsToldWhy) {
  board_->lose_session(kSession, "error: reset in step 7");
  for (const FrameType type : {FrameType::kData, FrameType::kPoll}) expect_refusal(on(type, 7), "reset in step 7");
  EXPECT_TRUE(on(FrameType::kAck, 7).empty());
  EXPECT_TRUE(on(FrameType::kPoll, 7, 0, {}, false, kSession + 1).empty()) << "another session is not its concern";
  EXPECT_EQ(testing::fake_gnc_steps(), 0);
  EXPECT_EQ(hello(kSession + 1), "unit");
  EXPECT_EQ(report_of(on(FrameType::kData, 0, 0, tick_packet(0, 0), true, kSession + 1)).step, 0);
}

TEST_F(FlightExecutiveTest, HelloWithoutASpacecraftNumberIsRefused) {
  const std::vector<Sent> answer = on(FrameType::kHello);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_THAT(std::string(answer[0].payload.begin(), answer[0].payload.end()), ::testing::StartsWith("error: "));
}

TEST_F(FlightExecutiveTest, WhatIsSaidAtTheStartIsInTheFirstAnswer) {
  say(1);
  fake_gnc_settings().init_output = {Bytes(40, 0xAA)};
  hello();
  const std::vector<Sent> first = tick(0);
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first[0].payload, Bytes(40, 0xAA));
  EXPECT_EQ(tick(1).size(), 2U);
}

TEST_F(FlightExecutiveTest, ABatchWithoutATickIsAnsweredByTheReportAlone) {
  say(3);
  hello();
  const std::vector<Sent> answer = on(FrameType::kData, 0, 0, testing::fake_output(1, 1), true);
  EXPECT_EQ(activity_, Activity::kStepped);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(report_of(answer).ticks_missing, 1);
  Bytes broken = tick_packet(1, 1);
  broken.back() ^= 1U;  // the frame is whole, the packet in it is not
  EXPECT_EQ(report_of(on(FrameType::kData, 1, 0, broken, true)).ticks_missing, 2);
  EXPECT_EQ(report_of(on(FrameType::kData, 2, 0, {}, true)).ticks_missing, 3);
  EXPECT_EQ(testing::fake_gnc_steps(), 0);
  EXPECT_EQ(tick(3).size(), 4U);
}

TEST_F(FlightExecutiveTest, DataOutOfOrderIsDroppedAndCounted) {
  say(0);
  hello();
  EXPECT_TRUE(on(FrameType::kData, 0, 1, tick_packet(0, 0), true).empty());
  EXPECT_TRUE(on(FrameType::kData, 0, 0, testing::fake_output(1, 1)).empty());
  EXPECT_TRUE(on(FrameType::kData, 0, 0, testing::fake_output(1, 1)).empty());
  EXPECT_TRUE(on(FrameType::kData, 1, 0, testing::fake_output(1, 1)).empty());  // the host cannot be there yet
  const vbar::step_report report = report_of(on(FrameType::kData, 0, 1, tick_packet(0, 0), true));
  EXPECT_EQ(report.frames_rejected, 2);
  EXPECT_EQ(report.frames_duplicated, 1);
}

TEST_F(FlightExecutiveTest, DataOfStepsAlreadyRunIsADuplicateAndAnsweredByNothing) {
  say(0);
  hello();
  tick(3);
  EXPECT_TRUE(tick(3).empty());
  EXPECT_TRUE(tick(2).empty());
  EXPECT_TRUE(on(FrameType::kData, 4, 0, testing::fake_output(1, 1)).empty());
  EXPECT_TRUE(tick(3).empty());
  EXPECT_TRUE(on(FrameType::kPoll, 3).empty());
  const vbar::step_report report = report_of(on(FrameType::kData, 4, 1, tick_packet(4, 4), true));
  EXPECT_EQ(report.frames_duplicated, 4);
  EXPECT_EQ(testing::fake_gnc_steps(), 2);
}

TEST_F(FlightExecutiveTest, EveryHalfWindowAndOnDemandItAcknowledges) {
  hello();
  for (std::uint16_t i = 0; i < 40; ++i) {
    const std::vector<Sent> answer = on(FrameType::kData, 0, i, testing::fake_output(1, i));
    ASSERT_EQ(answer.size(), (i + 1) % (fsw::link::kWindow / 2) == 0 ? 1U : 0U) << i;
    if (!answer.empty()) {
      EXPECT_EQ(answer[0].header.type, FrameType::kAck);
      EXPECT_EQ(answer[0].header.index, i + 1);
    }
  }
  const std::vector<Sent> demanded = on(FrameType::kData, 0, 40, testing::fake_output(1, 1), false, kSession, true);
  ASSERT_EQ(demanded.size(), 1U);
  EXPECT_EQ(demanded[0].header.index, 41);
}

TEST_F(FlightExecutiveTest, APollBeforeTheStepSaysHowMuchIsHeld) {
  hello();
  std::vector<Sent> answer = on(FrameType::kPoll, 0);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(answer[0].header.type, FrameType::kAck);
  EXPECT_EQ(answer[0].header.index, 0);
  on(FrameType::kData, 0, 0, testing::fake_output(1, 1));
  answer = on(FrameType::kPoll, 0);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(answer[0].header.step, 0U);
  EXPECT_EQ(answer[0].header.index, 1);
}

TEST_F(FlightExecutiveTest, APollAfterTheStepBringsTheAnswerFromThereOn) {
  say(4);
  hello();
  const std::vector<Sent> answer = tick(0);
  ASSERT_EQ(answer.size(), 5U);
  const std::vector<Sent> again = on(FrameType::kPoll, 0, 2);
  ASSERT_EQ(again.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again[i].header.index, i + 2);
    EXPECT_EQ(again[i].payload, answer[i + 2].payload);
  }
  EXPECT_TRUE(on(FrameType::kPoll, 0, 6).empty());  // more than there is
  EXPECT_EQ(report_of(tick(1)).frames_resent, 3);
  EXPECT_EQ(testing::fake_gnc_steps(), 2);
}

TEST_F(FlightExecutiveTest, ALongAnswerWaitsForAcknowledgements) {
  say(99);
  hello();
  EXPECT_EQ(tick(0).size(), 32U);
  EXPECT_EQ(on(FrameType::kAck, 0, 16).size(), 16U);
  EXPECT_TRUE(on(FrameType::kAck, 0, 16).empty());
  EXPECT_TRUE(on(FrameType::kAck, 0, 200).empty());
  EXPECT_TRUE(on(FrameType::kAck, 1, 48).empty());  // of a step that was not run
  EXPECT_EQ(on(FrameType::kAck, 0, 48).size(), 32U);
  const std::vector<Sent> rest = on(FrameType::kAck, 0, 80);
  EXPECT_EQ(rest.size(), 20U);
  EXPECT_EQ(report_of(rest).step, 0);
}

TEST_F(FlightExecutiveTest, AFullOutboxDropsTheNewestAndCounts) {
  say(400);
  hello();
  std::vector<Sent> answer = tick(0);
  while (!answer.back().header.last) {
    const auto held = static_cast<std::uint16_t>(answer.size());
    const std::vector<Sent> more = on(FrameType::kAck, 0, held);
    answer.insert(answer.end(), more.begin(), more.end());
  }
  ASSERT_EQ(answer.size(), kOutboxPackets);
  for (std::size_t i = 0; i + 1 < answer.size(); ++i) {
    EXPECT_EQ(answer[i].payload, Bytes(30, static_cast<std::uint8_t>(i)));
  }
  EXPECT_EQ(report_of(answer).packets_dropped, 400 - 255);
  say(1);
  EXPECT_EQ(tick(1).size(), 2U);
}

TEST_F(FlightExecutiveTest, APacketTooLongForAFrameIsDroppedAndCounted) {
  say(1, fsw::packets::kMaxPacketBytes + 1);
  hello();
  const std::vector<Sent> answer = tick(0);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(report_of(answer).packets_dropped, 1);
}

TEST_F(FlightExecutiveTest, BrokenFramesAreCountedAndChangeNothing) {
  say(0);
  hello();
  FrameHeader header;
  header.type = FrameType::kData;
  header.session = kSession;
  header.last = true;
  Bytes frame = make_frame(header, tick_packet(0, 0));
  for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_EQ(board_->on_frame(frame), Activity::kIdle);
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
  EXPECT_EQ(board_->on_frame({}), Activity::kIdle);
  board_->count_rejected(5);
  const vbar::step_report report = report_of(tick(0));
  EXPECT_EQ(report.frames_rejected, static_cast<std::int32_t>(frame.size() * 8 + 1 + 5));
  EXPECT_EQ(report.frames_received, static_cast<std::int32_t>(frame.size() * 8 + 1 + 2));
}

TEST_F(FlightExecutiveTest, GoodbyeEndsItsOwnSessionOnly) {
  hello();
  on(FrameType::kGoodbye, 0, 0, {}, false, kSession + 1);
  EXPECT_EQ(activity_, Activity::kIdle);
  on(FrameType::kGoodbye);
  EXPECT_EQ(activity_, Activity::kGoodbye);
}

TEST_F(FlightExecutiveTest, ABoardWithoutCountersReportsNone) {
  Platform bare = platform(this);
  bare.counter = nullptr;
  bare.stack_high_water = nullptr;
  board_ = std::make_unique<FlightExecutive>(bare);
  hello();
  const vbar::step_report report = report_of(tick(0));
  EXPECT_EQ(report.unit, static_cast<std::int8_t>(CounterUnit::kNone));
  EXPECT_EQ(report.count, 0);
  EXPECT_EQ(report.stack_bytes, 0);
}

}  // namespace
}  // namespace vbar::boards
