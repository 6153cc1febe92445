// Commands of a run (OEM6 Family Firmware Reference Manual: LOG, SERIALCONFIG).

#include "hil_drivers/grand/receiver_port/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

TEST(Configuration, AsksTheConfiguredRateThenTheFactorys) {
  EXPECT_THAT(rates_to_ask(115200), ElementsAre(115200, 9600, 230400, 460800, 57600, 38400, 19200, 4800, 2400));
  EXPECT_EQ(rates_to_ask(9600).size(), 9U);
  EXPECT_EQ(rates_to_ask(9600).front(), 9600U);
}

TEST(Configuration, LogsToTheBoardBesidesTheHost) {
  ReceiverConfiguration plan;
  plan.board_port = "COM2";
  plan.period_s = 1.0;
  plan.log_offset_s = 0.5;
  plan.clock_adjust = false;
  plan.approximate_position_ecef_m = {0.0, 7'000'000.0, 0.0};
  const auto commands = configuration_commands(plan);
  for (const char* const expected :
       {"UNLOGALL COM2 TRUE", "LOG COM2 RANGEB ONTIME 1 0.5", "LOG COM2 TIMEB ONTIME 1 0.5",
        "LOG THISPORT RANGEB ONTIME 1 0.5", "CLOCKADJUST DISABLE"})
    EXPECT_THAT(commands, Contains(expected));
  EXPECT_EQ(commands.back(), "LOG THISPORT TIMEB ONTIME 1 0.5");  // which completes a burst
}

}  // namespace
}  // namespace vbar::grand
