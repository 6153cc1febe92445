// Sizes of the hidden errors over benches, and what they depend on.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "emulators/tron/world/motion_capture.h"
#include "emulators/tron/world/vicon_visibility.h"
#include "hil_drivers/tron/protocols/vicon_receiver.h"
#include "host_sim/mission/data_file.h"

namespace vbar::tron::bench {

namespace {

using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Isometry3d pose(double x, double y, double z, double angle = 0.3) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Vector3(x, y, z);
  return pose;
}

double angle_of(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle();
}

TEST(CaptureErrors, OfABenchWithoutErrorsAreNone) {
  const CaptureErrors errors(CaptureErrorSizes::none(), 1);
  const auto truth = pose(6.5, 0.1, 1.4);
  for (const auto object : {CaptureObject::kCamera, CaptureObject::kTarget})
    EXPECT_TRUE(errors.stated(object, truth, 17).isApprox(truth, 1e-15));
}

TEST(CaptureErrors, AreFunctionsOfSeedPoseAndFrame) {
  const CaptureErrors errors({}, 5), same({}, 5), other({}, 6);
  const auto truth = pose(3.0, 0.0, 2.0);
  const auto stated = errors.stated(CaptureObject::kCamera, truth, 8);
  (void)same.stated(CaptureObject::kTarget, truth, 3);
  EXPECT_EQ(same.stated(CaptureObject::kCamera, truth, 8).matrix(), stated.matrix());
  EXPECT_NE(errors.stated(CaptureObject::kCamera, truth, 9).matrix(), stated.matrix());
  EXPECT_GT((other.stated(CaptureObject::kCamera, truth, 8).matrix() - stated.matrix()).norm(), 1e-3);
}

// Of 500 benches; the standard deviation of a standard deviation of 1500 numbers is 2 %.
TEST(CaptureErrors, HaveTheSizesAsked) {
  CaptureErrorSizes frame = CaptureErrorSizes::none(), bias = frame, view = frame, noise = frame;
  frame.frame_rotation_deg = 2.0;
  frame.frame_translation_mm = 50.0;
  bias.bias_mm = 0.3;
  view.view_rotation_deg = 0.09;
  noise.noise_mm = 0.05;
  noise.noise_deg = 0.02;
  const auto truth = pose(4.0, 0.5, 1.0);
  double frame_m2 = 0, frame_rad2 = 0, bias_m2 = 0, view_rad2 = 0, noise_m2 = 0, noise_rad2 = 0;
  constexpr int kBenches = 500;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    const CaptureErrors offset(frame, seed);
    frame_m2 += offset.T_V_L().translation().squaredNorm();
    frame_rad2 += std::pow(angle_of(offset.T_V_L().linear()), 2);
    const auto error = [&](const CaptureErrorSizes& sizes) -> Eigen::Isometry3d {
      return truth.inverse() * CaptureErrors(sizes, seed).stated(CaptureObject::kTarget, truth, seed);
    };
    bias_m2 += error(bias).translation().squaredNorm();
    view_rad2 += std::pow(angle_of(error(view).linear()), 2);
    noise_m2 += error(noise).translation().squaredNorm();
    noise_rad2 += std::pow(angle_of(error(noise).linear()), 2);
  }
  const auto sigma = [](double sum) { return std::sqrt(sum / (3.0 * kBenches)); };
  EXPECT_NEAR(sigma(frame_m2), 50e-3, 0.1 * 50e-3);
  EXPECT_NEAR(sigma(frame_rad2), 2.0 * kDegree, 0.1 * 2.0 * kDegree);
  EXPECT_NEAR(sigma(bias_m2), 0.3e-3, 0.1 * 0.3e-3);
  EXPECT_NEAR(sigma(view_rad2), 0.09 * kDegree, 0.1 * 0.09 * kDegree);
  EXPECT_NEAR(sigma(noise_m2), 0.05e-3, 0.1 * 0.05e-3);
  EXPECT_NEAR(sigma(noise_rad2), 0.02 * kDegree, 0.1 * 0.02 * kDegree);
}

// Covariance of a Gaussian field: exp(-d^2/2) at d correlation lengths: 0.995, 0.607, 0.011 at 0.1, 1, 3.
TEST(CaptureErrors, BiasVariesOverAMetre) {
  CaptureErrorSizes sizes = CaptureErrorSizes::none();
  sizes.bias_mm = 0.3;
  double same = 0, near = 0, at_length = 0, far = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const CaptureErrors errors(sizes, seed);
    const auto bias = [&](double x) -> Vector3 {
      return errors.stated(CaptureObject::kCamera, pose(x, 0, 1), 0).translation() - Vector3(x, 0, 1);
    };
    same += bias(4).squaredNorm();
    near += bias(4).dot(bias(4.1));
    at_length += bias(4).dot(bias(5));
    far += bias(4).dot(bias(7));
  }
  EXPECT_NEAR(near / same, 0.995, 0.01);
  EXPECT_NEAR(at_length / same, 0.607, 0.1);
  EXPECT_NEAR(far / same, 0.011, 0.1);
}

TEST(CaptureErrors, AnObjectHasTheSameErrorWheneverItIsAtAPose) {
  CaptureErrorSizes sizes;
  sizes.noise_mm = sizes.noise_deg = 0.0;
  const CaptureErrors errors(sizes, 3);
  const auto here = pose(4.0, 0.0, 1.0), turned = pose(4.0, 0.0, 1.0, 1.5);
  const auto rotation_error = [&](const Eigen::Isometry3d& truth, CaptureObject object) -> Eigen::Matrix3d {
    const Eigen::Isometry3d without = errors.T_V_L() * truth * errors.T_body_object(object);
    return without.linear().transpose() * errors.stated(object, truth, 1).linear();
  };
  EXPECT_EQ(errors.stated(CaptureObject::kCamera, here, 1).matrix(),
            errors.stated(CaptureObject::kCamera, here, 900).matrix());
  EXPECT_GT(angle_of(rotation_error(here, CaptureObject::kCamera).transpose() *
                     rotation_error(turned, CaptureObject::kCamera)),
            0.01 * kDegree);
  EXPECT_GT(
      angle_of(rotation_error(here, CaptureObject::kCamera).transpose() * rotation_error(here, CaptureObject::kTarget)),
      0.01 * kDegree);
}

}  // namespace

// The emulated stream, read by the driver's receiver.

namespace {

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

namespace {

ViconVisibility cameras() {
  return ViconVisibility(read_testbed_design(mission::data_directory() / "benches" / "tron.toml"));
}

Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Vector3(x, y, z);
  return T;
}

TEST(ViconVisibility, SegmentsThroughABallOfKnownPlace) {
  const Capsule capsule{{0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, 0.1};
  EXPECT_TRUE(crosses({-1.0, 0.09, 0.0}, {1.0, 0.09, 0.0}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.11, 0.0}, {1.0, 0.11, 0.0}, capsule));
  EXPECT_TRUE(crosses({-1.0, 0.0, 1.09}, {1.0, 0.0, 1.09}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.0, 1.11}, {1.0, 0.0, 1.11}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.0, 0.0}, {-0.2, 0.0, 0.0}, capsule));
}

TEST(ViconVisibility, SegmentsThroughABlock) {
  const Block block{at(1.0, 2.0, 3.0), {-0.1, -0.2, -0.3}, {0.1, 0.2, 0.3}};
  EXPECT_TRUE(crosses({0.0, 2.19, 3.0}, {2.0, 2.19, 3.0}, block));
  EXPECT_FALSE(crosses({0.0, 2.21, 3.0}, {2.0, 2.21, 3.0}, block));
  EXPECT_FALSE(crosses({0.0, 2.0, 3.0}, {0.5, 2.0, 3.0}, block));
  EXPECT_FALSE(crosses({1.2, 2.0, 0.0}, {1.2, 2.0, 9.0}, block));
}

TEST(ViconVisibility, MarkersOfABoxInTheOpenAreSeenButForThoseThatFaceTheFloor) {
  const auto markers = markers_of_box({-0.15, -0.15, -0.1}, {0.15, 0.15, 0.1});
  EXPECT_EQ(markers.size(), 14U);
  const Block self{at(6.5, 0.0, 1.4), {-0.15, -0.15, -0.1}, {0.15, 0.15, 0.1}};
  const std::size_t located = cameras().located(self.T_L_block, markers, {}, {self});
  EXPECT_GE(located, 8U);
  EXPECT_LT(located, 14U);  // the lowest cannot see a ceiling
}

TEST(ViconVisibility, ABodyAroundTheObjectHidesIt) {
  const auto markers = markers_of_box({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05});
  const Capsule bag{{6.5, 0.0, 1.4}, {6.5, 0.0, 1.4}, 0.3};
  EXPECT_EQ(cameras().located(at(6.5, 0.0, 1.4), markers, {bag}, {}), 0U);
}

}  // namespace

}  // namespace vbar::tron::bench
