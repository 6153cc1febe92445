// The testbed of a run with a generator that only keeps what it is sent: the order of prepare, start, samples and
// progress, and what ends a run.

#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/grand_row.h"
#include "hil_drivers/grand/grand_run.h"
#include "tests/unit/hil_drivers/grand/fake_receiver.h"
#include "tests/unit/hil_drivers/grand/receiver_logs.h"

namespace vbar::grand {

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using twins::gnss::BodyTruth;

constexpr fsw::GpsTime kStart{fsw::duration_of_seconds(1658 * 604800LL + 345'675).ns};

/// What the fake generator of the running test has seen, and how it behaves.
struct Stage {
  GeneratorPlan plan;
  std::vector<std::string> calls;
  std::vector<std::vector<TrajectorySample>> samples;
  std::optional<fsw::Duration> stuck_at;
  GeneratorState state{"Streaming RF", true};
  bool is_emulated = false;
};
Stage* stage = nullptr;

class FakeGenerator final : public Generator {
 public:
  void prepare(std::span<const TrajectorySample> first) override {
    stage->calls.push_back("prepare");
    for (const TrajectorySample& sample : first) stage->samples.push_back({sample});
  }
  std::optional<std::chrono::steady_clock::time_point> start() override {
    stage->calls.push_back("start");
    return std::nullopt;
  }
  void send(std::size_t vehicle, const TrajectorySample& sample) override { stage->samples[vehicle].push_back(sample); }
  std::optional<fsw::Duration> wait_for(std::size_t, fsw::Duration time,
                                        std::chrono::steady_clock::time_point deadline) override {
    if (stage->stuck_at) std::this_thread::sleep_until(deadline);
    return stage->stuck_at ? std::min(*stage->stuck_at, time) : time;
  }
  GeneratorState state(std::size_t) override { return stage->state; }
  [[nodiscard]] bool is_emulated() const override { return stage->is_emulated; }
  void stop() noexcept override { stage->calls.push_back("stop"); }
};

const GeneratorKind kFake{"fake", nullptr,
                          [](const GeneratorPlan& plan, const GeneratorSettings&) {
                            stage->plan = plan;
                            return std::unique_ptr<Generator>(std::make_unique<FakeGenerator>());
                          },
                          true};

/// A straight line.
class Outlook final : public twins::TruthOutlook {
 public:
  twins::TruthSnapshot at(fsw::GpsTime time) override {
    twins::TruthSnapshot truth;
    truth.time = time;
    const double s = fsw::seconds(time - kStart);
    for (const char* const name : {"servicer", "target"}) {
      twins::SpacecraftTruth one;
      one.name = name;
      one.orbit.velocity_eci = {0.0, 7500.0, 0.0};
      one.orbit.position_eci = fsw::Vector3(7e6, name[0] == 's' ? 0.0 : 20.0, 0.0) + s * one.orbit.velocity_eci;
      one.attitude = truth::AttitudeState{};
      one.acceleration_eci = fsw::Vector3::Zero();
      one.angular_acceleration_body = fsw::Vector3::Zero();
      truth.spacecraft.push_back(one);
    }
    return truth;
  }
};

class GrandBenchTest : public ::testing::Test {
 protected:
  GrandBenchTest() {
    stage = &stage_;
    mission_.epoch = kStart - fsw::duration_of_seconds(100);
    settings_.generator = &kFake;
    settings_.generator_settings = std::make_shared<GeneratorSettings>();
    settings_.control_port = 4820;
    settings_.sample_period = fsw::Duration{100'000'000};
    settings_.join = fsw::Duration{165'000'000};
    settings_.give_up = fsw::duration_of_seconds(300);
  }
  ~GrandBenchTest() override {
    sources_.clear();  // and with them the generator, which reports to the stage
    stage = nullptr;
  }

  testbeds::ReceiverPlan plan(const std::string& spacecraft, const FakeReceiver& receiver) {
    testbeds::ReceiverPlan of;
    of.spacecraft = spacecraft;
    of.line.port = receiver.device();
    return of;
  }
  BodyTruth truth(std::size_t vehicle, double s) {
    const auto snapshot = outlook_.at(kStart + fsw::nearest_duration(s));
    return twins::gnss::body_truth(snapshot, snapshot.spacecraft[vehicle]);
  }

  /// Both receivers, started; the run has not begun.
  std::shared_ptr<GrandRun> started() {
    auto bench = std::make_shared<GrandRun>(settings_, testbeds::RunContext{mission_, "/data", outlook_});
    sources_.push_back(bench->make_receiver(plan("servicer", servicer_)));
    sources_.push_back(bench->make_receiver(plan("target", target_)));
    for (const auto& source : sources_) source->start(kStart);
    return bench;
  }

  Stage stage_;
  Outlook outlook_;
  mission::Mission mission_;
  GrandSettings settings_;
  FakeReceiver servicer_{{.baud = 115200, .answers = {}, .logs = {}}};
  FakeReceiver target_{{.baud = 115200, .answers = {}, .logs = {}}};
  std::vector<std::unique_ptr<twins::gnss::ReceiverBytes>> sources_;
  report::RunRecord record_;
};

TEST_F(GrandBenchTest, SendsEachSampleOnceFromTheStartOn) {
  const auto bench = started();
  EXPECT_EQ(stage_.calls, std::vector<std::string>{"prepare"});
  EXPECT_EQ(stage_.plan.start, kStart);
  EXPECT_EQ(stage_.plan.vehicles, (std::vector<std::string>{"servicer", "target"}));
  EXPECT_EQ(stage_.plan.control_ports, (std::vector<std::uint16_t>{4820, 4821}));
  bench->begin(record_, {});
  EXPECT_EQ(stage_.calls.back(), "start");
  for (int k = 0; k <= 20; ++k)
    for (std::size_t vehicle = 0; vehicle < 2; ++vehicle) sources_[vehicle]->output_at(truth(vehicle, 0.1 * k));
  for (const auto& samples : stage_.samples) {
    ASSERT_EQ(samples.size(), 21U);
    for (std::size_t k = 0; k < samples.size(); ++k)
      EXPECT_EQ(samples[k].time.ns, static_cast<std::int64_t>(k) * 100'000'000);
  }
  const auto& rows = record_.tables.rows<GrandRow>();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].time_s, 101.0);
  EXPECT_EQ(rows[1].samples, 20);
  EXPECT_EQ(rows[1].samples_missing, 0);
  EXPECT_EQ(rows[1].generator_state, "Streaming RF");
  for (const auto& source : sources_) source->stop(twins::StopReason::kCompleted);
  EXPECT_EQ(std::ranges::count(stage_.calls, "stop"), 1);
  bench->finish();
  const auto& figures = record_.summary.testbeds.at("grand");
  EXPECT_EQ(std::get<std::string>(figures.at("pace")), "lock_step");
  EXPECT_EQ(std::get<std::string>(figures.at("bench")), "hardware");
}

// An emulated bench that was started by hand names itself: no process of this run says so.
TEST_F(GrandBenchTest, IsEmulatedByWhatTheDevicesState) {
  stage_.is_emulated = true;
  const auto bench = started();
  bench->begin(record_, {});
  for (const auto& source : sources_) source->stop(twins::StopReason::kCompleted);
  bench->finish();
  EXPECT_EQ(std::get<std::string>(record_.summary.testbeds.at("grand").at("bench")), "emulated");
}

TEST_F(GrandBenchTest, ConfiguresEpochsWithRespectToTheFlightSteps) {
  started();
  // The steps are at 5 s of each 10 s of GPS time (kStart), the epochs 9 s after them.
  EXPECT_THAT(servicer_.commands(), ::testing::Contains("LOG THISPORT RANGEB ONTIME 10 4"));
  EXPECT_THAT(target_.commands(), ::testing::Contains("LOG THISPORT TIMEB ONTIME 10 4"));
}

TEST_F(GrandBenchTest, EndsTheRunIfTheGeneratorMakesNoProgress) {
  const auto bench = started();
  bench->begin(record_, {});
  sources_[0]->output_at(truth(0, 0.1));
  stage_.stuck_at = fsw::Duration{150'000'000};
  try {
    sources_[0]->output_at(truth(0, 0.2));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("servicer"), HasSubstr("0.2 s"), HasSubstr("it reports 0.150 s")));
  }
}

TEST_F(GrandBenchTest, EndsTheRunIfTheGeneratorReportsAnError) {
  const auto bench = started();
  bench->begin(record_, {});
  stage_.state = {"Error", false, "Licence expired"};
  sources_[0]->output_at(truth(0, 0.0));
  try {
    sources_[1]->output_at(truth(1, 0.0));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("Licence expired"));
  }
}

TEST_F(GrandBenchTest, NamesAReceiverWithoutAPort) {
  auto bench = std::make_shared<GrandRun>(settings_, testbeds::RunContext{mission_, "/data", outlook_});
  testbeds::ReceiverPlan without;
  without.spacecraft = "servicer";
  const auto source = bench->make_receiver(without);
  try {
    source->start(kStart);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("servicer"), HasSubstr("sensors.gnss.port")));
  }
}

TEST_F(GrandBenchTest, RequiresAWholeSecond) {
  auto bench = std::make_shared<GrandRun>(settings_, testbeds::RunContext{mission_, "/data", outlook_});
  const auto source = bench->make_receiver(plan("servicer", servicer_));
  EXPECT_THROW(source->start(kStart + fsw::Duration{1}), std::runtime_error);
}

}  // namespace

// addresses.json of a bench.

namespace {

using ::testing::ElementsAre;

std::filesystem::path file_with(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "addresses.json";
  std::ofstream(file) << text;
  return file;
}

TEST(Addresses, AreRead) {
  const auto addresses = read_addresses(file_with(
      R"({"control_ports":[4820,4821],"pps":"/tmp/pps.sock","receivers":{"servicer":{"com1":"/tmp/a","com2":"/tmp/b"}}})"));
  EXPECT_THAT(addresses.control_ports, ElementsAre(4820, 4821));
  EXPECT_EQ(addresses.pps, "/tmp/pps.sock");
  EXPECT_EQ(addresses.receivers.at("servicer"), "/tmp/a");
}

TEST(Addresses, OfAnotherFormAreRefusedByName) {
  for (const char* const text :
       {"", "{", "[]", R"({"control_ports":[0],"receivers":{}})", R"({"control_ports":[1]})",
        R"({"control_ports":[99999],"receivers":{}})", R"({"control_ports":"x","receivers":{}})",
        R"({"control_ports":[1],"receivers":{"a":{"com2":"x"}}})"}) {
    try {
      static_cast<void>(read_addresses(file_with(text)));
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("addresses.json")) << text;
    }
  }
}

}  // namespace

}  // namespace vbar::grand
