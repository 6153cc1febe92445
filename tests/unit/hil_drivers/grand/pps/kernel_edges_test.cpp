// The kernel's interface for PPS devices, which pps_shim.c implements on /dev/null. Debian's ppstest reads the same
// shim in tests/peers/grand.

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

class KernelEdgesTest : public testing::Test {
 protected:
  KernelEdgesTest() { ::setenv("VBAR_PPS_PERIOD_MS", "40", 1); }
  ~KernelEdgesTest() override {
    for (const char* name : {"VBAR_PPS_PERIOD_MS", "VBAR_PPS_NO_WAIT", "VBAR_PPS_NO_ASSERT"}) ::unsetenv(name);
  }
  static std::string refusal_of(const std::string& device) {
    try {
      (void)make_edge_source("kernel:" + device);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }
  static void expect_edges() {
    const auto source = make_edge_source("kernel:/dev/null");
    const auto first = source->next(Clock::now() + 10s);
    ASSERT_TRUE(first);
    EXPECT_FALSE(first->gps);
    for (std::uint32_t k = 1; k <= 5; ++k) {
      const auto edge = source->next(Clock::now() + 10s);
      ASSERT_TRUE(edge);
      const auto late = Clock::now().time_since_epoch() - edge->monotonic;
      EXPECT_GE(late, -1ms);
      // The shim's edges are multiples of 40 ms; the difference of two clocks is read to much better than 1 ms.
      const std::uint32_t edges = edge->count - first->count;
      EXPECT_GE(edges, k);
      EXPECT_NEAR(std::chrono::duration<double>(edge->monotonic - first->monotonic).count(), 0.04 * edges, 1e-3);
    }
  }
};

TEST_F(KernelEdgesTest, StampsAreInMonotonicTime) {
  expect_edges();
}

TEST_F(KernelEdgesTest, ADeviceThatCannotWaitIsPolled) {
  ::setenv("VBAR_PPS_NO_WAIT", "1", 1);
  expect_edges();
}

TEST_F(KernelEdgesTest, ReturnsAtTheDeadline) {
  ::setenv("VBAR_PPS_PERIOD_MS", "100000000", 1);
  const auto source = make_edge_source("kernel:/dev/null");
  const auto begin = Clock::now();
  EXPECT_FALSE(source->next(begin + 150ms));
  EXPECT_GE(Clock::now() - begin, 150ms);
  EXPECT_FALSE(source->next(Clock::time_point{}));
}

TEST_F(KernelEdgesTest, OtherDevicesAreRefused) {
  EXPECT_THAT(refusal_of("/dev/zero"), HasSubstr("/dev/zero: this is not a PPS device"));
  EXPECT_THAT(refusal_of("/dev/no_pps"), HasSubstr("/dev/no_pps: opening the PPS device: No such file"));
  ::setenv("VBAR_PPS_NO_ASSERT", "1", 1);
  EXPECT_THAT(refusal_of("/dev/null"), HasSubstr("does not capture assert edges"));
}

}  // namespace
}  // namespace vbar::grand
