// The driver's end of a receiver's command port against a receiver on a pseudo-terminal. Commands and answers: OEM6
// Family Firmware Reference Manual, OM-20000129.

#include "hil_drivers/grand/receiver_port.h"

#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/fake_receiver.h"

namespace vbar::grand {

namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Of a receiver that answers, whatever the load of the machine; and of one that does not.
constexpr Patience kPatient{milliseconds(250), milliseconds(5000), milliseconds(60000), 20};
constexpr Patience kShort{milliseconds(60), milliseconds(150), milliseconds(1000), 2};

ReceiverConfiguration configuration() {
  ReceiverConfiguration plan;
  plan.approximate_time = fsw::GpsTime{} + fsw::duration_of_seconds(1658 * 604800LL + 345'675);
  plan.approximate_position_ecef_m = {7'000'000.0, 0.0, 0.0};
  plan.log_offset_s = 4.0;
  return plan;
}

/// The message of the refusal; empty if there was none.
std::string refusal(FakeReceiver& receiver, const ReceiverConfiguration& plan = configuration(),
                    const Patience& patience = kPatient) {
  ReceiverPort port("servicer", receiver.device(), plan, {}, patience);
  try {
    port.open(true);
  } catch (const ReceiverRefusal& error) {
    EXPECT_FALSE(port.is_open());
    return error.what();
  }
  return "";
}

TEST(ReceiverPort, ConfiguresAReceiverAtItsOwnRate) {
  FakeReceiver receiver({.baud = 115200, .answers = {}, .logs = {}});
  ReceiverPort port("servicer", receiver.device(), configuration(), {}, kPatient);
  port.open(true);
  EXPECT_TRUE(port.is_open());
  EXPECT_EQ(port.port_name(), "COM1");
  EXPECT_THAT(receiver.commands(),
              ElementsAre("UNLOGALL THISPORT TRUE", "SETAPPROXTIME 1658 345675.000",
                          HasSubstr("SETAPPROXPOS 0.000000 0.000000 621863.0"), "CLOCKADJUST ENABLE",
                          "LOG THISPORT RANGEB ONTIME 10 4", "LOG THISPORT RAWEPHEMB ONCHANGED",
                          "LOG THISPORT GALEPHEMERISB ONCHANGED", "LOG THISPORT BDSEPHEMERISB ONCHANGED",
                          "LOG THISPORT IONUTCB ONCHANGED", "LOG THISPORT BESTXYZB ONTIME 10 4",
                          "LOG THISPORT TIMEB ONTIME 10 4"));
}

TEST(ReceiverPort, FindsEveryRateAndSetsTheConfiguredOne) {
  for (const unsigned rate : {2400U, 9600U, 57600U, 460800U}) {
    FakeReceiver receiver({.baud = rate, .answers = {}, .logs = {}});
    EXPECT_EQ(refusal(receiver), "") << rate;
    EXPECT_EQ(receiver.baud(), 115200U) << rate;
    EXPECT_THAT(receiver.commands(), Contains("SERIALCONFIG THISPORT 115200 N 8 1 N ON"));
  }
}

TEST(ReceiverPort, FindsAnswersInGarbage) {
  FakeReceiver receiver({.baud = 9600, .answers = {}, .logs = {}, .sends_garbage_before_answers = true});
  EXPECT_EQ(refusal(receiver), "");
}

TEST(ReceiverPort, NamesPortCommandAndAnswerOfARefusal) {
  FakeReceiver receiver(
      {.baud = 115200, .answers = {{"LOG THISPORT GALEPHEMERISB", "<ERROR:Invalid Message ID"}}, .logs = {}});
  EXPECT_THAT(refusal(receiver), AllOf(HasSubstr("servicer"), HasSubstr(receiver.device()),
                                       HasSubstr("\"LOG THISPORT GALEPHEMERISB ONCHANGED\" was refused"),
                                       HasSubstr("\"<ERROR:Invalid Message ID\"")));
}

TEST(ReceiverPort, NamesACommandThatIsNotAnswered) {
  FakeReceiver receiver({.baud = 115200, .answers = {{"CLOCKADJUST", ""}}, .logs = {}});
  constexpr Patience kTwoAttempts{milliseconds(500), milliseconds(400), milliseconds(1000), 2};
  EXPECT_THAT(
      refusal(receiver, configuration(), kTwoAttempts),
      AllOf(HasSubstr(receiver.device()), HasSubstr("\"CLOCKADJUST ENABLE\" was not answered in 2 attempts of 0.4 s"),
            HasSubstr("nothing received")));
  EXPECT_EQ(std::ranges::count(receiver.commands(), "CLOCKADJUST ENABLE"), 2);
}

TEST(ReceiverPort, ShowsWhatCameInsteadOfAnAnswer) {
  FakeReceiver receiver({.baud = 115200, .answers = {{"CLOCKADJUST", "HELLO"}}, .logs = {}});
  constexpr Patience kTwoAttempts{milliseconds(500), milliseconds(400), milliseconds(1000), 2};
  EXPECT_THAT(refusal(receiver, configuration(), kTwoAttempts), HasSubstr("HELLO"));
}

TEST(ReceiverPort, NamesASilentLine) {
  FakeReceiver receiver({.baud = 115200, .answers = {{"", ""}}, .logs = {}});
  EXPECT_THAT(refusal(receiver, configuration(), kShort),
              AllOf(HasSubstr(receiver.device()), HasSubstr("2400 to 460800 baud")));
}

TEST(ReceiverPort, RestartsForAColdStartOnly) {
  ReceiverConfiguration cold = configuration();
  cold.start = twins::gnss::StartMode::kCold;
  FakeReceiver receiver({.baud = 115200, .answers = {}, .logs = {}});
  EXPECT_EQ(refusal(receiver, cold), "");
  EXPECT_THAT(receiver.commands(), AllOf(Contains("RESET"), Not(Contains(HasSubstr("SETAPPROX")))));
  EXPECT_EQ(receiver.baud(), 115200U);  // after the factory's 9600

  FakeReceiver warm({.baud = 115200, .answers = {}, .logs = {}});
  EXPECT_EQ(refusal(warm), "");
  EXPECT_THAT(warm.commands(), Not(Contains("RESET")));

  FakeReceiver again({.baud = 115200, .answers = {}, .logs = {}});
  ReceiverPort port("servicer", again.device(), cold, {}, kPatient);
  port.open(false);
  EXPECT_THAT(again.commands(), Not(Contains("RESET")));
}

TEST(ReceiverPort, LosesNothingOfALogThatFollowsItsCommand) {
  const Bytes log{0xAA, 0x44, 0x12, 1, 2, 3};
  FakeReceiver receiver({.baud = 115200, .answers = {}, .logs = {{"LOG THISPORT IONUTCB", log}}});
  Bytes kept;
  ReceiverPort port(
      "servicer", receiver.device(), configuration(),
      [&](std::span<const std::uint8_t> bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); }, kPatient);
  port.open(true);
  Bytes read;
  port.read(read);
  EXPECT_NE(std::search(read.begin(), read.end(), log.begin(), log.end()), read.end());
  EXPECT_NE(std::search(kept.begin(), kept.end(), log.begin(), log.end()), kept.end());
  const std::size_t before = kept.size();
  receiver.send({7, 8, 9});
  read.clear();
  port.read(read);
  EXPECT_EQ(read, (Bytes{7, 8, 9}));
  EXPECT_EQ(kept.size(), before + 3);
}

TEST(ReceiverPort, ReportsAHangUpAndOpensAgain) {
  FakeReceiver receiver({.baud = 115200, .answers = {}, .logs = {}});
  ReceiverPort port("servicer", receiver.device(), configuration(), {}, kPatient);
  port.open(true);
  receiver.hang_up();
  Bytes bytes;
  EXPECT_THROW(port.read(bytes), io::ChannelError);
  EXPECT_FALSE(port.is_open());
  EXPECT_THROW(port.open(false), io::ChannelError);
  receiver.come_back();
  port.open(false);
  EXPECT_TRUE(port.is_open());
  EXPECT_EQ(std::ranges::count(receiver.commands(), "CLOCKADJUST ENABLE"), 2);
}

TEST(ReceiverPort, ASearchCanBeAbandoned) {
  FakeReceiver receiver({.baud = 115200, .answers = {{"", ""}}, .logs = {}});
  ReceiverPort port("servicer", receiver.device(), configuration(), {}, Patience{});
  EXPECT_THROW(port.open(true, {.now = {}, .wait = {}, .abandoned = [] { return true; }}), ReceiverRefusal);
}

}  // namespace

// Answers to abbreviated ASCII commands (OEM6 Family Firmware Reference Manual, 1.4).

namespace {

std::vector<std::uint8_t> bytes(std::string_view text) {
  return {text.begin(), text.end()};
}

TEST(CommandAnswer, IsFoundOnceComplete) {
  EXPECT_FALSE(find_answer(bytes("")).has_value());
  EXPECT_FALSE(find_answer(bytes("\r\n<O")).has_value());
  EXPECT_TRUE(find_answer(bytes("\r\n<OK"))->is_accepted);
  EXPECT_FALSE(find_answer(bytes("\r\n<ERROR:Invalid Mess")).has_value());
  const auto refusal = find_answer(bytes("\r\n<ERROR:Invalid Message ID\r\n[COM1]"));
  ASSERT_TRUE(refusal.has_value());
  EXPECT_FALSE(refusal->is_accepted);
  EXPECT_EQ(refusal->text, "<ERROR:Invalid Message ID");
}

TEST(CommandAnswer, IgnoresGarbageThatResemblesOne) {
  EXPECT_FALSE(find_answer(bytes("<<<<ERR<")).has_value());
  EXPECT_FALSE(find_answer(bytes(std::string("<ERROR:").append(300, 'x').append("\r\n"))).has_value());
  EXPECT_FALSE(find_answer(bytes("<ERROR:\x01\x02\r\n")).has_value());
  EXPECT_TRUE(find_answer(bytes("<ERROR:\x01\x02\r\n<OK"))->is_accepted);
}

TEST(CommandAnswer, PromptNamesThePort) {
  EXPECT_EQ(find_prompt(bytes("<OK\r\n[COM2]")), "COM2");
  EXPECT_EQ(find_prompt(bytes("[COM1][USB3]")), "USB3");
  EXPECT_FALSE(find_prompt(bytes("[COM")).has_value());
  EXPECT_FALSE(find_prompt(bytes("[12]")).has_value());
}

TEST(CommandAnswer, IsShownInPrintableForm) {
  EXPECT_EQ(printable(bytes("a\r\x80")), "a\\x0d\\x80");
  EXPECT_EQ(printable(bytes("abcdef"), 3), "abc...");
}

}  // namespace

// Commands of a run (OEM6 Family Firmware Reference Manual: LOG, SERIALCONFIG).

namespace {

TEST(Configuration, AsksTheConfiguredRateThenTheFactorys) {
  EXPECT_THAT(rates_to_ask(115200), ElementsAre(115200, 9600, 230400, 460800, 57600, 38400, 19200, 4800, 2400));
  EXPECT_EQ(rates_to_ask(9600).size(), 9U);
  EXPECT_EQ(rates_to_ask(9600).front(), 9600U);
}

TEST(Configuration, LogsToTheBoardBesidesTheHost) {
  ReceiverConfiguration plan;
  plan.board_port = "COM2";
  plan.period_s = 1.0;
  plan.log_offset_s = 0.5;
  plan.clock_adjust = false;
  plan.approximate_position_ecef_m = {0.0, 7'000'000.0, 0.0};
  const auto commands = configuration_commands(plan);
  for (const char* const expected :
       {"UNLOGALL COM2 TRUE", "LOG COM2 RANGEB ONTIME 1 0.5", "LOG COM2 TIMEB ONTIME 1 0.5",
        "LOG THISPORT RANGEB ONTIME 1 0.5", "CLOCKADJUST DISABLE"})
    EXPECT_THAT(commands, Contains(expected));
  EXPECT_EQ(commands.back(), "LOG THISPORT TIMEB ONTIME 1 0.5");  // which completes a burst
}

}  // namespace

}  // namespace vbar::grand
