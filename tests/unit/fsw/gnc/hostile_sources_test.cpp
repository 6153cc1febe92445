// Sources whose records are late, repeated, of the future, of an hour ago, or interleaved with those of another unit:
// what cannot be used is counted, and neither the state nor another source suffers.

#include <vector>

#include "fsw/messaging/message_fields.h"
#include "tests/unit/fsw/gnc/small_world.h"
#include "tests/unit/fsw/messaging/configurations.h"
#include "tests/unit/fsw/vision/imaging/synthetic_images.h"

namespace vbar::fsw::gnc::test {
namespace {

const Vector6 kStart = (Vector6() << 0, -100, 0, 3, 0, 3).finished();
constexpr std::int32_t kSources = std::int32_t{navigation_configuration::kUseOwnGnss} +
                                  navigation_configuration::kUseKeypoints + navigation_configuration::kUseRangeFinder;

/// A camera of 64 x 48 pixels: three tiles.
camera_configuration small_camera() {
  camera_configuration c = camera();
  c.width = 64;
  c.height = 48;
  return c;
}

/// Navigated by true states, then by two cameras and a range finder from the last of these states on.
class HostileSources : public ::testing::Test {
 protected:
  HostileSources() {
    flight_.fly_until(at(180));
    flight_.measures = false;
    send(navigation(kSources));
    send(earth());
    send(receiver());
    send(target_shape());
    send(ranges());
    for (const std::uint8_t unit : {std::uint8_t{0}, std::uint8_t{1}}) {
      send(small_camera(), unit);
      send(pose(), unit);
    }
    const Answer answer = flight_.step();
    for (const auto& acknowledgment : answer.acknowledgments) {
      EXPECT_EQ(acknowledgment.status, telemetry_telecommand::kStatusAccepted) << acknowledgment.apid;
    }
    events_ = answer.events;
  }

  template <class Message>
  void send(const Message& message, std::uint8_t unit = 0) {
    EXPECT_EQ(flight_.article.deliver(packet_of(flight_.now, message, sequence_++, kServicer, unit)), 0);
  }
  /// The tiles of a dark image.
  [[nodiscard]] static std::vector<Bytes> image(std::uint8_t unit, GpsTime time, std::int32_t number) {
    const imaging::ImageFrame frame{64, 48, 80, 50, 12};
    const std::vector<std::uint16_t> pixels(64 * 48, 64);
    std::vector<Bytes> tiles;
    for (const image_tile& tile : imaging::tiles_of(pixels, frame, number)) {
      tiles.push_back(packet_of(time, tile, static_cast<std::uint16_t>(tiles.size()), kServicer, unit));
    }
    return tiles;
  }
  void deliver(const std::vector<Bytes>& packets) {
    for (const Bytes& packet : packets) static_cast<void>(flight_.article.deliver(packet));
  }
  void deliver_range(GpsTime time, double range_m) {
    range_measurement measured{};
    measured.range_m = range_m;
    static_cast<void>(flight_.article.deliver(packet_of(time, measured, sequence_++)));
  }
  void expect_sound(const Answer& answer) const {
    EXPECT_EQ(answer.status, 0);
    EXPECT_EQ(answer.navigation.valid, 1);
    EXPECT_EQ(answer.health.outbox_dropped, 0) << "a NaN";
    EXPECT_NEAR(messaging::vector(answer.navigation.relative_position_rtn).norm(), 100.0,
                10.0);  // propagated, not initialised
  }

  Flight flight_{kStart};
  std::uint16_t sequence_ = 100;
  std::vector<telemetry_event> events_;
};

TEST_F(HostileSources, AChangeOfSourcesIsAnEventOfEach) {
  ASSERT_EQ(events_.size(), 4U);  // in the order of the list
  const std::int32_t devices[] = {navigation_configuration::kUseIdeal, navigation_configuration::kUseOwnGnss,
                                  navigation_configuration::kUseKeypoints, navigation_configuration::kUseRangeFinder};
  for (std::size_t k = 0; k < events_.size(); ++k) {
    EXPECT_EQ(events_[k].event, telemetry_event::kEventAid);
    EXPECT_EQ(events_[k].device, devices[k]);
    EXPECT_EQ(events_[k].before, k == 0 ? telemetry_event::kAidAiding : telemetry_event::kAidOff);
    EXPECT_EQ(events_[k].after, k == 0 ? telemetry_event::kAidOff : telemetry_event::kAidWaiting);
  }
  EXPECT_TRUE(flight_.step().events.empty()) << "no event without a change";
}

TEST_F(HostileSources, ImagesOfTwoCamerasInterleave) {
  const GpsTime first = flight_.now - duration_of_seconds(20), second = flight_.now - duration_of_seconds(10);
  const std::vector<Bytes> one = image(1, first, 7), other = image(0, second, 7);
  for (std::size_t k = 0; k < one.size(); ++k) deliver({other[k], one[k]});
  const Answer answer = flight_.step();
  expect_sound(answer);
  ASSERT_EQ(answer.poses.size(), 2U);
  EXPECT_EQ(answer.poses[0].unit, 0);
  EXPECT_EQ(answer.poses[0].time, second);
  EXPECT_EQ(answer.poses[1].unit, 1);
  EXPECT_EQ(answer.poses[1].time, first);
  for (const PoseReport& report : answer.poses) {
    EXPECT_EQ(report.message.image, 7);
    EXPECT_EQ(report.message.tiles_missing, 0);
    EXPECT_EQ(report.message.status, telemetry_pose::kStatusDark);
  }
}

TEST_F(HostileSources, TheOrderOfArrivalOfTwoCamerasHasNoEffect) {
  const std::vector<Bytes> one = image(1, flight_.now - duration_of_seconds(20), 7);
  const std::vector<Bytes> other = image(0, flight_.now - duration_of_seconds(10), 8);
  const std::vector<std::byte> saved = flight_.article.save();
  deliver(one);
  deliver(other);
  const Answer in_order = flight_.article.step(flight_.now, kStep);
  flight_.article.restore(saved);
  deliver(other);
  deliver({one.rbegin(), one.rend()});
  const Answer reversed = flight_.article.step(flight_.now, kStep);
  ASSERT_EQ(in_order.poses.size(), 2U);
  EXPECT_TRUE(in_order.packets == reversed.packets);
}

TEST_F(HostileSources, AThirdCameraIsRefused) {
  const std::int32_t before = flight_.step().health.rejected_type;
  deliver(image(2, flight_.now, 1));
  const Answer answer = flight_.step();
  EXPECT_TRUE(answer.poses.empty());
  EXPECT_EQ(answer.health.rejected_type - before, 4);
  expect_sound(answer);
}

// Also after that of the other camera: the state has passed its time.
TEST_F(HostileSources, AnImageAfterItsSuccessorIsRefused) {
  const GpsTime newer = flight_.now - duration_of_seconds(5);
  deliver(image(0, newer, 5));
  const Answer first = flight_.step();
  EXPECT_EQ(first.poses.size(), 1U);
  deliver(image(0, newer - duration_of_seconds(30), 4));
  deliver(image(1, newer - duration_of_seconds(30), 4));
  const Answer refused = flight_.step();
  EXPECT_TRUE(refused.poses.empty());
  EXPECT_EQ(refused.health.rejected_other - first.health.rejected_other, 4) << "the tiles of camera 0";
  EXPECT_EQ(refused.health.rejected_time - first.health.rejected_time, 1) << "the image of camera 1";
  expect_sound(refused);
  deliver(image(1, flight_.now, 6));
  EXPECT_EQ(flight_.step().poses.size(), 1U);
}

TEST_F(HostileSources, TimesThatRepeatOrLieInTheFutureAreRefused) {
  const GpsTime taken = flight_.now - duration_of_seconds(5);
  deliver(image(0, taken, 5));
  EXPECT_EQ(flight_.step().poses.size(), 1U);
  deliver(image(0, taken, 5));
  EXPECT_TRUE(flight_.step().poses.empty());
  deliver(image(0, flight_.now + duration_of_seconds(3600), 6));
  EXPECT_TRUE(flight_.step().poses.empty());
  deliver(image(0, flight_.now - duration_of_seconds(1), 7));  // the future has not blocked the present
  const Answer answer = flight_.step();
  EXPECT_EQ(answer.poses.size(), 1U);
  expect_sound(answer);
}

TEST_F(HostileSources, AnHourOfSilenceIsPropagated) {
  deliver(image(0, flight_.now, 1));
  EXPECT_EQ(flight_.step().poses.size(), 1U);
  for (int k = 0; k < 60; ++k) {
    const Answer answer = flight_.step();
    ASSERT_EQ(answer.navigation.valid, 1) << k;
    EXPECT_EQ(answer.navigation.source, telemetry_navigation::kSourcePropagated);
  }
  deliver(image(0, flight_.now - duration_of_seconds(1), 2));
  const Answer answer = flight_.step();
  EXPECT_EQ(answer.poses.size(), 1U);
  expect_sound(answer);
}

TEST_F(HostileSources, RangesWithImpossibleTimesAreCounted) {
  const std::int32_t before = flight_.step().health.rejected_time;
  deliver_range(flight_.now + duration_of_seconds(1), 100.0);
  deliver_range(flight_.now - duration_of_seconds(3600), 100.0);
  const Answer refused = flight_.step();
  EXPECT_EQ(refused.health.rejected_time - before, 2);
  EXPECT_TRUE(refused.events.empty());
  expect_sound(refused);
  const ideal_navigation truth = flight_.world.measurement();
  const double range_m =
      (messaging::vector(truth.target_position_eci) - messaging::vector(truth.servicer_position_eci)).norm();
  deliver_range(flight_.now, range_m);
  const Answer used = flight_.step();
  ASSERT_EQ(used.events.size(), 1U);
  EXPECT_EQ(used.events[0].device, navigation_configuration::kUseRangeFinder);
  EXPECT_EQ(used.health.rejected_time - before, 2);
  expect_sound(used);
}

// A new table or thruster changes nothing of what the sources have.
TEST_F(HostileSources, OtherTelecommandsLeaveThemAsTheyAre) {
  deliver(image(0, flight_.now - duration_of_seconds(5), 5));
  flight_.step();
  const Answer before = flight_.step();
  send(thruster());
  send(table_of({waypoint_at(8, 7200, 1, kStart)}));
  const Answer after = flight_.step();
  EXPECT_TRUE(after.events.empty());
  EXPECT_EQ(after.navigation.valid, before.navigation.valid);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(after.navigation.sigma_rtn[axis], before.navigation.sigma_rtn[axis], 0.01) << axis;
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
