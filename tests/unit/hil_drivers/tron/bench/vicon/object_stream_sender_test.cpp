// The emulated stream, read by the driver's receiver.

#include "hil_drivers/tron/bench/vicon/object_stream_sender.h"

#include <gtest/gtest.h>

#include "hil_drivers/tron/vicon/receiver.h"

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;
using vicon::ObjectState;

constexpr std::chrono::seconds kPatience{60};

class ObjectStreamSenderTest : public ::testing::Test {
 protected:
  explicit ObjectStreamSenderTest(const std::string& rotation = "xyz") {
    ViconSettings listening;
    listening.port = 0;
    listening.rotation = rotation;
    receiver_.emplace(listening, "", "127.0.0.1");
    ObjectStreamSettings settings;
    settings.vicon = listening;
    settings.vicon.port = receiver_->port();
    settings.first_frame = 0xFFFFFFF0U;
    sender_.emplace(context_, settings, errors_,
                    [this](CaptureObject object) { return poses_[static_cast<std::size_t>(object)]; });
    for (auto& pose : poses_) pose = Eigen::Isometry3d::Identity();
    poses_[0]->translation() = Vector3(3.0, 0.0, 2.0);
    poses_[1]->translation() = Vector3(6.5, 0.0, 1.4);
    poses_[1]->linear() = Eigen::AngleAxisd(2.0, Vector3(1, -1, 3).normalized()).toRotationMatrix();
  }

  /// Robot cycles of 4 ms; returns the frames that they sent.
  int run(int cycles) {
    int frames = 0;
    for (int k = 0; k < cycles; ++k) frames += sender_->tick(0.004 * ++cycle_);
    return frames;
  }
  /// Runs at rest and averages.
  vicon::CaptureAverage at_rest() {
    receiver_->clear();
    const int frames = run(25);
    EXPECT_EQ(receiver_->wait_for(frames, kPatience), frames);
    return receiver_->average(frames, {});
  }

  boost::asio::io_context context_;
  CaptureErrors errors_{CaptureErrorSizes::none(), 1};
  std::array<std::optional<Eigen::Isometry3d>, kCaptureObjects> poses_;
  std::optional<vicon::Receiver> receiver_;
  std::optional<ObjectStreamSender> sender_;
  int cycle_ = 0;
};

TEST_F(ObjectStreamSenderTest, SendsAHundredFramesASecondOfBenchTime) {
  EXPECT_EQ(run(2), 0);  // 8 ms
  EXPECT_EQ(run(1), 1);  // 12 ms: the frame of 10 ms
  EXPECT_EQ(run(2), 1);  // 20 ms: that of 20 ms
  EXPECT_EQ(run(2495), 998);
  EXPECT_EQ(sender_->frames(), 1000U);
  EXPECT_EQ(receiver_->wait_for(1000, kPatience), 1000);
  EXPECT_EQ(receiver_->counts().frames_lost, 0U);
  EXPECT_EQ(receiver_->counts().restarts, 0U);  // although the numbers pass their largest value
}

TEST_F(ObjectStreamSenderTest, StatesTheTruePosesWithoutErrors) {
  const auto average = at_rest();
  ASSERT_TRUE(average.is_tracked());
  EXPECT_TRUE(average.camera.T_V_object.isApprox(*poses_[0], 1e-12));
  EXPECT_TRUE(average.target.T_V_object.isApprox(*poses_[1], 1e-12));
}

class OtherOrder : public ObjectStreamSenderTest {
 protected:
  OtherOrder() : ObjectStreamSenderTest("zyx") {}
};
TEST_F(OtherOrder, StatesTheAnglesInTheOrderOfTheSettings) {
  EXPECT_TRUE(at_rest().target.T_V_object.isApprox(*poses_[1], 1e-12));
}

TEST_F(ObjectStreamSenderTest, AnObjectThatIsNotSeenIsAllZeros) {
  poses_[1].reset();
  const auto average = at_rest();
  EXPECT_EQ(average.target.state, ObjectState::kOccluded);
  EXPECT_EQ(average.camera.state, ObjectState::kTracked);
}

TEST_F(ObjectStreamSenderTest, FaultsAreSeenUntilTheyAreTakenBack) {
  ASSERT_TRUE(at_rest().is_tracked());
  sender_->set_hidden(CaptureObject::kTarget, true);
  sender_->set_zeros(CaptureObject::kCamera, true);
  auto average = at_rest();
  EXPECT_EQ(average.target.state, ObjectState::kMissing);
  EXPECT_EQ(average.camera.state, ObjectState::kOccluded);
  sender_->set_hidden(CaptureObject::kTarget, false);
  sender_->set_zeros(CaptureObject::kCamera, false);
  poses_[0]->translation().x() += 0.1;
  poses_[1]->translation().x() += 0.1;
  ASSERT_TRUE(at_rest().is_tracked());

  sender_->set_frozen(CaptureObject::kTarget, true);
  poses_[0]->translation().x() += 0.1;
  poses_[1]->translation().x() += 0.1;
  average = at_rest();
  EXPECT_EQ(average.target.state, ObjectState::kFrozen);
  EXPECT_EQ(average.camera.state, ObjectState::kTracked);
  sender_->set_frozen(CaptureObject::kTarget, false);
  EXPECT_EQ(at_rest().target.state, ObjectState::kTracked);

  sender_->set_offset(CaptureObject::kCamera, 0.02);
  average = at_rest();
  EXPECT_NEAR(average.camera.T_V_object.translation().x(), poses_[0]->translation().x() + 0.02, 1e-12);
  sender_->set_offset(CaptureObject::kCamera, 0.0);
  poses_[0]->translation().y() += 0.1;
  EXPECT_NEAR(at_rest().camera.T_V_object.translation().x(), poses_[0]->translation().x(), 1e-12);
}

TEST_F(ObjectStreamSenderTest, NobodyHasToListen) {
  receiver_.reset();
  EXPECT_EQ(run(250), 100);
}

}  // namespace
}  // namespace vbar::tron::bench
