// The receiver on a socket: what it counts, and when an object counts as missing, occluded or frozen.

#include "hil_drivers/tron/protocols/vicon_receiver.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/protocols/vicon_stream.h"

namespace vbar::tron::vicon {
namespace {

using boost::asio::ip::udp;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};  // of what must come

class ReceiverTest : public ::testing::Test {
 protected:
  static ViconSettings settings() {
    ViconSettings settings;
    settings.port = 0;
    return settings;
  }

  void send_bytes(const Bytes& bytes) {
    socket_.send_to(boost::asio::buffer(bytes), {boost::asio::ip::address_v4::loopback(), receiver_.port()});
  }
  void send(const ObjectBlock& frame, std::size_t block_bytes = 1024) {
    for (const Bytes& block : encode_frame(frame, block_bytes)) send_bytes(block);
  }
  /// Frames with both objects from the number `first`, x of the camera `x_mm`.
  void send_frames(std::uint32_t first, int count, double x_mm) {
    for (int k = 0; k < count; ++k)
      send({first + static_cast<std::uint32_t>(k),
            {{"target", {5.0, x_mm, 0.0}, {0.0, 0.0, 0.5}}, {"camera", {x_mm + k, 2.0, 3.0}, {0.1, 0.0, 0.0}}}});
  }
  int received(int frames) { return receiver_.wait_for(frames, kPatience); }

  Receiver receiver_{settings(), "", "127.0.0.1"};
  boost::asio::io_context context_;
  udp::socket socket_{context_, udp::v4()};
};

TEST_F(ReceiverTest, AveragesTheLastFramesByTheNamesOfTheObjects) {
  send_frames(1, 20, 1000.0);
  ASSERT_EQ(received(20), 20);
  const CaptureAverage average = receiver_.average(10, {});
  ASSERT_TRUE(average.is_tracked());
  EXPECT_EQ(average.camera.frames, 10);
  EXPECT_NEAR(average.camera.T_V_object.translation().x(), 1.0145, 1e-12);  // mean of 1010 to 1019 mm
  EXPECT_NEAR(average.camera.T_V_object.translation().y(), 0.002, 1e-15);
  EXPECT_NEAR(average.target.T_V_object.translation().y(), 1.0, 1e-12);
  EXPECT_NEAR(average.target.T_V_object.linear()(1, 0), std::sin(0.5), 1e-14);
  EXPECT_EQ(receiver_.counts().frames, 20U);
  EXPECT_EQ(receiver_.counts().frames_lost, 0U);
}

TEST_F(ReceiverTest, FramesBeforeClearAreForgotten) {
  send_frames(1, 5, 0.0);
  ASSERT_EQ(received(5), 5);
  receiver_.clear();
  EXPECT_EQ(receiver_.drain(), 0);
  EXPECT_EQ(receiver_.average(5, {}).camera.state, ObjectState::kSilent);
  send_frames(6, 5, 100.0);
  ASSERT_EQ(received(5), 5);
  EXPECT_EQ(receiver_.average(20, {}).camera.state, ObjectState::kSilent);  // 5 of 20 are too few
  EXPECT_TRUE(receiver_.average(5, {}).is_tracked());
}

TEST_F(ReceiverTest, CountsFramesThatAreLostLateOrBegunAgain) {
  for (const std::uint32_t number : {10U, 11U, 14U, 12U, 13U, 15U}) send({number, {{"camera", {1.0}}}});
  ASSERT_EQ(received(4), 4);
  send({1, {{"camera", {1.0}}}});  // 14 before the last one: late
  send({1015, {{"camera", {1.0}}}});
  send({3, {{"camera", {1.0}}}});  // begun again
  ASSERT_EQ(received(6), 6);
  EXPECT_EQ(receiver_.counts().frames_lost, 2U + 999U);
  EXPECT_EQ(receiver_.counts().late_blocks, 3U);
  EXPECT_EQ(receiver_.counts().restarts, 1U);
}

TEST_F(ReceiverTest, FrameNumbersPassTheirLargestValue) {
  for (const std::uint32_t number : {0xFFFFFFFEU, 0xFFFFFFFFU, 0U, 1U}) send({number, {{"camera", {1.0}}}});
  ASSERT_EQ(received(4), 4);
  EXPECT_EQ(receiver_.counts().frames_lost, 0U);
  EXPECT_EQ(receiver_.counts().restarts, 0U);
}

TEST_F(ReceiverTest, PutsTheBlocksOfAFrameTogether) {
  for (std::uint32_t number = 1; number <= 5; ++number)
    send({number, {{"a"}, {"camera", {1.0}}, {"b"}, {"c"}, {"target", {2.0}}}}, 256);
  ASSERT_EQ(received(5), 5);
  // The second block of the last frame may still be on its way.
  EXPECT_GE(receiver_.average(5, {}).target.frames, 4);
  EXPECT_EQ(receiver_.counts().frames, 5U);
}

TEST_F(ReceiverTest, AnObjectIsMissingOrOccludedByMostOfTheFrames) {
  for (std::uint32_t number = 1; number <= 10; ++number) {
    ObjectBlock frame{number, {{"camera", {number < 6 ? 1.0 : 0.0}}}};
    if (number < 5) frame.objects.push_back({"target", {1.0}});
    send(frame);
  }
  ASSERT_EQ(received(10), 10);
  const CaptureAverage average = receiver_.average(10, {});
  EXPECT_EQ(average.camera.state, ObjectState::kTracked);  // 5 of 10
  EXPECT_EQ(average.camera.frames, 5);
  EXPECT_EQ(average.target.state, ObjectState::kMissing);
  EXPECT_EQ(receiver_.average(4, {}).camera.state, ObjectState::kOccluded);
  EXPECT_EQ(receiver_.counts().missing, 2U);
  EXPECT_EQ(receiver_.counts().occluded, 1U);
}

TEST_F(ReceiverTest, AnObjectThatKeepsItsBitsAfterAMoveIsFrozen) {
  const auto rest = [&](std::uint32_t first, double camera_mm, double target_mm) {
    receiver_.clear();
    for (std::uint32_t k = 0; k < 4; ++k) send({first + k, {{"camera", {camera_mm}}, {"target", {target_mm}}}});
    ASSERT_EQ(received(4), 4);
  };
  rest(1, 100.0, 200.0);
  EXPECT_TRUE(receiver_.average(4, {}).is_tracked());
  rest(5, 100.0, 200.0);
  EXPECT_TRUE(receiver_.average(4, {false, false}).is_tracked());  // neither has moved
  rest(9, 100.0, 201.0);
  const CaptureAverage average = receiver_.average(4, {true, true});
  EXPECT_EQ(average.camera.state, ObjectState::kFrozen);
  EXPECT_EQ(average.target.state, ObjectState::kTracked);
  rest(13, 100.0, 202.0);
  EXPECT_EQ(receiver_.average(4, {true, true}).camera.state, ObjectState::kFrozen);  // still
  rest(17, 101.0, 203.0);
  EXPECT_TRUE(receiver_.average(4, {true, true}).is_tracked());
  EXPECT_EQ(receiver_.counts().frozen, 2U);
}

TEST_F(ReceiverTest, HostileDatagramsAreCountedAndExplained) {
  send_bytes({});
  send_bytes({1, 2, 3});
  send_bytes(Bytes(60000, 0xFF));
  send_frames(1, 1, 0.0);
  ASSERT_EQ(received(1), 1);
  EXPECT_EQ(receiver_.counts().unreadable, 3U);
  EXPECT_THAT(receiver_.counts().last_unreadable, HasSubstr("Vicon block, byte "));
}

TEST_F(ReceiverTest, WaitsNoLongerThanAsked) {
  EXPECT_EQ(receiver_.wait_for(1, std::chrono::milliseconds(10)), 0);
}

TEST(Receiver, NamesAPortThatIsTaken) {
  ViconSettings settings;
  settings.port = 0;
  const Receiver first(settings, "", "127.0.0.1");
  settings.port = first.port();
  try {
    const Receiver second(settings, "", "127.0.0.1");
    FAIL() << "both have the port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("Vicon: UDP port " + std::to_string(first.port())));
  }
  EXPECT_THROW(Receiver(settings, "xxx", "127.0.0.2"), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron::vicon
