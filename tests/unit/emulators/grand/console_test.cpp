// Commands and answers: OEM6 Firmware Reference Manual OM-20000129, and two messages of NovAtel's own decoder.

#include "emulators/grand/receiver/console.h"

#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/grand/receiver/logs.h"
#include "emulators/grand/receiver/serial_line.h"
#include "fsw/gnss/oem_stream.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "tests/unit/emulators/grand/receiver_session.h"

namespace vbar::grand::bench::test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

std::vector<std::uint8_t> bytes_of_hex(std::string_view hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 0; k + 1 < hex.size(); k += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(hex.substr(k, 2)), nullptr, 16)));
  return bytes;
}

/// "LOG COM1 BESTPOSB ONTIME 1" in binary, with the right CRC.
const std::vector<std::uint8_t> kBinaryLog = bytes_of_hex(
    "AA44121C010000C02000000000FF0000000000000000000000000000200000002A00000002000000000000000000F03F0000000"
    "0000000000000000034D32DC1");
/// The same in ASCII.
constexpr std::string_view kAsciiLog =
    "#LOGA,THISPORT,0,0,UNKNOWN,0,0.0,0,0,0;COM1,BESTPOSB,ONTIME,1.000000,0.000000,NOHOLD*ec9ce601";

/// A console alone: what it has executed and answered.
struct Desk {
  std::vector<Command> executed;
  std::string said;
  Response response;
  Console console{0,
                  {[this](int, const Command& command) {
                     executed.push_back(command);
                     return response;
                   },
                   [](int) { return twins::gnss::oem::Header{}; },
                   [this](int, std::span<const std::uint8_t> bytes) { said.append(bytes.begin(), bytes.end()); }}};

  std::string tell(std::string_view text) {
    said.clear();
    console.listen({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, 0);
    return said;
  }
};

TEST(Console, ReadsAbbreviatedAscii) {
  Desk desk;
  EXPECT_EQ(desk.tell("log com2 rangeb ontime 10 9\r\n"), "<OK\r\n[COM1]");
  ASSERT_EQ(desk.executed.size(), 1U);
  const Command& log = desk.executed.front();
  EXPECT_EQ(log.id, CommandId::kLog);
  EXPECT_EQ(log.whole(0), 64U);
  EXPECT_EQ(log.message_id(1), 43U);
  EXPECT_EQ(log.format(1), LogFormat::kBinary);
  EXPECT_EQ(log.whole(2), static_cast<std::uint32_t>(Trigger::kOnTime));
  EXPECT_EQ(log.values[3], 10.0);
  EXPECT_EQ(log.values[4], 9.0);
  EXPECT_EQ(log.whole(5), 0U);
}

// Port, trigger, period and hold have defaults.
TEST(Console, FillsInDefaults) {
  Desk desk;
  EXPECT_EQ(desk.tell("LOG RAWEPHEMB\rUNLOGALL\rUNLOGALL THISPORT TRUE\rSERIALCONFIG COM1 115200\r"),
            "<OK\r\n[COM1]<OK\r\n[COM1]<OK\r\n[COM1]<OK\r\n[COM1]");
  ASSERT_EQ(desk.executed.size(), 4U);
  EXPECT_EQ(desk.executed[0].whole(0), 192U);
  EXPECT_EQ(desk.executed[0].whole(2), kDefaultTrigger);
  EXPECT_EQ(desk.executed[1].whole(0), 8U);
  EXPECT_EQ(desk.executed[1].whole(1), 0U);
  EXPECT_EQ(desk.executed[2].whole(0), 192U);
  EXPECT_EQ(desk.executed[2].whole(1), 1U);
  EXPECT_EQ(desk.executed[3].whole(1), 115200U);
  EXPECT_EQ(desk.executed[3].whole(3), 8U);
}

TEST(Console, AsciiAndBinaryFormsAreTheSameCommand) {
  Desk desk;
  EXPECT_THAT(desk.tell(std::string(kAsciiLog).append("\r\n")), HasSubstr(";OK*"));
  EXPECT_TRUE(desk.said.starts_with("#LOGR,COM1,"));
  desk.console.listen(kBinaryLog, 0);
  ASSERT_EQ(desk.executed.size(), 2U);
  EXPECT_EQ(desk.executed[0].values, desk.executed[1].values);
  EXPECT_EQ(desk.executed[0].message_id(1), 42U);
  EXPECT_EQ(desk.executed[0].values[3], 1.0);
}

// The same number as the command, the response bit, body 1 and "OK" (the layout of NovAtel's decoder's own test
// vector).
TEST(Console, AnswersABinaryCommandInBinary) {
  Desk desk;
  desk.console.listen(kBinaryLog, 0);
  fsw::gnss::OemStream stream;
  bool complete = false;
  for (const char c : desk.said) complete = stream.push(static_cast<std::uint8_t>(c));
  ASSERT_TRUE(complete);
  const fsw::gnss::OemMessage message = stream.message();
  EXPECT_EQ(message.id, 1);
  EXPECT_TRUE(message.is_response);
  const std::vector<std::uint8_t> body(message.body.begin(), message.body.end());
  EXPECT_EQ(body, (std::vector<std::uint8_t>{1, 0, 0, 0, 'O', 'K'}));
}

// The CRC of the answer is that of the text between '#' and '*', by the function that reproduces the vector's.
TEST(Console, AsciiAnswersCarryACrc) {
  Desk desk;
  const std::string answer = desk.tell(std::string(kAsciiLog).append("\r\n"));
  ASSERT_THAT(answer, EndsWith("\r\n"));
  const std::string text = answer.substr(1, answer.find('*') - 1);
  EXPECT_EQ(std::stoul(answer.substr(answer.find('*') + 1, 8), nullptr, 16),
            twins::gnss::oem::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  Desk echo;
  EXPECT_THAT(echo.tell(answer), HasSubstr(";ERROR:Message is incorrect*"));  // an answer is not a command
  EXPECT_THAT(echo.tell("#LOGA,COM1;COM1,RANGEB,ONCE*00000000\r\n"), HasSubstr(";ERROR:Invalid Checksum*"));
  EXPECT_TRUE(echo.executed.empty());
}

TEST(Console, RefusesWithTheManualsResponses) {
  Desk desk;
  const auto answer = [&desk](std::string_view line) { return desk.tell(std::string(line) + "\r\n"); };
  EXPECT_EQ(answer("LOGG RANGEB ONCE"), "<ERROR:Invalid Message ID\r\n[COM1]");
  EXPECT_EQ(answer("LOG RANGEX ONCE"), "<ERROR:Requested log does not exist\r\n[COM1]");
  EXPECT_EQ(answer("LOG RANGEB SOMETIMES"), "<ERROR:Invalid Message. Field = 3\r\n[COM1]");
  EXPECT_EQ(answer("LOG"), "<ERROR:Message missing field\r\n[COM1]");
  EXPECT_EQ(answer("LOG RANGEB ONTIME 1 0 NOHOLD 7"), "<ERROR:Message is incorrect\r\n[COM1]");
  EXPECT_EQ(answer("SETAPPROXTIME 1660"), "<ERROR:Message missing field\r\n[COM1]");
  EXPECT_EQ(answer("SETAPPROXPOS 91 0 0"), "<ERROR:Parameter 1 is out of range\r\n[COM1]");
  EXPECT_EQ(answer("SETAPPROXPOS nan 0 0"), "<ERROR:Invalid Message. Field = 1\r\n[COM1]");
  EXPECT_EQ(answer("CSMOOTH 1"), "<ERROR:Parameter 1 is out of range\r\n[COM1]");
  EXPECT_EQ(answer("CLOCKADJUST"), "<ERROR:Message missing field\r\n[COM1]");
  EXPECT_TRUE(desk.executed.empty());
  EXPECT_EQ(desk.console.refused(), 10U);
}

TEST(Console, AnEmptyLinePromptsAgain) {
  Desk desk;
  EXPECT_EQ(desk.tell("\r\n"), "\r\n[COM1]");
}

// Noise between commands costs at most the line it falls into.
TEST(Console, RecoversFromGarbage) {
  Desk desk;
  std::string garbage;
  for (int k = 0; k < 5000; ++k) garbage.push_back(static_cast<char>((k * 73 + k / 7) % 256));
  desk.tell(garbage);
  desk.console.listen(bytes_of_hex("AA44121CFFFF00C0FFFF"), 0);  // announces 65 kB
  desk.tell("\r\n");
  desk.executed.clear();
  // After a second of silence an unfinished binary command is given up.
  const std::string line = "\r\nLOG VERSIONB ONCE\r\n";
  desk.console.listen({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, 2'000'000'000);
  EXPECT_EQ(desk.executed.size(), 1U);
}

TEST(Console, AnUnfinishedBinaryCommandIsGivenUp) {
  Desk desk;
  desk.console.listen(std::span(kBinaryLog).first(40), 0);
  const std::string line = "LOG VERSIONB ONCE\r\n";
  desk.console.listen({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, 2'000'000'000);
  EXPECT_EQ(desk.executed.size(), 1U);
  desk.console.listen(kBinaryLog, 2'000'000'000);
  EXPECT_EQ(desk.executed.size(), 2U);
}

TEST(Console, ALineTooLongIsNoCommand) {
  Desk desk;
  EXPECT_EQ(desk.tell("LOG RANGEB ONCE" + std::string(Console::kMaxLine, ' ') + "\r\n"), "");
  EXPECT_EQ(desk.tell("LOG RANGEB ONCE\r\n"), "<OK\r\n[COM1]");
}

// ---- on the receiver ----

TEST(ReceiverConsole, PromptsAfterPowerUpAndNotBefore) {
  Receiver receiver({}, ReceiverSession::constellation(), 1, "servicer");
  receiver.power(true);
  const std::string line = "LOG VERSIONB ONCE\r\n";
  receiver.listen(0, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, 115200);
  receiver.idle(fsw::Duration{1'900'000'000});
  EXPECT_TRUE(receiver.speak(0).empty());
  receiver.idle(fsw::Duration{200'000'000});
  const auto said = receiver.speak(0);
  EXPECT_EQ(std::string(said.begin(), said.end()), "\r\n[COM1]");  // the command came too early and is lost
  const auto other = receiver.speak(1);
  EXPECT_EQ(std::string(other.begin(), other.end()), "\r\n[COM2]");
  EXPECT_FALSE(receiver.busy());
}

TEST(ReceiverConsole, GivesItsVersion) {
  ReceiverSession session;
  const std::string binary = session.command("LOG VERSIONB ONCE");
  EXPECT_TRUE(binary.starts_with("<OK\r\n[COM1]"));
  EXPECT_EQ(decode({binary.begin(), binary.end()}).stream.messages, 1U);
  const std::string ascii = session.command("LOG VERSIONA ONCE");
  EXPECT_THAT(ascii, HasSubstr("#VERSIONA,COM1,0,90.0,UNKNOWN,0,0.000,00080000,0000,0;1,GPSCARD,\"VBAR-EMULATED\""));
}

TEST(ReceiverConsole, AnswersOnItsOwnPortForAnother) {
  ReceiverSession session;
  EXPECT_EQ(session.command("LOG COM2 VERSIONA ONCE"), "<OK\r\n[COM1]");
  EXPECT_EQ(session.command("LOG THISPORT VERSIONA ONCE", 1).substr(0, 11), "<OK\r\n[COM2]");
}

TEST(ReceiverConsole, HoldsThirtyLogs) {
  ReceiverSession session;
  // Eleven logs on each of two ports in binary, two of them in two more formats; one is there from the start on each.
  const std::vector<std::string> names{"GPSEPHEM", "IONUTC",  "RAWEPHEM", "BESTPOS",      "RANGE",
                                       "TIME",     "BESTXYZ", "VERSION",  "GALEPHEMERIS", "BDSEPHEMERIS"};
  int accepted = 2;
  std::string last;
  for (const char* port : {"COM1 ", "COM2 "}) {
    for (const std::string& name : names) {
      last = session.command("LOG " + std::string(port) + name + "B ONTIME 10");
      accepted += last == "<OK\r\n[COM1]" ? 1 : 0;
    }
    for (const char* more : {"VERSIONA ONTIME 10", "VERSION ONTIME 10", "RXSTATUSEVENTB ONNEW", "RXSTATUSEVENT ONNEW",
                             "RXSTATUSEVENTA ONNEW"}) {
      last = session.command("LOG " + std::string(port) + more);
      if (std::string_view(more) != "RXSTATUSEVENTA ONNEW") accepted += last == "<OK\r\n[COM1]" ? 1 : 0;
    }
  }
  EXPECT_EQ(accepted, 30);
  EXPECT_EQ(session.command("UNLOGALL"), "<OK\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEB ONTIME 10"), "<OK\r\n[COM1]");
}

TEST(ReceiverConsole, TheThirtyFirstLogIsRefused) {
  LogList logs;
  Command command{CommandId::kLog, {}};
  Response response;
  std::size_t accepted = 0;
  for (int port = 0; port < 4; ++port) {
    for (const LogKind& kind : kLogKinds) {
      if (kind.log_class == LogClass::kEvent) continue;
      command.values[1] = static_cast<double>(kind.id);
      command.values[2] = static_cast<double>(Trigger::kOnTime);
      command.values[3] = 10.0;
      response = logs.add(command, port);
      accepted += response.ok() ? 1 : 0;
    }
  }
  EXPECT_EQ(accepted, 30U);
  EXPECT_EQ(response.id, 3U);
}

TEST(ReceiverConsole, RefusesTriggersRatesAndOffsets) {
  ReceiverSession session;
  EXPECT_EQ(session.command("LOG RANGEB ONCHANGED"), "<ERROR:Trigger 3 not valid for this log\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEB ONMARK"), "<ERROR:Trigger 3 not valid for this log\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEB ONTIME 0.07"), "<ERROR:Requested rate is invalid\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEB ONTIME 0"), "<ERROR:Requested rate is invalid\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEB ONTIME 10 10"), "<ERROR:Invalid offset\r\n[COM1]");
  EXPECT_EQ(session.command("LOG COM3 RANGEB ONTIME 10"), "<ERROR:Unknown COM port requested\r\n[COM1]");
  EXPECT_EQ(session.command("LOG RANGEA ONTIME 10"), "<ERROR:Requested log does not exist\r\n[COM1]");
  EXPECT_EQ(session.command("SERIALCONFIG COM1 12345"), "<ERROR:Invalid baud rate\r\n[COM1]");
}

// The answer leaves at the old rate; then the port is at the new one.
TEST(ReceiverConsole, ChangesItsBaudRate) {
  ReceiverSession session;
  EXPECT_EQ(session.receiver.baud(0), 115200U);
  EXPECT_EQ(session.command("SERIALCONFIG COM1 9600 N 8 1 N OFF"), "<OK\r\n[COM1]");
  EXPECT_EQ(session.receiver.baud(0), 9600U);
  EXPECT_EQ(session.receiver.baud(1), 115200U);
  EXPECT_EQ(session.command("COM COM2 19200"), "<OK\r\n[COM1]");
  EXPECT_EQ(session.receiver.baud(1), 19200U);
}

TEST(ReceiverConsole, AWrongRateIsGarbageBothWays) {
  ReceiverSession session;
  const std::string line = "LOG VERSIONB ONCE\r\n";
  session.receiver.listen(0, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, 9600);
  EXPECT_EQ(session.settle(), "");
  EXPECT_EQ(session.receiver.report().garbage_bytes, line.size());
  session.send("\r\n\r\n");  // ends whatever the noise began
  session.settle();
  session.send(line);
  session.receiver.idle(fsw::Duration{500'000'000});
  const auto heard = session.receiver.speak(0, 9600);
  EXPECT_FALSE(heard.empty());
  EXPECT_EQ(std::string(heard.begin(), heard.end()).find("OK"), std::string::npos);
  EXPECT_EQ(decode(heard).stream.messages, 0U);
}

TEST(ReceiverConsole, ResetBootsAgainAndForgetsLogs) {
  ReceiverSession session;
  session.command("LOG RANGEB ONTIME 1");
  const std::string said = session.command("RESET");
  EXPECT_EQ(said, "<OK\r\n[COM1]\r\n[COM1]");  // the answer, and the prompt after booting
  session.fly(5.0);
  EXPECT_EQ(decode(session.heard[0]).stream.messages, 0U);
}

TEST(ReceiverConsole, FactoryResetGoesTo9600) {
  ReceiverSession session;
  session.command("FRESET");
  EXPECT_EQ(session.receiver.baud(0), kFactoryBaud);
}

TEST(ReceiverConsole, TwoBreaksResetThePort) {
  ReceiverSession session;
  session.receiver.line_break(0);
  EXPECT_EQ(session.receiver.baud(0), 115200U);
  session.receiver.idle(fsw::Duration{1'500'000'000});
  session.receiver.line_break(0);
  EXPECT_EQ(session.receiver.baud(0), kFactoryBaud);
}

TEST(ReceiverConsole, SavedConfigurationSurvivesAReset) {
  ReceiverSession session;
  session.command("SERIALCONFIG COM1 57600");
  session.command("SAVECONFIG");
  session.command("RESET");
  EXPECT_EQ(session.receiver.baud(0), 57600U);
}

// The manual's own example of the log has this form:
// #RXSTATUSEVENTA,COM1,0,17.0,FREEWHEELING,1337,408334.510,00480000,b967,1984;STATUS,19,SET,"No Valid ..."*6de945ad
TEST(ReceiverConsole, ReportsStatusEvents) {
  ReceiverSession session;
  session.warm_start();
  session.fly(60.0);
  const std::string text(session.heard[0].begin(), session.heard[0].end());
  EXPECT_THAT(text, HasSubstr("STATUS,19,CLEAR,\"Valid Position Calculated\"*"));
}

}  // namespace
}  // namespace vbar::grand::bench::test
