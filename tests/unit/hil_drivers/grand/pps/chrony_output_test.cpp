#include "hil_drivers/grand/pps/chrony_output.h"

#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

using namespace std::chrono_literals;

template <class T>
T field(std::span<const std::uint8_t> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// struct sock_sample of chrony's refclock_sock.c on a 64-bit computer: timeval, double, four ints.
TEST(ChronySample, HasTheLayoutOfChronysOwnStructure) {
  const auto bytes = chrony_sample(1'700'000'000s + 250'999ns);
  EXPECT_EQ(field<std::int64_t>(bytes, 0), 1'700'000'000);
  EXPECT_EQ(field<std::int64_t>(bytes, 8), 250);
  EXPECT_NEAR(field<double>(bytes, 16), -250.999e-6, 1e-12);
  EXPECT_EQ(field<std::int32_t>(bytes, 24), 0);
  EXPECT_EQ(field<std::int32_t>(bytes, 28), 0);
  EXPECT_EQ(field<std::int32_t>(bytes, 36), 0x534F434B);
}

TEST(ChronySample, TheNearestSecondCounts) {
  const auto bytes = chrony_sample(1'700'000'000s - 1ms);
  EXPECT_EQ(field<std::int64_t>(bytes, 0), 1'699'999'999);
  EXPECT_EQ(field<std::int64_t>(bytes, 8), 999'000);
  EXPECT_NEAR(field<double>(bytes, 16), 1e-3, 1e-12);
}

TEST(ChronyOutput, WithoutAConsumerNothingHappens) {
  ChronyOutput output("/tmp/vbar_no_chronyd_here.sock");
  output.forward({std::nullopt, std::chrono::steady_clock::now().time_since_epoch(), 1});
  EXPECT_EQ(output.sent(), 0U);
  EXPECT_THROW(ChronyOutput(std::string(200, 'x')), std::runtime_error);
}

}  // namespace
}  // namespace vbar::grand
