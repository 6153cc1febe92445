// The emulated controller: its answers, the time of its moves, and where its carriages really are.

#include "emulators/zaber/device.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::zaber {
namespace {

constexpr double kStep_um = 0.047625;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class DeviceTest : public ::testing::Test {
 protected:
  std::string ask(const std::string& line) {
    const auto replies = device.answer(line);
    return replies.empty() ? "" : replies.front();
  }
  void home() {
    ask("/1 home");
    now_s += 100.0;
  }

  double now_s = 0.0;
  Device device{{1, {AxisSettings{}, AxisSettings{}}, 1}, [this] { return now_s; }};
};

TEST_F(DeviceTest, WarnsUntilItIsHomed) {
  EXPECT_EQ(ask("/"), "@01 0 OK IDLE WR 0");
  EXPECT_EQ(ask("/1 1 home"), "@01 1 OK BUSY WR 0");
  EXPECT_EQ(ask("/1 1"), "@01 1 OK BUSY WR 0");
  now_s = 100.0;
  EXPECT_EQ(ask("/1 1"), "@01 1 OK IDLE -- 0");
  EXPECT_EQ(ask("/1"), "@01 0 OK IDLE WR 0");
  EXPECT_EQ(ask("/1 1 get pos"), "@01 1 OK IDLE -- 0");
  home();
  EXPECT_EQ(ask("/1 get pos"), "@01 0 OK IDLE -- 0 0");
}

TEST_F(DeviceTest, MovesAtItsSpeed) {
  home();
  const double start_s = now_s;
  EXPECT_EQ(ask("/1 1 move abs 419948"), "@01 1 OK BUSY -- 0");  // 20 mm at 20 mm/s
  now_s = start_s + 0.5;
  EXPECT_EQ(ask("/1 1 get pos"), "@01 1 OK BUSY -- 209974");
  EXPECT_EQ(ask("/1 1 set pos 5"), "@01 1 RJ BUSY -- STATUSBUSY");
  now_s = start_s + 1.01;
  EXPECT_EQ(ask("/1 1 get pos"), "@01 1 OK IDLE -- 419948");
  ask("/1 1 move rel -100000");
  now_s += 0.1;
  EXPECT_EQ(ask("/1 1 stop"), "@01 1 OK IDLE NI 0");
  EXPECT_EQ(ask("/1 1 warnings clear"), "@01 1 OK IDLE -- 01 NI");
  EXPECT_EQ(ask("/1 1"), "@01 1 OK IDLE -- 0");
}

TEST_F(DeviceTest, SpeedsAreInTheProtocolsUnit) {
  // 1.6384 times microsteps per second (ASCII Protocol Manual, "move vel").
  EXPECT_EQ(ask("/1 2 get maxspeed"), "@01 2 OK IDLE WR " + std::to_string(std::lround(20000.0 / kStep_um * 1.6384)));
  home();
  ask("/1 2 set maxspeed 163840");
  ask("/1 2 move abs 100000");
  now_s += 0.5;
  EXPECT_EQ(ask("/1 2 get pos"), "@01 2 OK BUSY -- 50000");
  now_s += 1.0;
  ask("/1 2 move vel -16384");
  now_s += 1.0;
  EXPECT_EQ(ask("/1 2 get pos"), "@01 2 OK BUSY -- 90000");
}

// What Zaber's own libraries ask first, by the settings of firmware 6.16 in the ASCII protocol manual.
TEST_F(DeviceTest, IdentifiesItself) {
  EXPECT_EQ(ask("/1 get deviceid"), "@01 0 OK IDLE WR 30222");
  EXPECT_EQ(ask("/1 get version"), "@01 0 OK IDLE WR 6.16");
  EXPECT_EQ(ask("/1 get system.serial"), "@01 0 OK IDLE WR 30001");
  EXPECT_EQ(ask("/1 get system.access"), "@01 0 OK IDLE WR 1");
  EXPECT_EQ(ask("/1 get system.axiscount"), "@01 0 OK IDLE WR 2");
  EXPECT_EQ(ask("/1 get comm.checksum"), "@01 0 OK IDLE WR 0");
  EXPECT_EQ(ask("/1 get peripheralid"), "@01 0 OK IDLE WR 0 0");
  EXPECT_EQ(ask("/1 1 get resolution"), "@01 1 OK IDLE WR 64");
  EXPECT_EQ(ask("/1 1 set resolution 32"), "@01 1 RJ IDLE WR BADCOMMAND");
  EXPECT_EQ(ask("/1 get device.id"), "@01 0 RJ IDLE WR BADCOMMAND");  // of firmware 7
}

TEST_F(DeviceTest, RejectsWhatTheManualSaysItRejects) {
  home();
  EXPECT_EQ(ask("/1 1 move abs -1"), "@01 1 RJ IDLE -- BADDATA");
  EXPECT_EQ(ask("/1 1 move abs 99999999"), "@01 1 RJ IDLE -- BADDATA");
  EXPECT_EQ(ask("/1 1 move abs 1.5"), "@01 1 RJ IDLE -- BADDATA");
  EXPECT_EQ(ask("/1 1 set limit.max 100"), "@01 1 OK IDLE -- 0");
  EXPECT_EQ(ask("/1 1 move abs 101"), "@01 1 RJ IDLE -- BADDATA");
  EXPECT_EQ(ask("/1 1 dance"), "@01 1 RJ IDLE -- BADCOMMAND");
  EXPECT_EQ(ask("/1 1 get nothing"), "@01 1 RJ IDLE -- BADCOMMAND");
  EXPECT_EQ(ask("/1 5 home"), "@01 5 RJ IDLE -- BADAXIS");
}

TEST_F(DeviceTest, IsSilentForOthersAndForDamagedLines) {
  EXPECT_EQ(ask("/2 1 home"), "");
  EXPECT_EQ(ask("/1 1 home:00"), "");
  EXPECT_EQ(ask("home"), "");
  EXPECT_EQ(ask("/1 1 9 get pos"), "@01 1 09 OK IDLE WR 0");
  const std::string reply = ask(encode(Command{1, 1, std::nullopt, "", true}));
  EXPECT_EQ(reply, "@01 1 OK IDLE WR 0:" + checksum_of("01 1 OK IDLE WR 0"));
}

TEST_F(DeviceTest, TheCarriageLagsBehindFromAboveAndScattersAboutItsPlace) {
  home();
  std::vector<double> from_below, from_above;
  for (int k = 0; k < 400; ++k) {
    for (const bool below : {true, false}) {
      ask(below ? "/1 1 move abs 99000" : "/1 1 move abs 101000");
      now_s += 10.0;
      ask("/1 1 move abs 100000");
      now_s += 10.0;
      (below ? from_below : from_above).push_back(device.axis(0).carriage_um() - 1e5 * kStep_um);
    }
  }
  // 400 draws of 0.5 um: the mean within 4 sigma (0.1 um), the deviation within 4 sigma (0.07 um).
  EXPECT_NEAR(mean_of(from_below), 0.0, 0.1);
  EXPECT_NEAR(mean_of(from_above), 3.0, 0.1);
  double squares = 0.0;
  for (const double um : from_below) squares += um * um;
  EXPECT_NEAR(std::sqrt(squares / 400.0), 0.5, 0.07);
}

TEST_F(DeviceTest, ABlockedCarriageStallsTheNextMove) {
  home();
  device.axis(0).block();
  ask("/1 1 move abs 100000");
  now_s += 10.0;
  EXPECT_EQ(ask("/1 1"), "@01 1 OK IDLE FS 0");
  EXPECT_EQ(ask("/1"), "@01 0 OK IDLE FS 0");
  EXPECT_EQ(ask("/1 1 get pos"), "@01 1 OK IDLE FS 50000");
  EXPECT_EQ(device.axis(0).stalls(), 1U);
}

TEST_F(DeviceTest, ACarriageMovedByHandIsReported) {
  home();
  device.axis(1).displace(100.0);
  EXPECT_EQ(ask("/1 2 get pos"), "@01 2 OK IDLE WM 2100");  // 100 um / 0.047625 um = 2099.7
}

}  // namespace
}  // namespace vbar::zaber
