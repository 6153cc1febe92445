#include "hil_drivers/tron/imaging/image_exchange.h"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/pose_fusion.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

using testing::HasSubstr;

Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = fsw::Vector3(x, y, z);
  return T;
}

/// A bench whose relative pose is that by the calibrated arms plus an error that nobody but motion capture sees. The
/// carriage alone moves: the relative pose follows it.
struct FakeBench final : MotionPlanner, LightPlanner, Laboratory {
  explicit FakeBench(const Calibration& of) : calibration(of) {}

  // Planner
  std::variant<Place, PlacementFailure> place(const Scene& /*scene*/, const Posture& from,
                                              std::int64_t /*image*/) override {
    if (!no_place.empty()) return PlacementFailure{no_place};
    Place found;
    found.posture = from;
    found.posture.carriage_m = 4.0;
    found.lamp_azimuth_rad = lamp_azimuth_rad;
    found.hidden = 2;
    found.shaded = 1;
    return found;
  }
  std::variant<Motion, PlacementFailure> path(const Posture& /*from*/, const Posture& to) override {
    if (!no_path.empty()) return PlacementFailure{no_path};
    return Motion{10, [to](int /*cycle*/) { return to; }, nullptr};
  }
  std::optional<Posture> corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) override {
    Posture posture = from;
    // T_C_T of the arms is that at carriage 4 m, moved along the camera's axis x_L by the carriage.
    wanted.push_back(T_C_T);
    posture.carriage_m = 4.0 + (T_C_T_of_arms(calibration, carriage(4.0)).inverse() * T_C_T).translation().norm();
    return posture;
  }

  // Lights
  LightLevels levels(const Scene& scene, const Place& place) override {
    LightLevels found;
    found.lamp_power = scene.sunlit;
    found.lamp_azimuth_rad = place.lamp_azimuth_rad;
    return found;
  }

  // Laboratory
  Posture posture() override { return stands; }
  MotionEnd follow(const Motion& motion) override {
    time += 0.5;
    if (interruptions > 0) {
      --interruptions;
      return MotionEnd::kInterrupted;
    }
    stands = motion.at(motion.cycles);
    return MotionEnd::kArrived;
  }
  MotionEnd hold(double bench_s) override {
    time += bench_s;
    held_s += bench_s;
    return MotionEnd::kArrived;
  }
  void recover() override { ++recoveries; }
  std::variant<MeasuredPlace, MotionEnd> measure() override {
    MeasuredPlace place;
    place.posture = stands;
    if (has_capture) {
      // Objects and frames coincide with camera and target in this calibration.
      place.capture = CapturedPoses{Eigen::Isometry3d::Identity(), T_C_T_of_arms(calibration, stands) * capture_error};
    }
    return place;
  }
  void light(const LightLevels& levels) override { lights.push_back(levels); }
  DetectorFrame take(double exposure_s) override {
    exposures.push_back(exposure_s);
    time_of_exposure = time;
    return {std::vector<std::uint16_t>(4, 7), 3, 2};
  }
  double time_s() const override { return time; }

  static Posture carriage(double carriage_m) {
    Posture posture;
    posture.carriage_m = carriage_m;
    return posture;
  }

  const Calibration& calibration;
  std::string no_place, no_path;
  double lamp_azimuth_rad = 1.0;
  Posture stands = carriage(3.0);
  int interruptions = 0, recoveries = 0;
  bool has_capture = true;
  Eigen::Isometry3d capture_error = Eigen::Isometry3d::Identity();
  double time = 100.0, held_s = 0.0, time_of_exposure = 0.0;
  std::vector<LightLevels> lights;
  std::vector<double> exposures;
  std::vector<Eigen::Isometry3d> wanted;
};

class TronExchange : public testing::Test {
 protected:
  TronExchange()
      : calibration_(calibration_as_designed(read_testbed_design(tests::source_path("data/benches/tron.toml")))) {
    calibration_.vicon.T_C_object = PoseFigures::of(Eigen::Isometry3d::Identity());
    calibration_.vicon.T_object_T = PoseFigures::of(Eigen::Isometry3d::Identity());
    calibration_.covariance.arms = 1e-8 * Matrix6::Identity();
    calibration_.covariance.vicon = 1e-8 * Matrix6::Identity();
    scene_.T_C_T = T_C_T_of_arms(calibration_, FakeBench::carriage(4.0));
  }

  SceneImage take() { return exchange_.take(scene_, 5, 4e-4, row_); }

  Calibration calibration_;
  FakeBench bench_{calibration_};
  ExchangeSettings settings_;
  ImageExchange exchange_{settings_, calibration_, bench_, bench_, bench_};
  Scene scene_;
  TronRow row_;
};

TEST_F(TronExchange, TakesAnImageAtTheCommandedPose) {
  const SceneImage image = take();
  EXPECT_EQ(image.dn.size(), 4U);
  EXPECT_TRUE(image.is_lit);
  EXPECT_EQ(row_.failure, "");
  EXPECT_EQ(row_.pose_source, "fused");
  EXPECT_EQ(row_.moves, 1);
  EXPECT_EQ(row_.hidden, 2);
  EXPECT_EQ(row_.shaded, 1);
  EXPECT_EQ(row_.tries, 2);
  EXPECT_EQ(row_.packets_resent, 3);
  EXPECT_NEAR(row_.pose_error_mm.value(), 0.0, 1e-6);
  EXPECT_THAT(bench_.exposures, testing::ElementsAre(4e-4));
  ASSERT_EQ(bench_.lights.size(), 1U);
  EXPECT_EQ(bench_.lights.front().lamp_power, 1.0);
}

TEST_F(TronExchange, WaitsForTheLampAsBenchTimeSays) {
  static_cast<void>(take());
  bench_.lamp_azimuth_rad = 1.0 + 0.17 * 10.0;  // ten seconds of its way
  const double before_s = bench_.time;
  static_cast<void>(take());
  EXPECT_GE(bench_.time_of_exposure - before_s, 10.0 + settings_.lamp_delay_s - 1e-9);
}

/// Both sources weigh the same, so the fused pose is off by half of what motion capture says; their covariances scale
/// with the range, which differs by a thousandth.
TEST_F(TronExchange, CorrectsThePoseOnce) {
  bench_.capture_error = at(2e-3, 0.0, 0.0);
  calibration_.covariance.arms = 1e-6 * Matrix6::Identity();
  calibration_.covariance.vicon = 1e-6 * Matrix6::Identity();
  static_cast<void>(take());
  EXPECT_EQ(row_.moves, 2);
  EXPECT_NEAR(row_.first_error_mm.value(), 1.0, 2e-3);
  ASSERT_EQ(bench_.wanted.size(), 2U);
  // The arms shall go where their own pose is short by that.
  const Eigen::Isometry3d change = scene_.T_C_T.inverse() * bench_.wanted.back();
  EXPECT_NEAR(change.translation().x(), -1e-3, 2e-6);
}

TEST_F(TronExchange, PoseThatIsTooFarOffIsNoImage) {
  calibration_.covariance.arms = 1e-2 * Matrix6::Identity();
  calibration_.covariance.vicon = 1e-2 * Matrix6::Identity();
  bench_.capture_error = at(0.04, 0.0, 0.0);
  EXPECT_TRUE(take().dn.empty());
  EXPECT_THAT(row_.failure, HasSubstr("too far"));
  EXPECT_TRUE(bench_.exposures.empty());
}

TEST_F(TronExchange, MotionCaptureThatIsHiddenLeavesTheArms) {
  bench_.has_capture = false;
  EXPECT_FALSE(take().dn.empty());
  EXPECT_EQ(row_.pose_source, "arms");
  EXPECT_FALSE(row_.disagreement.has_value());
}

TEST_F(TronExchange, DisagreementLeavesTheArmsAndEndsAfterFiveImages) {
  bench_.capture_error = at(0.5, 0.0, 0.0);
  for (int k = 0; k < 4; ++k) {
    EXPECT_FALSE(take().dn.empty());
    EXPECT_EQ(row_.pose_source, "arms");
    EXPECT_GT(row_.disagreement.value(), kFusionGate);
  }
  EXPECT_THAT([&] { static_cast<void>(take()); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("a mount has slipped")));
}

TEST_F(TronExchange, SceneWithoutPlaceOrWayIsNoImage) {
  bench_.no_place = "no placement: too far";
  EXPECT_TRUE(take().dn.empty());
  EXPECT_EQ(row_.failure, "no placement: too far");
  bench_.no_place.clear();
  bench_.no_path = "no way";
  row_ = {};
  EXPECT_TRUE(take().dn.empty());
  EXPECT_EQ(row_.failure, "no way");
  EXPECT_TRUE(bench_.exposures.empty());
}

TEST_F(TronExchange, InterruptedMotionIsBegunAgain) {
  bench_.interruptions = 2;
  EXPECT_FALSE(take().dn.empty());
  EXPECT_EQ(bench_.recoveries, 2);
  EXPECT_EQ(row_.failure, "");
}

TEST_F(TronExchange, ThirdInterruptionOfAnImageEndsTheRun) {
  bench_.interruptions = 3;
  EXPECT_THAT([&] { static_cast<void>(take()); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("image 5 was interrupted 3 times")));
}

TEST_F(TronExchange, UnlitTargetIsADarkImageWithoutAMove) {
  scene_.sunlit = 0.0;
  scene_.earth_to_sun = 0.0;
  const SceneImage image = take();
  EXPECT_FALSE(image.dn.empty());
  EXPECT_FALSE(image.is_lit);
  EXPECT_EQ(row_.moves, 0);
  ASSERT_EQ(bench_.lights.size(), 1U);
  EXPECT_EQ(bench_.lights.front().lamp_power, 0.0);
}

TEST_F(TronExchange, EarthlightAloneIsLight) {
  scene_.sunlit = 0.0;
  scene_.earth_to_sun = 0.1;
  EXPECT_TRUE(take().is_lit);
  EXPECT_EQ(row_.moves, 1);
}

}  // namespace
}  // namespace vbar::tron
