// Ticks that jump.

#include "fsw/gnc/tick_gate.h"

#include <gtest/gtest.h>

namespace vbar::fsw::gnc {
namespace {

using Verdict = TickGate::Verdict;

GpsTime at(std::int64_t s) {
  return GpsTime{} + duration_of_seconds(1'000'000 + s);
}

TEST(TickGate, StepsForwardAreTaken) {
  TickGate gate;
  for (const int s : {0, 60, 61, 240, 2040}) EXPECT_EQ(gate.judge(at(s)), Verdict::kTaken) << s;
}

TEST(TickGate, OneTickAnHourAheadChangesNothing) {
  TickGate gate;
  gate.judge(at(0));
  EXPECT_EQ(gate.judge(at(3600)), Verdict::kTooFarAhead);
  EXPECT_EQ(gate.judge(at(60)), Verdict::kTaken);
  EXPECT_EQ(gate.judge(at(120)), Verdict::kTaken);
}

TEST(TickGate, ThreeTicksInARowThatAgreeAreBelieved) {
  TickGate gate;
  gate.judge(at(0));
  EXPECT_EQ(gate.judge(at(7200)), Verdict::kTooFarAhead);
  EXPECT_EQ(gate.judge(at(7260)), Verdict::kTooFarAhead);
  EXPECT_EQ(gate.judge(at(7320)), Verdict::kTaken);
  EXPECT_EQ(gate.judge(at(7380)), Verdict::kTaken);
}

TEST(TickGate, TicksThatDoNotAgreeAreNot) {
  TickGate gate;
  gate.judge(at(0));
  for (const int s : {7200, 20000, 7300, 50000, 9000}) EXPECT_EQ(gate.judge(at(s)), Verdict::kTooFarAhead) << s;
  EXPECT_EQ(gate.judge(at(60)), Verdict::kTaken);
}

TEST(TickGate, TimeDoesNotGoBack) {
  TickGate gate;
  gate.judge(at(600));
  for (const int s : {0, 60, 120, 180, 600}) EXPECT_EQ(gate.judge(at(s)), Verdict::kBackward) << s;
  EXPECT_EQ(gate.judge(at(601)), Verdict::kTaken);
}

}  // namespace
}  // namespace vbar::fsw::gnc
