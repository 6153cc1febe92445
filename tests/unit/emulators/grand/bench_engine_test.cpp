// The engine in lock-step and in real time with receivers of few words.

#include <algorithm>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "emulators/grand/generator/generator_engine.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"
#include "tests/unit/emulators/grand/bench_directory.h"
#include "tests/unit/emulators/grand/fake_receiver.h"

namespace vbar::grand::bench {
namespace {

using namespace std::chrono_literals;
using fsw::Duration;
using test::read_available;
using vbar::test::sample_in_orbit;

Scenario scenario_of_pair(Pace pace = Pace::kLockStep) {
  Scenario scenario;
  scenario.pace = pace;
  scenario.vehicles = {{"servicer", 2, {}}, {"target", 2, {}}};
  return scenario;
}

/// An engine, and the hosts' ends of the first ports.
class Rig {
 public:
  explicit Rig(const Scenario& scenario = scenario_of_pair())
      : engine(context, scenario, test::data_directory(), directory.path(), test::fake_receivers()) {
    for (const char* name : {"servicer.com1", "target.com1"})
      hosts.emplace_back(::open((directory.path() / name).c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    engine.on_progress.emplace_back([this](std::size_t vehicle) {
      progress.push_back({vehicle, engine.report(vehicle).time});
    });
  }
  void arm() {
    EXPECT_EQ(engine.set_start_time(test::kGnssStart), "");
    for (std::size_t k = 0; k < 2; ++k) engine.sample(k, sample_in_orbit(0.0));
    EXPECT_EQ(engine.arm(), "");
  }
  void start() {
    arm();
    EXPECT_EQ(engine.start(Duration{}), "");
  }
  std::string line(std::size_t vehicle) { return read_available(hosts[vehicle].get()); }
  void say(std::size_t vehicle, const std::string& text) {
    EXPECT_EQ(::write(hosts[vehicle].get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  test::EmulatorDirectory directory;
  boost::asio::io_context context;
  GeneratorEngine engine;
  std::vector<io::FileDescriptor> hosts;
  struct Progress {
    std::size_t vehicle;
    Duration time;
  };
  std::vector<Progress> progress;
};

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(GeneratorEngine, LockStepNeverPassesTheLastSample) {
  Rig rig;
  rig.start();
  EXPECT_EQ(rig.progress.size(), 2U);  // time 0 of both vehicles
  for (int k = 1; k <= 20; ++k) {
    rig.engine.sample(0, sample_in_orbit(0.1 * k));
    EXPECT_EQ(rig.engine.report(0).time.ns, k * 100'000'000);
    EXPECT_EQ(lines_of(rig.line(0)), 1U);  // written before the progress was reported
  }
  // The other vehicle is independent.
  EXPECT_EQ(rig.engine.report(1).time.ns, 0);
  rig.engine.sample(1, sample_in_orbit(2.0));
  EXPECT_EQ(rig.engine.report(1).time.ns, 2'000'000'000);
  EXPECT_EQ(lines_of(rig.line(1)), 20U);
  EXPECT_EQ(rig.progress.back().vehicle, 1U);
  EXPECT_EQ(rig.engine.report(0).late + rig.engine.report(1).late, 0U);
  // A doubled sample flies nothing; its sender gets the progress again.
  const std::size_t before = rig.progress.size();
  rig.engine.sample(1, sample_in_orbit(2.0));
  EXPECT_EQ(rig.progress.size(), before + 1);
  EXPECT_EQ(rig.engine.report(1).doubled, 1U);
  EXPECT_EQ(rig.line(1), "");
}

TEST(GeneratorEngine, SamplesBetweenTheBlocksAreFlownExactly) {
  Rig rig;
  rig.start();
  rig.engine.sample(0, sample_in_orbit(0.25));
  EXPECT_EQ(rig.engine.report(0).time.ns, 250'000'000);
  EXPECT_EQ(lines_of(rig.line(0)), 2U);
  const TrajectorySample flown = rig.engine.flown(0, rig.engine.report(0).time);
  EXPECT_EQ(flown.time.ns, 250'000'000);
  EXPECT_LT((flown.position_ecef_m - sample_in_orbit(0.25).position_ecef_m).norm(), 1e-6);
}

TEST(GeneratorEngine, ReceiversAnswerAtOnceBeforeTheRunAndInTimeDuringIt) {
  Rig rig;
  rig.say(0, "version\n");
  rig.context.run_for(50ms);
  EXPECT_EQ(rig.line(0), "version at 115200 on 0\n");
  rig.start();
  rig.say(0, "log\n");
  rig.context.run_for(50ms);
  EXPECT_EQ(rig.line(0), "");  // no time has passed
  rig.engine.sample(0, sample_in_orbit(0.1));
  const std::string answer = rig.line(0);
  EXPECT_EQ(lines_of(answer), 2U);
  EXPECT_TRUE(answer.find("log at 115200 on 0\n") != std::string::npos) << answer;
  rig.engine.stop();
  rig.say(0, "unlogall\n");
  rig.context.run_for(50ms);
  EXPECT_EQ(rig.line(0), "unlogall at 115200 on 0\n");
}

TEST(GeneratorEngine, EdgesComeAtTheSecondsThatAllVehiclesHaveReached) {
  Rig rig;
  std::vector<wire::PpsDatagram> edges;
  rig.engine.on_edge = [&](const wire::PpsDatagram& edge) { edges.push_back(edge); };
  rig.start();
  rig.engine.sample(0, sample_in_orbit(2.5));
  EXPECT_LE(edges.size(), 1U);
  rig.engine.sample(1, sample_in_orbit(1.5));
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].gps, test::kGnssStart);
  EXPECT_EQ(edges[1].gps, test::kGnssStart + fsw::duration_of_seconds(1));
  EXPECT_EQ(edges[1].count, 1U);
}

TEST(GeneratorEngine, CommandsInTheWrongOrderAreRefused) {
  Rig rig;
  EXPECT_NE(rig.engine.arm(), "");
  EXPECT_NE(rig.engine.start(Duration{}), "");
  EXPECT_NE(rig.engine.set_start_time(fsw::GpsTime{1}), "");
  EXPECT_NE(rig.engine.set_start_time(fsw::GpsTime{}), "");
  EXPECT_NE(rig.engine.set_join(Duration{0}), "");
  rig.start();
  EXPECT_NE(rig.engine.arm(), "");
  EXPECT_NE(rig.engine.set_start_time(test::kGnssStart), "");
  EXPECT_EQ(rig.engine.state(), EngineState::kStreaming);
  rig.engine.reset();
  EXPECT_EQ(rig.engine.state(), EngineState::kIdle);
  rig.start();
  rig.engine.sample(0, sample_in_orbit(0.1));
  EXPECT_EQ(rig.engine.report(0).time.ns, 100'000'000);
  rig.engine.fail("The clock of the generator has failed.");
  EXPECT_EQ(rig.engine.state(), EngineState::kError);
  EXPECT_EQ(rig.engine.error(), "The clock of the generator has failed.");
}

TEST(GeneratorEngine, SomebodyWhoWaitsForAnEdgeGetsOneBeforeTheStart) {
  for (const Pace pace : {Pace::kLockStep, Pace::kRealTime}) {
    Rig rig(scenario_of_pair(pace));
    rig.arm();
    bool edge = false;
    rig.engine.on_next_edge.emplace_back([&] { edge = true; });
    rig.context.run_for(1100ms);
    EXPECT_TRUE(edge);
    const auto now =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch());
    EXPECT_NEAR(static_cast<double>(rig.engine.system_time_at_pps0_ms()), static_cast<double>(now.count()), 2000.0);
  }
}

TEST(GeneratorEngine, DamagedSamplesAreLostDoubledOrSwapped) {
  Rig rig;
  rig.start();
  rig.engine.damage_samples(0, GeneratorEngine::SampleFault::kLost, 1);
  rig.engine.sample(0, sample_in_orbit(0.1));
  EXPECT_EQ(rig.engine.report(0).time.ns, 0);
  rig.engine.sample(0, sample_in_orbit(0.1));  // the host repeats it
  EXPECT_EQ(rig.engine.report(0).time.ns, 100'000'000);
  rig.engine.damage_samples(0, GeneratorEngine::SampleFault::kDoubled, 1);
  rig.engine.sample(0, sample_in_orbit(0.2));
  EXPECT_EQ(rig.engine.report(0).doubled, 1U);
  rig.engine.damage_samples(0, GeneratorEngine::SampleFault::kSwapped, 1);
  rig.engine.sample(0, sample_in_orbit(0.3));
  rig.engine.sample(0, sample_in_orbit(0.4));
  EXPECT_EQ(rig.engine.report(0).out_of_order + rig.engine.report(0).late, 1U);
  EXPECT_EQ(rig.engine.damaged_samples(0), 3U);
}

// 1.2 s of wall clock: blocks and edges come at their times; samples sent at their times are not
// late. Bounds are wide: this may be a busy machine.
TEST(GeneratorEngine, RealTimeFollowsTheHostsClock) {
  Rig rig(scenario_of_pair(Pace::kRealTime));
  std::vector<std::int64_t> edge_errors_ns;
  rig.engine.on_edge = [&](const wire::PpsDatagram& edge) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch() / 1ns;
    edge_errors_ns.push_back(now - edge.monotonic_ns);
  };
  rig.arm();
  for (std::size_t vehicle = 0; vehicle < 2; ++vehicle)
    for (int k = 1; k <= 99; ++k) rig.engine.sample(vehicle, sample_in_orbit(0.1 * k));
  ASSERT_EQ(rig.engine.start(Duration{}), "");
  const auto begin = std::chrono::steady_clock::now();
  rig.context.run_for(1200ms);
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double flown_s = fsw::seconds(rig.engine.report(0).time);
  EXPECT_LE(flown_s, elapsed_s + 1.0);  // the last free-running edge was at most a second before the start
  EXPECT_GE(flown_s, 1.2 - 0.3);
  EXPECT_EQ(rig.engine.report(0).late, 0U);
  EXPECT_GE(edge_errors_ns.size(), 2U);
  for (const std::int64_t error_ns : edge_errors_ns) EXPECT_GE(error_ns, 0);
  // A sample of the past is late.
  Rig other(scenario_of_pair(Pace::kRealTime));
  other.start();
  other.context.run_for(300ms);
  other.engine.sample(0, sample_in_orbit(0.1));
  EXPECT_EQ(other.engine.report(0).late, 1U);
}

// 5 generator seconds in one of the host: at least 5 edges in 1.2 s, 0.2 s apart by their own time stamps.
TEST(GeneratorEngine, ScaledRealTimeShrinksTheSecondsOfTheEdges) {
  Scenario scenario = scenario_of_pair(Pace::kRealTime);
  scenario.speed_factor = 5.0;
  Rig rig(scenario);
  std::vector<wire::PpsDatagram> edges;
  rig.engine.on_edge = [&](const wire::PpsDatagram& edge) { edges.push_back(edge); };
  rig.start();
  rig.context.run_for(1200ms);
  ASSERT_GE(edges.size(), 5U);
  EXPECT_EQ(edges[3].gps.ns - edges[2].gps.ns, 1'000'000'000);
  EXPECT_NEAR(static_cast<double>(edges[3].monotonic_ns - edges[2].monotonic_ns), 2e8, 2.0);
}

TEST(GeneratorEngine, SilentHostEndsTheRadiationAfterFiveSeconds) {
  Rig rig;
  rig.start();
  rig.engine.sample(0, sample_in_orbit(0.1));
  rig.line(0);
  rig.engine.vehicle(0).fly(fsw::duration_of_seconds(6));  // as real time does without samples
  std::istringstream lines(rig.line(0));
  std::int64_t time_ns = 0;
  std::size_t signals = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream(line) >> time_ns >> signals;
    const double age_s = fsw::seconds(fsw::GpsTime{time_ns} - test::kGnssStart);
    EXPECT_EQ(signals > 0, age_s < 5.05) << age_s;
  }
  EXPECT_EQ(rig.engine.report(0).extrapolation, 1);
}

}  // namespace
}  // namespace vbar::grand::bench
