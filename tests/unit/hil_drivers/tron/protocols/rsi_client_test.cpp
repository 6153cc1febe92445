// The computer's end of RSI against a socket that plays the robot.

#include "hil_drivers/tron/protocols/rsi_client.h"

#include <cmath>
#include <limits>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/protocols/rsi_messages.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/mission/data_file.h"

namespace vbar::tron::rsi {

namespace {

using namespace std::chrono_literals;
using boost::asio::ip::udp;
constexpr auto kPatience = 60s;

ClientSettings camera_settings() {
  const TestbedDesign bench = read_testbed_design(mission::data_directory() / "benches" / "tron.toml");
  ClientSettings settings =
      client_settings("camera robot", bench.camera_robot, &bench.track, robot_files(kCameraRobot));
  settings.port = 0;
  return settings;
}

class PlayedRobot {
 public:
  explicit PlayedRobot(std::uint16_t computer_port, const std::string& address = "127.0.20.1")
      : socket_(context_, {boost::asio::ip::make_address_v4(address), 0}),
        computer_(boost::asio::ip::address_v4::loopback(), computer_port) {
    socket_.non_blocking(true);
    rob.axes_deg = {0.0, -120.0, 120.0, 0.0, 10.0, 0.0};
    rob.external_mm[0] = -500.0;
  }
  void send_text(const std::string& text) { socket_.send_to(boost::asio::buffer(text), computer_); }
  void send(const std::string& ipoc) {
    rob.ipoc = {ipoc, 0};
    std::string text;
    ASSERT_TRUE(encode(rob, robot_files(kCameraRobot).ethernet, 4, text));
    send_text(text);
  }
  /// The answer that has arrived, or empty.
  std::string received() {
    std::string text(2000, '\0');
    boost::system::error_code error;
    udp::endpoint sender;
    text.resize(socket_.receive_from(boost::asio::buffer(text), sender, 0, error));
    return error ? "" : text;
  }
  Rob rob;

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
  udp::endpoint computer_;
};

TEST(RsiClient, AnswersWithTheTextOfTheIpocAndOffsetsFromTheFirstState) {
  Client client(camera_settings());
  EXPECT_EQ("camera robot at RSI port " + std::to_string(client.port()), client.description());
  PlayedRobot robot(client.port());
  robot.send("000100");
  auto state = client.receive(kPatience);
  ASSERT_TRUE(state);
  EXPECT_NEAR(-120.0, state->measured.axes_rad[1] * kDegreesPerRadian, 1e-12);
  EXPECT_DOUBLE_EQ(-0.5, state->measured.track_m);
  EXPECT_EQ(0U, state->cycle);
  AxisPositions command = client.zero();
  command.axes_rad[3] += 0.001 / kDegreesPerRadian;
  client.answer(command);
  EXPECT_EQ(
      "<Sen Type=\"VBAR\"><Stop>0</Stop><AK A1=\"0.0000\" A2=\"0.0000\" A3=\"0.0000\" A4=\"0.0010\" A5=\"0.0000\" "
      "A6=\"0.0000\"/><EK E1=\"0.0000\"/><IPOC>000100</IPOC></Sen>",
      robot.received());
  // It answers, once, and never by itself.
  EXPECT_EQ("", robot.received());
  EXPECT_THROW(client.answer(command), RsiError);
  // The zero remains where the first state was.
  robot.rob.axes_deg[3] = 0.001;
  robot.send("000104");
  state = client.receive(kPatience);
  ASSERT_TRUE(state);
  EXPECT_EQ(1U, state->cycle);
  EXPECT_FALSE(state->ipoc_not_newer);
  client.answer_stop();
  EXPECT_THAT(robot.received(),
              testing::AllOf(testing::HasSubstr("<Stop>1</Stop>"), testing::HasSubstr("A4=\"0.0010\""),
                             testing::HasSubstr("<IPOC>000104</IPOC>")));
}

TEST(RsiClient, ACommandBeyondALimitIsNotSent) {
  Client client(camera_settings());
  PlayedRobot robot(client.port());
  robot.send("100");
  ASSERT_TRUE(client.receive(kPatience));
  AxisPositions command = client.zero();
  command.axes_rad[1] += 0.01;
  try {
    client.answer(command);
    FAIL();
  } catch (const CommandRefused& error) {
    EXPECT_EQ(client.description() + ": command refused: A2: acceleration 35809.8622 deg/s2; accepted: up to 99.1217",
              std::string(error.what()));
  }
  EXPECT_EQ("", robot.received());
  // The state still waits for an answer.
  client.answer(client.last_command());
  EXPECT_NE("", robot.received());
}

TEST(RsiClient, CountsDelayInARowAndNoticesAnOlderIpoc) {
  Client client(camera_settings());
  PlayedRobot robot(client.port());
  const auto turn = [&](std::uint64_t delay, const std::string& ipoc) {
    robot.rob.delay = delay;
    robot.send(ipoc);
    const auto state = client.receive(kPatience);
    EXPECT_TRUE(state);
    client.answer(client.last_command());
    return state.value_or(State{});
  };
  EXPECT_EQ(0, turn(3, "100").delayed_in_row);  // of an earlier time
  EXPECT_EQ(1, turn(4, "104").delayed_in_row);
  EXPECT_EQ(2, turn(5, "108").delayed_in_row);
  EXPECT_EQ(0, turn(5, "112").delayed_in_row);
  EXPECT_FALSE(turn(5, "116").ipoc_not_newer);
  EXPECT_TRUE(turn(5, "116").ipoc_not_newer);
  EXPECT_TRUE(turn(5, "20").ipoc_not_newer);
  EXPECT_FALSE(turn(5, "24").ipoc_not_newer);
}

TEST(RsiClient, NoticesSilence) {
  Client client(camera_settings());
  EXPECT_FALSE(client.receive(0ms));
  EXPECT_FALSE(client.receive(20ms));
}

TEST(RsiClient, ForeignAndUnreadableDatagramsAreIgnored) {
  Client client(camera_settings());
  PlayedRobot foreign(client.port(), "127.0.20.9"), robot(client.port());
  foreign.send("100");
  robot.send_text("<Rob>short</Rob>");
  EXPECT_FALSE(client.receive(0ms));
  EXPECT_EQ(1U, client.foreign_datagrams());
  EXPECT_EQ(1U, client.unreadable_datagrams());
  EXPECT_EQ("<Rob> has no Type \"KUKA\"", client.last_problem());
  EXPECT_THROW(client.answer({}), RsiError);
}

TEST(RsiClient, OfSeveralStatesTheNewestIsAnswered) {
  Client client(camera_settings());
  PlayedRobot robot(client.port());
  robot.send("100");
  robot.send("104");
  robot.send("108");
  const auto state = client.receive(kPatience);
  ASSERT_TRUE(state);
  EXPECT_EQ(2U, state->skipped);
  client.answer(client.zero());
  EXPECT_THAT(robot.received(), testing::HasSubstr("<IPOC>108</IPOC>"));
}

TEST(RsiClient, AfterARestartTheZeroIsWhereTheRobotStands) {
  Client client(camera_settings());
  {
    PlayedRobot robot(client.port());
    robot.send("100");
    ASSERT_TRUE(client.receive(kPatience));
    client.answer(client.zero());
    robot.send("104");  // on its way when RSI ended
  }
  client.restart();
  PlayedRobot robot(client.port());  // another ephemeral port
  robot.rob.axes_deg[0] = 33.0;
  robot.send("8");
  const auto state = client.receive(kPatience);
  ASSERT_TRUE(state);
  EXPECT_EQ(0U, state->cycle);
  EXPECT_FALSE(state->ipoc_not_newer);
  EXPECT_NEAR(33.0, client.zero().axes_rad[0] * kDegreesPerRadian, 1e-12);
  client.answer(client.zero());
  EXPECT_THAT(robot.received(), testing::HasSubstr("A1=\"0.0000\""));
}

TEST(RsiClient, APortThatIsTakenIsNamed) {
  Client first(camera_settings());
  ClientSettings settings = camera_settings();
  settings.port = first.port();
  try {
    Client second(settings);
    FAIL();
  } catch (const RsiError& error) {
    EXPECT_THAT(error.what(),
                testing::StartsWith("camera robot: UDP port " + std::to_string(first.port()) + " is not available: "));
  }
}

}  // namespace

namespace {

using testing::StartsWith;

CommandCheck check_of(double speed, double acceleration) {
  std::array<CommandLimits, kWireAxes> axes{};
  axes.fill({-2.0, 2.0, speed, acceleration, {-60.0, 60.0, 0}});
  return {axes, CommandLimits{-3.5, 3.5, 1.0, 0.8, {-7000.0, 7000.0, 0}}};
}

AxisPositions at(int axis, double value) {
  AxisPositions positions;
  positions.axes_rad[axis] = value;
  return positions;
}

TEST(CommandCheck, NamesAxisValueAndLimit) {
  CommandCheck check = check_of(1.0, 10.0);
  check.begin(at(2, 0.5));
  // 0.0041 rad in 4 ms: 1.025 rad/s.
  EXPECT_EQ("A3: speed 58.7282 deg/s; accepted: up to 57.2958", check.advance(at(2, 0.5041)));
  // 0.001 rad in the first cycle: 62.5 rad/s2.
  EXPECT_EQ("A3: acceleration 3580.9862 deg/s2; accepted: up to 572.9578", check.advance(at(2, 0.501)));
  EXPECT_EQ("", check.advance(at(2, 0.5 + 9.9 * 16e-6)));
  EXPECT_EQ("", check.advance(at(2, 0.5 + 3 * 9.9 * 16e-6)));
  // Refused commands have left no trace: the next one is judged from the last accepted.
  EXPECT_THAT(check.advance(at(2, 0.5)), StartsWith("A3: acceleration"));
  EXPECT_DOUBLE_EQ(0.5 + 3 * 9.9 * 16e-6, check.last().axes_rad[2]);
  EXPECT_DOUBLE_EQ(0.5, check.zero().axes_rad[2]);
}

TEST(CommandCheck, RefusesPositionsAndCorrectionsBeyondTheirRange) {
  CommandCheck fast = check_of(1e6, 1e9);
  fast.begin({});
  EXPECT_THAT(fast.advance(at(1, 2.1)), StartsWith("A2: position 120.3211 deg; accepted: -114.5916 to 114.5916"));
  EXPECT_THAT(fast.advance(at(1, -1.1)), StartsWith("A2: correction -63.0254 deg; accepted: -60.0000 to 60.0000"));
  AxisPositions track;
  track.track_m = 3.6;
  EXPECT_THAT(fast.advance(track), StartsWith("E1: position 3600.0000 mm"));
  EXPECT_EQ("", fast.advance(at(1, 1.0)));
}

TEST(CommandCheck, AnAxisBeyondItsRangeMayComeBack) {
  CommandCheck check = check_of(1e6, 1e9);
  check.begin(at(0, 2.001));
  EXPECT_EQ("", check.advance(at(0, 2.001)));
  EXPECT_THAT(check.advance(at(0, 2.002)), StartsWith("A1: position"));
  EXPECT_EQ("", check.advance(at(0, 2.0005)));
}

TEST(CommandCheck, RefusesNan) {
  CommandCheck check = check_of(1e6, 1e9);
  check.begin({});
  EXPECT_THAT(check.advance(at(4, std::nan(""))), StartsWith("A5: position nan"));
  EXPECT_THAT(check.advance(at(4, std::numeric_limits<double>::infinity())), StartsWith("A5: position inf"));
  AxisPositions track;
  track.track_m = std::nan("");
  EXPECT_THAT(check.advance(track), StartsWith("E1: position nan"));
}

}  // namespace

}  // namespace vbar::tron::rsi
