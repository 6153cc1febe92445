#include "host_sim/app/started_sources.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::app {
namespace {

using testing::ElementsAre;
using twins::StopReason;

/// Writes down its life.
class Device final : public twins::PacketSource {
 public:
  Device(std::string name, std::vector<std::string>& diary, std::string refusal)
      : name_(std::move(name)), diary_(diary), refusal_(std::move(refusal)) {}
  void start(fsw::GpsTime) override {
    diary_.push_back("start " + name_);
    if (refusal_ == "start") throw std::runtime_error("the rails do not answer");
  }
  void stop(StopReason reason) override {
    diary_.push_back("stop " + name_ + " " + std::to_string(static_cast<int>(reason)));
    if (refusal_ == "stop") throw std::runtime_error("the brakes do not answer");
  }
  std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime) const override { return std::nullopt; }
  twins::Measurement measure(const twins::TruthSnapshot&) override { return {}; }

 private:
  std::string name_;
  std::vector<std::string>& diary_;
  std::string refusal_;
};

struct Bench {
  explicit Bench(const std::vector<std::string>& refusals) {
    for (std::size_t k = 0; k < refusals.size(); ++k) {
      const std::string name(1, static_cast<char>('a' + k));
      sources.push_back({name, "fake", std::make_unique<Device>(name, diary, refusals[k])});
    }
  }
  std::vector<std::string> diary;
  std::vector<Source> sources;
};

TEST(StartedSources, AreStoppedInReverseOrderOnce) {
  Bench bench({"", ""});
  {
    StartedSources started(bench.sources);
    started.start({});
    EXPECT_EQ(started.stop(StopReason::kCompleted), "");
    EXPECT_EQ(started.stop(StopReason::kCompleted), "");
  }
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 0", "stop a 0"));
}

TEST(StartedSources, AreStoppedByAnException) {
  Bench bench({""});
  try {
    StartedSources started(bench.sources);
    started.start({});
    throw std::runtime_error("the disk is full");
  } catch (const std::runtime_error&) {
    EXPECT_THAT(bench.diary, ElementsAre("start a", "stop a 1"));
  }
}

TEST(StartedSources, OneThatRefusesToStartIsNamedAndAllAreStopped) {
  Bench bench({"", "start", ""});
  StartedSources started(bench.sources);
  try {
    started.start({});
    ADD_FAILURE() << "started";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "source b: the rails do not answer");
  }
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 2", "stop a 2"));
}

TEST(StartedSources, OneThatCannotBeStoppedDoesNotKeepTheOthersRunning) {
  Bench bench({"", "stop"});
  StartedSources started(bench.sources);
  started.start({});
  EXPECT_EQ(started.stop(StopReason::kInterrupted), "source b could not be stopped: the brakes do not answer");
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 1", "stop a 1"));
}

}  // namespace
}  // namespace vbar::app
