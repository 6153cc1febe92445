// A run among fakes: what a source may do wrong, and what becomes of it.

#include "host_sim/simulation/simulation.h"

#include <atomic>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/recorders.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/packet_log.h"
#include "tests/unit/host_sim/simulation/fake_world.h"

namespace vbar::app {

namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using twins::Completion;
using twins::Measurement;
using twins::TruthSnapshot;
using namespace std::chrono_literals;
using Wall = std::chrono::steady_clock;

/// Delivers its packet `delay_s` after the epoch.
FakeSource::Measure delivering(double delay_s) {
  return
      [delay_s](const TruthSnapshot& truth) { return ready(truth.time + fsw::nearest_duration(delay_s), {byte(1)}); };
}

/// Nothing at once, a promise that the test keeps or does not.
FakeSource::Measure promising(std::vector<std::promise<Completion>>& promises) {
  return [&promises](const TruthSnapshot& truth) {
    Measurement measurement = ready(truth.time, {});
    measurement.pending = promises.emplace_back().get_future();
    return measurement;
  };
}

TEST(Simulation, StepsGetWhatHasArrivedByTheirTime) {
  FakeWorld world;
  world.timetable.first_packets = {byte(9)};
  world.add("prompt", 10.0, delivering(0.0));
  world.add("slow", 10.0,
            [](const TruthSnapshot& truth) { return ready(truth.time + fsw::nearest_duration(10.1), {byte(2)}); });
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  ASSERT_THAT(world.computer.steps, SizeIs(7));
  EXPECT_THAT(world.computer.steps[0], ElementsAre(byte(9), byte(1)));
  EXPECT_THAT(world.computer.steps[1], ElementsAre(byte(1))) << "what is late by 0.1 s waits for the next step";
  EXPECT_THAT(world.computer.steps[2], ElementsAre(byte(2), byte(1)));
  EXPECT_EQ(simulation.facts().sources[0].epochs, 7);
  EXPECT_EQ(simulation.facts().simulated, fsw::duration_of_seconds(60));
  EXPECT_TRUE(simulation.facts().complete);
}

// What the log holds is what the flight software was given, in that order: others, wired ones, the tick.
TEST(Simulation, BytesOfAWiredReceiverAreRecordedAsInputsBeforeTheTick) {
  FakeWorld world;
  world.add("prompt", 10.0, delivering(0.0));
  world.computer.wired = [](std::size_t step) {
    return step == 2 ? std::vector<pil::Packet>{byte(7), byte(8)} : std::vector<pil::Packet>{};
  };
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  EXPECT_THAT(world.computer.steps[2], ElementsAre(byte(1))) << "they do not take the link as well";
  ASSERT_THAT(world.diary.inputs, SizeIs(7));
  EXPECT_THAT(world.diary.inputs[1], SizeIs(2));
  ASSERT_THAT(world.diary.inputs[2], SizeIs(4));
  EXPECT_THAT(std::vector(world.diary.inputs[2].begin(), world.diary.inputs[2].end() - 1),
              ElementsAre(byte(1), byte(7), byte(8)));
  const auto tick = fsw::packets::parse_packet(world.diary.inputs[2].back());
  ASSERT_TRUE(tick.ok());
  EXPECT_EQ(tick.value().header.apid, fsw::packets::Apid::kTick);
}

TEST(Simulation, PendingPacketsArriveWhenTheyAreDueNotWhenTheyAreMade) {
  FakeWorld world;
  std::vector<std::thread> threads;
  world
      .add("camera", 20.0,
           [&](const TruthSnapshot& truth) {
             Measurement measurement = ready(truth.time + fsw::duration_of_seconds(5), {});
             std::promise<Completion> promise;
             measurement.pending = promise.get_future();
             threads.emplace_back([promise = std::move(promise)]() mutable {
               std::this_thread::sleep_for(20ms);
               promise.set_value({{byte(3)}, {{"achieved_pose_m", 1.0}}});
             });
             return measurement;
           })
      .compared = true;
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(world.computer.steps[0], IsEmpty());
  EXPECT_THAT(world.computer.steps[1], ElementsAre(byte(3)));
  EXPECT_THAT(world.computer.steps[2], IsEmpty());
  EXPECT_THAT(world.diary.notes[0], testing::Pair(at(0.0), "camera:achieved_pose_m")) << "at the epoch";
  EXPECT_THAT(world.diary.measured, ElementsAre(at(0.0), at(20.0), at(40.0), at(60.0)));
}

TEST(Simulation, SourceThatFailsIsCountedWithItsReasonAndTheRunGoesOn) {
  FakeWorld world;
  world.add("receiver", 10.0, [](const TruthSnapshot& truth) {
    Measurement measurement = ready(truth.time, {byte(1)});
    if (truth.time == at(30.0)) {
      measurement.status = twins::MeasurementStatus::kFailed;
      measurement.reason = "no lock";
    }
    return measurement;
  });
  std::vector<std::promise<Completion>> promises;
  promises.reserve(7);
  world.add("camera", 10.0, [&](const TruthSnapshot& truth) {
    Measurement measurement = promising(promises)(truth);
    promises.back().set_value({{}, {}, truth.time == at(20.0) ? "frame lost" : ""});
    return measurement;
  });
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  const auto& sources = simulation.facts().sources;
  EXPECT_EQ(sources[0].failures, 1);
  EXPECT_EQ(sources[0].last_failure, "no lock");
  EXPECT_EQ(sources[1].failures, 1);
  EXPECT_EQ(sources[1].epochs, 7);
  EXPECT_THAT(world.diary.failures,
              ElementsAre(testing::Pair(at(20.0), "camera:frame lost"), testing::Pair(at(30.0), "receiver:no lock")));
  EXPECT_THAT(world.computer.steps[3], IsEmpty()) << "packets of a failed epoch are not delivered";
}

TEST(Simulation, SourceThatNeverAnswersEndsTheRunWithinItsTimeLimit) {
  FakeWorld world;
  std::vector<std::promise<Completion>> promises;
  world.add("prompt", 10.0, delivering(0.0));
  world.add("servicer/camera", 20.0, promising(promises));
  Simulation simulation = world.simulation();
  const Wall::time_point before = Wall::now();
  EXPECT_EQ(
      FakeWorld::error_of(simulation),
      "source servicer/camera: no answer within its time limit of 0.2 s to the measurement at 0.000 s of the run");
  EXPECT_LT(Wall::now() - before, 10s);
  EXPECT_FALSE(simulation.facts().complete);
}

TEST(Simulation, WaitingForASourceEndsWhenAskedToStop) {
  FakeWorld world;
  std::vector<std::promise<Completion>> promises;
  world.add("camera", 20.0, promising(promises)).limit = 1h;
  const Wall::time_point before = Wall::now();
  world.stop_requested = [&] { return Wall::now() - before > 100ms; };
  Simulation simulation = world.simulation();
  EXPECT_FALSE(simulation.run());
  EXPECT_LT(Wall::now() - before, 10s);
  EXPECT_FALSE(simulation.facts().complete);
}

TEST(Simulation, ExceptionOfASourceNamesIt) {
  FakeWorld world;
  std::vector<std::promise<Completion>> promises;
  world.add("camera", 20.0, [&](const TruthSnapshot& truth) {
    Measurement measurement = promising(promises)(truth);
    promises.back().set_exception(std::make_exception_ptr(std::runtime_error("the rails are not homed")));
    return measurement;
  });
  Simulation simulation = world.simulation();
  EXPECT_EQ(FakeWorld::error_of(simulation), "source camera: the rails are not homed");
}

TEST(Simulation, PacketsDeliveredBeforeTheyWereMeasuredEndTheRun) {
  FakeWorld world;
  world.add("servicer/gnss", 10.0, [](const TruthSnapshot& truth) {
    return ready(truth.time == at(20.0) ? at(19.5) : truth.time, {byte(1)});
  });
  Simulation simulation = world.simulation();
  EXPECT_THROW(
      {
        try {
          simulation.run();
        } catch (const std::logic_error& error) {
          EXPECT_STREQ(
              error.what(),
              "source servicer/gnss: packets delivered at 19.500000000 s of the run, measured at 20.000000000 s");
          throw;
        }
      },
      std::logic_error);
  EXPECT_THAT(world.diary.steps, ElementsAre(at(0.0), at(10.0))) << "what was flown is there";
}

TEST(Simulation, EpochBeforeThePresentEndsTheRun) {
  class Backwards final : public twins::PacketSource {
   public:
    std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
      return from > kFakeStart ? kFakeStart : from;
    }
    Measurement measure(const TruthSnapshot& truth) override { return ready(truth.time, {}); }
  };
  FakeWorld world;
  world.sources.push_back({"bench", "fake", std::make_unique<Backwards>()});
  Simulation simulation = world.simulation();
  EXPECT_EQ(FakeWorld::error_of(simulation),
            "source bench: asked for an epoch from 0.000000001 s of the run on, it named 0.000000000 s");
}

TEST(Simulation, StopsBetweenSteps) {
  FakeWorld world;
  int steps = 0;
  world.progress = [&](fsw::Duration) { ++steps; };
  world.stop_requested = [&] { return steps == 3; };
  Simulation simulation = world.simulation();
  EXPECT_FALSE(simulation.run());
  EXPECT_THAT(world.diary.steps, SizeIs(3));
  EXPECT_EQ(simulation.facts().simulated, fsw::duration_of_seconds(20));
}

TEST(Simulation, WaypointIsJudgedBeforeABurnOfItsInstant) {
  FakeWorld world;
  world.timetable.waypoints = {at(20.0), at(500.0)};
  world.timetable.burns = {{at(20.0), {1.0, 2.0, 3.0}}};
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  EXPECT_THAT(world.diary.waypoints, ElementsAre(testing::Pair(at(20.0), "0"))) << "the other is after the end";
  ASSERT_THAT(world.truth.impulses, SizeIs(1));
  EXPECT_EQ(world.truth.impulses[0].second, fsw::Vector3(1.0, 2.0, 3.0));
  EXPECT_THAT(world.diary.notes, ElementsAre(testing::Pair(at(20.0), "thruster:magnitude_error")));
  EXPECT_THAT(world.computer.steps[3], ElementsAre(byte(0xEE))) << "the report of the burn";
}

TEST(Simulation, SharesOfTheWallClockArePartsOfTheRun) {
  FakeWorld world;  // whose truth says it spent 1000 s before the run
  world.add("slow", 20.0, [](const TruthSnapshot& truth) {
    std::this_thread::sleep_for(2ms);
    return ready(truth.time, {});
  });
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  const RunFacts& facts = simulation.facts();
  EXPECT_EQ(facts.truth_s, 0.0);
  EXPECT_GE(facts.sources_s, 0.008);
  EXPECT_GE(facts.link_s, 0.0);
  EXPECT_LE(facts.truth_s + facts.flight_s + facts.link_s + facts.sources_s, facts.wall_s);
}

// 10 Hz for a minute of real time, on a wall that passes only in sleep.
TEST(Simulation, RealTimeHasNoBursts) {
  FakeWorld world;
  world.timetable.clock.mode = engine::ClockMode::kRealTime;
  std::vector<double> taken_s;
  world.add("rf_generator", 0.1, [&](const TruthSnapshot& truth) {
    taken_s.push_back(1e-9 * static_cast<double>(world.wall.now().count()));
    if (truth.time == at(30.0)) world.wall.pass(350ms);  // busy for three periods and a half
    return ready(truth.time, {});
  });
  Simulation simulation = world.simulation();
  EXPECT_TRUE(simulation.run());
  ASSERT_THAT(taken_s, SizeIs(601));
  for (std::size_t k = 0; k < taken_s.size(); ++k) {
    const double due_s = 0.1 * static_cast<double>(k);
    EXPECT_GE(taken_s[k], due_s - 1e-6) << "never before its time";
    const bool catches_up = k >= 301 && k <= 303;
    EXPECT_LE(taken_s[k], due_s + (catches_up ? 0.35 : 1e-6));
  }
  const engine::Lateness& late = simulation.facts().sources[0].late;
  EXPECT_EQ(late.count, 3U) << "at 30.1, 30.2 and 30.3 s";
  EXPECT_NEAR(1e-9 * static_cast<double>(late.worst.count()), 0.25, 1e-6);
  EXPECT_EQ(simulation.facts().deadlines.simulation_late.count, 1U) << "the step at 30 s";
}

}  // namespace

// What a run's log keeps of a camera's images.

namespace {

class ImagesInTheLog : public testing::TestWithParam<mission::ImagesInLog> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("vbar_keepers_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_P(ImagesInTheLog, AreWhatTheMissionAsksFor) {
  twins::camera::ImageMaker::Settings settings;
  settings.camera.region = {0, 0, 100, 50};  // 5000 pixels: 6 tiles
  settings.spacecraft = 1;
  twins::camera::ImageMaker maker(settings, [](const twins::camera::Exposure&, twins::camera::PhotonImage&) {});
  const twins::camera::ImageRecipe recipe{1, 0, {}};
  const std::vector<twins::Packet> tiles = maker.packets_of(recipe.exposure);
  ASSERT_EQ(tiles.size(), 6U);

  mission::Mission mission;
  mission.record.images = GetParam();
  {
    const PacketRecorders keepers(mission, folder_);
    for (RunObserver* observer : keepers.observers()) {
      observer->on_recipe({0}, twins::LoggedImage{{1, 0, 0}, twins::camera::bytes_of(recipe)});
      observer->on_step(0, {0}, tiles, {});
    }
  }
  const twins::PacketLog log = twins::read_packet_log(report::packet_log_file(folder_));
  if (GetParam() == mission::ImagesInLog::kTiles) {
    EXPECT_TRUE(log.recipes.empty());
    ASSERT_EQ(log.records.size(), 6U);
    EXPECT_EQ(log.records[5].packet, tiles[5]);
  } else {
    ASSERT_EQ(log.recipes.size(), 1U);
    ASSERT_EQ(log.records.size(), 1U) << "held back to the end of the step and no longer";
    EXPECT_EQ(log.records[0].tiles->tiles, 6);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, ImagesInTheLog,
                         testing::Values(mission::ImagesInLog::kRecipes, mission::ImagesInLog::kTiles));

}  // namespace

// The share of a step that its bytes take on a serial line: 10 bits a byte (8N1), request and answer after each other.

namespace {

using mission::FlightLink;
using mission::FlightTarget;

constexpr fsw::Duration kStep = fsw::duration_of_seconds(10);

pil::LinkStatistics link(std::uint64_t sent, std::uint64_t received) {
  pil::LinkStatistics statistics;
  statistics.bytes_sent = sent;
  statistics.bytes_received = received;
  return statistics;
}

report::Summary::Link after_two_steps(const mission::FlightComputer& computer) {
  LineUsage line(computer, kStep, link(100, 50));  // to find each other
  line.after_step(link(100 + 6000, 50 + 3000));
  line.after_step(link(100 + 6000 + 1000, 50 + 3000 + 2000));
  report::Summary::Link summary;
  line.summarise(summary);
  return summary;
}

mission::FlightComputer computer_on(FlightTarget target, FlightLink link) {
  mission::FlightComputer computer;
  computer.target = target;
  computer.link = link;
  return computer;
}

TEST(LineUsage, IsTheTimeOfBothDirectionsOverTheStep) {
  mission::FlightComputer computer = computer_on(FlightTarget::kZynqQemu, FlightLink::kSerial);
  computer.baud = 90000;  // 9000 bytes a second: 1 s and a third of one
  const report::Summary::Link summary = after_two_steps(computer);
  EXPECT_EQ(summary.baud, 90000);
  // Products and quotients of a few numbers: rounding only.
  EXPECT_NEAR(summary.step_share_max, 0.1, 1e-15);
  EXPECT_NEAR(summary.step_share_mean, 0.2 / 3.0, 1e-15);
}

TEST(LineUsage, OfABoardIsAtItsOwnRate) {
  EXPECT_EQ(after_two_steps(computer_on(FlightTarget::kBoard, FlightLink::kSerial)).baud, 921600);
}

TEST(LineUsage, IsNothingWhereThereIsNoSlowLine) {
  mission::FlightComputer in_process = computer_on(FlightTarget::kInProcess, FlightLink::kSerial);
  mission::FlightComputer ethernet = computer_on(FlightTarget::kZynqQemu, FlightLink::kUdp);
  in_process.baud = ethernet.baud = 921600;
  for (const auto& computer : {in_process, ethernet, computer_on(FlightTarget::kZynqQemu, FlightLink::kSerial)}) {
    const report::Summary::Link summary = after_two_steps(computer);
    EXPECT_EQ(summary.baud, 0);
    EXPECT_EQ(summary.step_share_max, 0.0);
  }
}

}  // namespace

}  // namespace vbar::app
