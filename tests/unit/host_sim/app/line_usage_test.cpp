// The share of a step that its bytes take on a serial line: 10 bits a byte (8N1), request and answer after each other.

#include "host_sim/app/line_usage.h"

#include <gtest/gtest.h>

namespace vbar::app {
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
