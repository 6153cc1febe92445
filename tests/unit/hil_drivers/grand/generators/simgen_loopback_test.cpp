// The SimGEN driver and the emulated SimGEN.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using testing::HasSubstr;

bench::ControlSettings simgen() {
  return {.protocol = bench::ControlProtocol::kSimgen};
}
const std::string kImpatient = "answer_limit_ms = 1500\n";

void fly(Generator& generator, int count) {
  for (int n = 1; n <= count; ++n) {
    for (const std::size_t vehicle : {0U, 1U}) {
      generator.send(vehicle, sample_at(tenths(n), static_cast<double>(vehicle)));
      EXPECT_GE(generator.wait_for(vehicle, tenths(n), soon()), tenths(n));
    }
  }
}

void expect_flown(Loopback& loopback, int count) {
  loopback.in_server([&](FakeEngine& engine, bench::ControlServers&) {
    for (const std::size_t vehicle : {0U, 1U}) {
      ASSERT_EQ(engine.samples[vehicle].size(), static_cast<std::size_t>(count) + 1);
      for (int n = 0; n <= count; ++n)
        EXPECT_TRUE(is_same(engine.samples[vehicle][n], sample_at(tenths(n), static_cast<double>(vehicle))));
    }
  });
}

TEST(SimgenLoopback, FliesBothVehiclesInLockStep) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  EXPECT_EQ(generator->start(), std::nullopt);
  fly(*generator, 20);
  EXPECT_EQ(generator->state(0).text, "Running");
  EXPECT_TRUE(generator->state(0).is_streaming);
  generator->stop();
  expect_flown(loopback, 20);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) {
    EXPECT_EQ(engine.calls, "reset arm start stop ");
    EXPECT_EQ(engine.start_time, kStart);
  });
}

// In real time the motion goes by datagrams.
TEST(SimgenLoopback, FliesByDatagramsInRealTime) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen", "", Pace::kRealTime);
  prepare(*generator);
  generator->start();
  fly(*generator, 20);
  expect_flown(loopback, 20);
}

TEST(SimgenLoopback, ALostSampleIsSentAgain) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  generator->start();
  fly(*generator, 1);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { engine.ignored_samples = 1; });
  generator->send(1, sample_at(tenths(2)));
  EXPECT_EQ(generator->wait_for(1, tenths(2), soon(5.0)), tenths(2));
}

TEST(SimgenLoopback, ARefusedCommandIsOneSentence) {
  for (const char* command : {"START_TIME", "AR", "MOT"}) {
    Loopback loopback(simgen());
    loopback.set_faults({.refused_command = command, .refusal = "Hardware not found"});
    const auto generator = loopback.generator("simgen");
    EXPECT_THAT(error_of([&] { prepare(*generator); }), AllOf(HasSubstr("SimGEN at 127.0.0.1:"), HasSubstr(command),
                                                              HasSubstr("answered the error \"Hardware not found\"")));
  }
}

TEST(SimgenLoopback, SilenceAndAClosedConnectionEndTheWait) {
  Loopback loopback(simgen());
  loopback.set_faults({.unanswered_command = "RU"});
  auto generator = loopback.generator("simgen", kImpatient);
  prepare(*generator);
  EXPECT_THAT(error_of([&] { generator->start(); }), HasSubstr("RU: no answer within 1.5 s"));
  generator->stop();
  loopback.set_faults({.closing_command = "TIME"});
  generator = loopback.generator("simgen", kImpatient);
  prepare(*generator);
  generator->start();
  EXPECT_THAT(error_of([&] { generator->wait_for(0, kTenth, soon()); }),
              HasSubstr("TIME: the generator closed the connection"));
}

TEST(SimgenLoopback, AWaitForAVehicleThatDoesNotMoveEnds) {
  Loopback loopback(simgen());
  const auto generator = loopback.generator("simgen");
  prepare(*generator);
  generator->start();
  EXPECT_EQ(generator->wait_for(0, kTenth, soon(0.3)), fsw::Duration{});
}

}  // namespace
}  // namespace vbar::grand::test
