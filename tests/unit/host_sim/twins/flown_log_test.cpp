#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "host_sim/twins/run_log.h"
#include "tests/unit/host_sim/twins/log_file.h"

namespace vbar::twins::test {
namespace {

using fsw::GpsTime;
using testing::HasSubstr;

constexpr GpsTime kStart{995'000'000LL * 1'000'000'000LL};
constexpr int kSteps = 4;
constexpr std::uint64_t kEventsOfStep = 4;  // tick and health, each with its message
constexpr const char* kSync = "\xED\xA1\xDA\x01";

GpsTime time_of(std::uint32_t step) {
  return kStart + fsw::duration_of_seconds(60 * step);
}

/// What a flight gives in a step; `odd` is the step whose answer is another one.
std::vector<PacketRecord> records_of(std::uint32_t step, int odd = -1) {
  vbar::tick tick{};
  tick.step = static_cast<std::int32_t>(step);
  vbar::telemetry_health health{};
  health.step = static_cast<std::int32_t>(step) == odd ? 77 : static_cast<std::int32_t>(step);
  const auto count = static_cast<std::uint16_t>(step);
  return {{step, time_of(step), true, packet_of(tick, time_of(step), 1, count)},
          {step, time_of(step), false, packet_of(health, time_of(step), 1, count)}};
}

class FlownLogFile : public LogFile {
 protected:
  void fly(int steps = kSteps, bool finish = false) {
    PacketLogWriter writer(file_);
    for (int step = 0; step < steps; ++step)
      for (const PacketRecord& record : records_of(static_cast<std::uint32_t>(step))) writer.write(record);
    if (finish) writer.finish();
  }
  void write(const std::string& bytes) { std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes; }

  /// Flies `steps` along the log.
  static void compare(RunLog& log, int steps, int odd = -1) {
    for (int step = 0; step < steps; ++step)
      for (const PacketRecord& record : records_of(static_cast<std::uint32_t>(step), odd))
        for (const LcmEvent& event : lcm_events_of(record)) log.compare(record.time, event);
  }
};

TEST_F(FlownLogFile, TheSameFlightIsIdentical) {
  fly();
  RunLog log(file_);
  EXPECT_EQ(log.events(), kSteps * kEventsOfStep);
  EXPECT_EQ(log.steps(), kSteps);
  EXPECT_EQ(log.time(), time_of(kSteps - 1));
  EXPECT_FALSE(log.has_end());
  EXPECT_FALSE(log.damaged_from());
  compare(log, kSteps - 1);
  EXPECT_FALSE(log.is_over());
  compare(log, 0);
  RunLog again(file_);
  compare(again, kSteps + 2);  // goes on
  EXPECT_TRUE(again.is_over());
}

TEST_F(FlownLogFile, TheEndIsNotPartOfTheFlight) {
  fly(kSteps, true);
  RunLog log(file_);
  EXPECT_TRUE(log.has_end());
  EXPECT_EQ(log.events(), kSteps * kEventsOfStep);
  compare(log, kSteps);
  EXPECT_TRUE(log.is_over());
}

TEST_F(FlownLogFile, AnEmptyLogIsOver) {
  write("");
  EXPECT_TRUE(RunLog(file_).is_over());
}

TEST_F(FlownLogFile, AnotherAnswerIsNamedWithItsStep) {
  fly();
  RunLog log(file_);
  try {
    compare(log, kSteps, 2);
    FAIL() << "the answer of step 2 differs";
  } catch (const RunDiffers& error) {
    EXPECT_THAT(error.what(), HasSubstr("step 2, packet telemetry_health from the flight software: differs from byte"));
    EXPECT_EQ(error.time(), time_of(2));
  }
}

TEST_F(FlownLogFile, APacketOfAnotherKindIsNamedBesideThatOfTheLog) {
  fly();
  RunLog log(file_);
  const auto events = lcm_events_of(records_of(0).back());
  try {
    log.compare(time_of(0), events.front());
    FAIL() << "the tick is missing";
  } catch (const RunDiffers& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("telemetry_health from the flight software, where the log has step 0, packet tick"));
  }
}

TEST_F(FlownLogFile, BranchesAreComparedUntilTheyLeave) {
  fly();
  RunLog log(file_);
  log.compare_before(time_of(2));
  compare(log, kSteps, 2);
  EXPECT_TRUE(log.is_over());
  RunLog earlier(file_);
  earlier.compare_before(time_of(2));
  EXPECT_THROW(compare(earlier, kSteps, 1), RunDiffers);
}

TEST_F(FlownLogFile, CutAtAnyByteItCountsUntilThere) {
  fly();
  const std::string bytes = content();
  for (std::size_t size = 5; size < bytes.size(); size += 11) {
    write(bytes.substr(0, size));
    RunLog log(file_);
    EXPECT_LT(log.events(), kSteps * kEventsOfStep);
    compare(log, kSteps);
    EXPECT_TRUE(log.is_over()) << size;
  }
}

TEST_F(FlownLogFile, ItsLastEventMayBeDamagedOrZero) {
  fly();
  const std::string bytes = content();
  const std::size_t last = bytes.rfind(kSync);
  for (const std::size_t at : {last, last + 5, last + 30, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write(damaged);
    RunLog log(file_);
    EXPECT_EQ(log.events(), kSteps * kEventsOfStep - 1) << at - last;
    EXPECT_EQ(log.damaged_from(), last);
    compare(log, kSteps);
    EXPECT_TRUE(log.is_over());
  }
  write(bytes + std::string(5000, '\0'));  // as a file system may leave it after a loss of power
  EXPECT_EQ(RunLog(file_).events(), kSteps * kEventsOfStep);
  EXPECT_EQ(RunLog(file_).damaged_from(), bytes.size());
}

// Every byte of the log: a change of it is found when the log is read, or when it is compared, and never goes
// unnoticed.
TEST_F(FlownLogFile, AnyChangedByteInTheMiddleIsFound) {
  fly();
  const std::string bytes = content();
  const std::size_t last = bytes.rfind(kSync);
  for (std::size_t at = 0; at < last; ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write(damaged);
    EXPECT_THROW(
        {
          RunLog log(file_);
          compare(log, kSteps);
        },
        std::runtime_error)
        << at;
  }
}

TEST_F(FlownLogFile, MissingRecordsAreNamed) {
  fly();
  const std::string bytes = content();
  const std::size_t second = bytes.find(kSync, 4);
  write(bytes.substr(second));
  EXPECT_THROW(RunLog{file_}, IncompleteLog);
  {
    PacketLogWriter writer(file_);  // numbered from the beginning, without step 1
    for (const std::uint32_t step : {0U, 2U, 3U})
      for (const PacketRecord& record : records_of(step)) writer.write(record);
  }
  try {
    RunLog log(file_);
    FAIL() << "step 1 is missing";
  } catch (const IncompleteLog& error) {
    EXPECT_THAT(error.what(), HasSubstr("of step 1"));
  }
}

TEST_F(FlownLogFile, AFileThatIsNoLogIsRefused) {
  write("[mission]\n");
  EXPECT_THROW(RunLog{file_}, DamagedLog);
}

}  // namespace
}  // namespace vbar::twins::test
