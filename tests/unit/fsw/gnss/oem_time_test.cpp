// The time tags of epochs: exact, over the ends of weeks, and only from a receiver that knows the time.

#include "fsw/gnss/oem_time.h"

#include <memory>

#include <gtest/gtest.h>

#include "fsw/gnss/oem_range.h"
#include "tests/unit/fsw/gnss/oem_bytes_writer.h"

namespace vbar::fsw::gnss {
namespace {

using test::Bytes;
using test::Signal44;

TEST(OemTime, TimeTagsAreExact) {
  const Bytes body = test::range_body(std::vector<Signal44>(1));
  OemMessage message = test::log_of(kOemRange, body, start_of_week(1643));
  const auto epoch = std::make_unique<ObservationEpoch>();
  ObservationTally tally;
  for (const std::uint32_t ms : {0U, 1U, 333U, 604'799'999U}) {
    message.week = 2400;
    message.time_of_week_ms = ms;
    ASSERT_EQ(read_range(message, *epoch, tally), Status::kOk);
    EXPECT_EQ(epoch->receiver_time.ns, 2400LL * 604'800 * 1'000'000'000 + ms * 1'000'000LL);
  }
  // A millisecond after the last one of a week is the first of the next, also where ten bits of the week run over.
  for (const std::uint16_t week : {1643, 2047, 4095}) {
    message.week = week;
    message.time_of_week_ms = 604'799'999;
    const GpsTime before = time_of(message).value();
    message.week = static_cast<std::uint16_t>(week + 1);
    message.time_of_week_ms = 0;
    EXPECT_EQ((time_of(message).value() - before).ns, 1'000'000);
  }
}

TEST(OemTime, WithoutTimeThereIsNoEpoch) {
  const Bytes body = test::range_body(std::vector<Signal44>(1));
  OemMessage message = test::log_of(kOemRange, body, start_of_week(1643));
  const auto epoch = std::make_unique<ObservationEpoch>();
  ObservationTally tally;
  const auto expect = [&](Status status) {
    EXPECT_EQ(read_range(message, *epoch, tally), status);
    EXPECT_EQ(epoch->count, status == Status::kOk ? 1U : 0U);
  };
  for (const int known : {80, 100, 120, 130, 140, 160, 170, 180, 200}) {
    message.time_status = static_cast<std::uint8_t>(known);
    expect(Status::kOk);
  }
  for (const int unknown : {20, 60}) {
    message.time_status = static_cast<std::uint8_t>(unknown);
    expect(Status::kNotReady);
  }
  for (const int nonsense : {0, 21, 181, 255}) {
    message.time_status = static_cast<std::uint8_t>(nonsense);
    expect(Status::kOutOfRange);
  }
  message.time_status = 180;
  message.week = 0;
  expect(Status::kNotReady);
  message.week = 65'535;  // would not fit an instant in nanoseconds
  expect(Status::kOutOfRange);
  message.week = 1643;
  message.time_of_week_ms = 604'800'000;
  expect(Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::fsw::gnss
