#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(EdgeSources, AreNamedWithTheirDevice) {
  for (const char* text : {"kernel:/dev/pps0", "socket:/run/a:b.sock", "timer"})
    EXPECT_NE(find_edge_source(text), nullptr) << text;
  for (const char* text : {"", "kernel", "kernel:", "timer:x", "sundial", "Timer", ":x"})
    EXPECT_EQ(find_edge_source(text), nullptr) << text;
  EXPECT_THROW((void)make_edge_source("kernel"), std::runtime_error);
  EXPECT_THROW((void)make_edge_source("socket:" + std::string(200, 'x')), std::runtime_error);
  EXPECT_EQ(edge_source_forms(), R"("kernel:DEVICE", "socket:PATH", "timer")");
}

TEST(EdgeSources, TheTimerTicksEverySecondOfTheHost) {
  const auto timer = make_edge_source("timer");
  const auto first = timer->next(Clock::now());
  ASSERT_TRUE(first);
  EXPECT_FALSE(timer->next(Clock::now() + 10ms));
  const auto second = timer->next(Clock::now() + 5s);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->monotonic - first->monotonic, 1s);
  EXPECT_EQ(second->count, first->count + 1);
}

}  // namespace
}  // namespace vbar::grand
