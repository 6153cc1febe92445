// Which answers an emulated controller accepts (protocol sheet, section 1: an answer with another IPOC than the one
// sent last is late or faulty, its corrections are dropped, Delay counts it, and Timeout such cycles end RSI).

#include <cmath>

#include <gtest/gtest.h>

#include "emulators/tron/controller/axis_servo.h"
#include "tests/unit/emulators/tron/one_robot.h"

namespace vbar::tron::bench {

namespace {

/// Sends bad answers for one cycle each; all of them must be without effect.
void expect_refused(OneRobot& bench, const std::string& what, const std::function<void(const rsi::Rob&)>& respond) {
  const rsi::Rob rob = bench.receive();
  const ControllerStatistics before = bench.controller.statistics();
  respond(rob);
  bench.finish_cycle();
  const ControllerStatistics& after = bench.controller.statistics();
  EXPECT_EQ(before.answers, after.answers) << what;
  EXPECT_EQ(before.cycles_without_answer + 1, after.cycles_without_answer) << what;
  EXPECT_LT(before.bad_answers, after.bad_answers) << what;
  EXPECT_TRUE(bench.controller.rsi_is_on()) << what;
}

TEST(RsiAcceptance, TheStateIsWrittenAsAControllerWritesIt) {
  OneRobot bench;
  EXPECT_EQ("", bench.computer.receive());  // RSI is off
  EXPECT_TRUE(bench.command(eki::Action::kStart).rsi_on);
  const rsi::Rob rob = bench.receive();
  // Home of the bench file: 0 -120 120 0 0 0; carriage at its home; order and form of the protocol sheet.
  EXPECT_EQ(
      "<Rob Type=\"KUKA\"><RIst X=\"0.0000\" Y=\"0.0000\" Z=\"0.0000\" A=\"1.0000\" B=\"2.0000\" C=\"3.0000\"/>"
      "<AIPos A1=\"0.0000\" A2=\"-120.0000\" A3=\"120.0000\" A4=\"0.0000\" A5=\"0.0000\" A6=\"0.0000\"/>"
      "<EIPos E1=\"0.0000\" E2=\"0.0000\" E3=\"0.0000\" E4=\"0.0000\" E5=\"0.0000\" E6=\"0.0000\"/>"
      "<Delay D=\"0\"/><IPOC>" +
          rob.ipoc.text + "</IPOC></Rob>",
      bench.last_text);
  EXPECT_EQ(123456U + 4 * bench.clock.cycle(), rob.ipoc.value);
}

TEST(RsiAcceptance, TheIpocGrowsByFourAndValidAnswersMoveTheArm) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  std::uint64_t last_ipoc = 0;
  for (int k = 1; k <= 100; ++k) {
    const rsi::Rob rob = bench.receive();
    EXPECT_EQ(last_ipoc == 0 ? rob.ipoc.value : last_ipoc + 4, rob.ipoc.value);
    last_ipoc = rob.ipoc.value;
    EXPECT_EQ(0U, rob.delay);
    rsi::Sen sen = bench.answer_to(rob);
    sen.axes_deg[3] = 0.0001 * k * k;  // 12.5 deg/s2
    sen.track_mm = 0.0001 * k;
    bench.send(sen);
    bench.finish_cycle();
  }
  EXPECT_EQ(100U, bench.controller.statistics().answers);
  EXPECT_EQ(0U, bench.controller.statistics().cycles_without_answer);
  EXPECT_EQ("", bench.controller.state().message);
  for (int k = 0; k < 50; ++k) {
    rsi::Sen sen = bench.answer_to(bench.receive());
    sen.axes_deg[3] = 1.0;
    sen.track_mm = 0.01;
    bench.send(sen);
    bench.finish_cycle();
  }
  const rsi::Rob rob = bench.receive();
  EXPECT_DOUBLE_EQ(1.0, rob.axes_deg[3]);
  EXPECT_DOUBLE_EQ(0.01, rob.external_mm[0]);
}

TEST(RsiAcceptance, WrongAnswersCountAsDelayAndAreDropped) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  const auto moved = [&](const rsi::Rob& rob) {
    rsi::Sen sen = bench.answer_to(rob);
    sen.axes_deg[0] = 0.01;
    return sen;
  };
  expect_refused(bench, "IPOC of the cycle after", [&](const rsi::Rob& rob) {
    rsi::Sen sen = moved(rob);
    sen.ipoc = std::to_string(rob.ipoc.value + 4);
    bench.send(sen);
  });
  expect_refused(bench, "the same number with a zero before it", [&](const rsi::Rob& rob) {
    rsi::Sen sen = moved(rob);
    sen.ipoc = "0" + rob.ipoc.text;
    bench.send(sen);
  });
  expect_refused(bench, "another type", [&](const rsi::Rob& rob) {
    rsi::Sen sen = moved(rob);
    sen.type = "ImFree";
    bench.send(sen);
  });
  expect_refused(bench, "no IPOC",
                 [&](const rsi::Rob&) { bench.computer.send("<Sen Type=\"VBAR\"><AK A1=\"0.01\"/></Sen>"); });
  expect_refused(bench, "corrupted: a byte is lost", [&](const rsi::Rob& rob) {
    const std::string text = bench.text_of(moved(rob));
    bench.computer.send(text.substr(0, 20) + text.substr(21));
  });
  expect_refused(bench, "corrupted: not a number", [&](const rsi::Rob& rob) {
    bench.computer.send("<Sen Type=\"VBAR\"><AK A1=\"nan\"/><IPOC>" + rob.ipoc.text + "</IPOC></Sen>");
  });
  expect_refused(bench, "split into two datagrams", [&](const rsi::Rob& rob) {
    const std::string text = bench.text_of(moved(rob));
    bench.computer.send(text.substr(0, 50));
    bench.computer.send(text.substr(50));
  });
  expect_refused(bench, "two documents in a datagram", [&](const rsi::Rob& rob) {
    const std::string text = bench.text_of(moved(rob));
    bench.computer.send(text + text);
  });
  expect_refused(bench, "empty", [&](const rsi::Rob&) { bench.computer.send(""); });
  expect_refused(bench, "IPOC twice", [&](const rsi::Rob& rob) {
    const std::string ipoc = "<IPOC>" + rob.ipoc.text + "</IPOC>";
    bench.computer.send("<Sen Type=\"VBAR\">" + ipoc + ipoc + "</Sen>");
  });
  const rsi::Rob rob = bench.receive();
  EXPECT_EQ(10U, rob.delay);
  EXPECT_DOUBLE_EQ(0.0, rob.axes_deg[0]);
}

TEST(RsiAcceptance, LateAndRepeatedAnswersAreOfThePast) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  const rsi::Rob first = bench.receive();
  bench.finish_cycle();  // nothing was sent
  rsi::Sen late = bench.answer_to(first);
  late.axes_deg[0] = 0.01;
  const rsi::Rob second = bench.receive();
  EXPECT_EQ(1U, second.delay);
  bench.send(late);
  bench.send(bench.answer_to(second));
  bench.finish_cycle();
  EXPECT_EQ(1U, bench.controller.statistics().bad_answers);
  EXPECT_EQ(1U, bench.controller.statistics().answers);
  // The answer to the second cycle again, in the third.
  const rsi::Rob third = bench.receive();
  EXPECT_EQ(1U, third.delay);
  rsi::Sen repeated = bench.answer_to(second);
  repeated.axes_deg[0] = 0.01;
  bench.send(repeated);
  bench.finish_cycle();
  const rsi::Rob fourth = bench.receive();
  EXPECT_EQ(2U, fourth.delay);
  EXPECT_DOUBLE_EQ(0.0, fourth.axes_deg[0]);
}

TEST(RsiAcceptance, OfADoubledAnswerTheFirstCounts) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  const rsi::Rob rob = bench.receive();
  rsi::Sen sen = bench.answer_to(rob);
  bench.send(sen);
  sen.axes_deg[0] = 0.01;
  bench.send(sen);
  bench.finish_cycle();
  EXPECT_EQ(1U, bench.controller.statistics().answers);
  EXPECT_EQ(1U, bench.controller.statistics().repeated_answers);
  const rsi::Rob next = bench.receive();
  EXPECT_EQ(0U, next.delay);
  bench.send(bench.answer_to(next));
  bench.finish_cycle();
  EXPECT_DOUBLE_EQ(0.0, bench.receive().axes_deg[0]);
}

TEST(RsiAcceptance, AHundredBadAnswersInARowEndRsi) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  for (int k = 0; k < 99; ++k) {
    const rsi::Rob rob = bench.receive();
    rsi::Sen sen = bench.answer_to(rob);
    sen.ipoc = "1";
    bench.send(sen);
    bench.finish_cycle();
  }
  EXPECT_TRUE(bench.controller.rsi_is_on());
  // One valid answer: the count in a row begins again.
  bench.send(bench.answer_to(bench.receive()));
  bench.finish_cycle();
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(bench.controller.rsi_is_on()) << k;
    const rsi::Rob rob = bench.receive();
    EXPECT_EQ(static_cast<std::uint64_t>(99 + k), rob.delay);
    bench.computer.send("<Sen/>");
    bench.finish_cycle();
  }
  const eki::State state = bench.controller.state();
  EXPECT_FALSE(state.rsi_on);
  EXPECT_TRUE(state.drives_powered);  // they keep the position
  EXPECT_TRUE(state.stopped);
  EXPECT_EQ("RSITimeout: 100 cycles in a row without a valid answer", state.message);
  EXPECT_EQ(199U, bench.controller.statistics().cycles_without_answer);
}

TEST(RsiAcceptance, MissingValuesHoldOrFallToZeroAsConfigured) {
  ControllerSettings settings = camera_robot(0);
  settings.ethernet.axes[4].holds_on = false;
  OneRobot bench(settings);
  (void)bench.command(eki::Action::kStart);
  rsi::Sen sen = bench.answer_to(bench.receive());
  sen.axes_deg[3] = sen.axes_deg[4] = 0.002;
  bench.send(sen);
  bench.finish_cycle();
  for (int k = 0; k < 40; ++k) {
    const rsi::Rob rob = bench.receive();
    bench.computer.send("<Sen Type=\"VBAR\"><IPOC>" + rob.ipoc.text + "</IPOC></Sen>");
    bench.finish_cycle();
  }
  const rsi::Rob rob = bench.receive();
  EXPECT_DOUBLE_EQ(0.002, rob.axes_deg[3]);
  EXPECT_DOUBLE_EQ(0.0, rob.axes_deg[4]);
}

TEST(RsiAcceptance, ForeignDatagramsAreNotAnswers) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  const rsi::Rob rob = bench.receive();
  boost::asio::io_context context;
  boost::asio::ip::udp::socket foreign(context, {boost::asio::ip::address_v4::loopback(), 0});
  rsi::Sen sen = bench.answer_to(rob);
  sen.axes_deg[0] = 0.01;
  foreign.send_to(boost::asio::buffer(bench.text_of(sen)), bench.computer.robot());
  bench.send(bench.answer_to(rob));
  bench.finish_cycle();
  EXPECT_EQ(0U, bench.controller.statistics().repeated_answers);
  EXPECT_EQ(0U, bench.controller.statistics().bad_answers);
}

}  // namespace

namespace {

constexpr double kCycle_s = 0.004;

AxisArray filled(double value) {
  AxisArray values;
  values.fill(value);
  return values;
}

// TRON bench: second order, lag 8 ms. A critically damped system follows a ramp of slope s by 2 s / frequency.
TEST(Servo, FollowsARampWithALagOfEightMilliseconds) {
  Servo servo(filled(0.0), filled(1.0), kCycle_s);
  constexpr double kSpeed = 1.5;
  for (int k = 1; k <= 200; ++k) servo.follow(filled(kSpeed * kCycle_s * k));
  for (const double position : servo.position()) EXPECT_NEAR(kSpeed * (200 * kCycle_s - 0.008), position, 1e-12);
  EXPECT_FALSE(servo.stands());
}

TEST(Servo, ReachesAStepWithoutOvershoot) {
  Servo servo(filled(0.0), filled(1.0), kCycle_s);
  double last = 0.0;
  for (int k = 0; k < 100; ++k) {
    servo.follow(filled(1.0));
    EXPECT_GE(servo.position()[3], last);
    EXPECT_LE(servo.position()[3], 1.0);
    last = servo.position()[3];
  }
  EXPECT_NEAR(1.0, last, 1e-12);
  EXPECT_TRUE(servo.stands());
}

TEST(Servo, BrakesEachAxisAtItsDeceleration) {
  AxisArray deceleration = filled(2.0);
  deceleration[1] = 0.5;
  Servo servo(filled(0.0), deceleration, kCycle_s);
  for (int k = 1; k <= 100; ++k) servo.follow(filled(kCycle_s * k));  // 1 rad/s
  for (int k = 0; k < 1000; ++k) servo.brake();
  EXPECT_TRUE(servo.stands());
  // v^2 / (2 a), of a speed that falls in steps of a cycle: shorter by half a step of the speed, v t / 2.
  EXPECT_NEAR(0.4 + 0.25 - 0.002, servo.position()[0], 1e-9);
  EXPECT_NEAR(0.4 + 1.0 - 0.002, servo.position()[1], 1e-9);
}

AxisMonitor monitor_of(double speed, double acceleration) {
  std::array<AxisLimits, kServoAxes> limits{};
  limits.fill({-1.0, 1.0, speed, acceleration, 0.0});
  return {limits, kCycle_s};
}

TEST(AxisMonitor, NamesTheAxisAndTheLimit) {
  AxisMonitor position = monitor_of(1e3, 1e6);
  position.begin(filled(0.9));
  AxisArray command = filled(0.9);
  command[2] = 1.01;
  EXPECT_EQ("software limit of A3: 57.8687", position.judge(command, 1));

  AxisMonitor speed = monitor_of(0.5, 1e6);
  speed.begin(filled(0.0));
  command = filled(0.0);
  command[kTrackAxis] = 0.003;
  EXPECT_EQ("speed of E1 above its limit: 750.0000 of 500.0000 a second", speed.judge(command, 1));

  AxisMonitor acceleration = monitor_of(1.0, 50.0);
  acceleration.begin(filled(0.0));
  command = filled(0.0);
  command[0] = 0.003;  // 0.75 rad/s in a cycle: 187.5 rad/s2
  EXPECT_EQ("acceleration of A1 above its limit: 10742.9587 of 2864.7890 a second squared",
            acceleration.judge(command, 1));
  EXPECT_NEAR(187.5, acceleration.max_acceleration()[0], 1e-9);
  EXPECT_NEAR(0.75, acceleration.max_speed()[0], 1e-12);
}

TEST(AxisMonitor, RefusesNan) {
  AxisMonitor monitor = monitor_of(1e3, 1e6);
  monitor.begin(filled(0.0));
  AxisArray command = filled(0.0);
  command[5] = std::nan("");
  EXPECT_FALSE(monitor.judge(command, 1).empty());
}

TEST(AxisMonitor, AcceptsTheRoundingOfTheWire) {
  // 50 deg/s rounded to four decimals of a degree, with A2's acceleration: the speed of successive cycles differs by up
  // to two roundings, 0.025 deg/s in 4 ms.
  AxisMonitor monitor = monitor_of(1.0, 0.01);
  monitor.begin(filled(0.0));
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  for (int k = 1; k <= 50; ++k) {
    const double degrees = std::round(0.5 * 0.01 / kDegree * std::pow(k * kCycle_s, 2) * 1e4) / 1e4;
    AxisArray command = filled(degrees * kDegree);
    command[kTrackAxis] = 0.0;  // whose units are others
    EXPECT_EQ("", monitor.judge(command, 1)) << k;
  }
}

TEST(AxisMonitor, JudgesOnlyTheMeanSpeedOverAGap) {
  AxisMonitor monitor = monitor_of(1.0, 1.73);
  monitor.begin(filled(0.0));
  EXPECT_EQ("", monitor.judge(filled(0.0), 1));
  EXPECT_EQ("", monitor.judge(filled(0.011), 3));  // 0.92 rad/s
  EXPECT_EQ("", monitor.judge(filled(0.013), 1));  // no speed before it
  EXPECT_NE("", monitor.judge(filled(0.013), 1));  // 0.5 rad/s to 0 in a cycle
  monitor.begin(filled(0.0));
  EXPECT_NE("", monitor.judge(filled(0.013), 30));  // as if after three cycles
}

}  // namespace

}  // namespace vbar::tron::bench
