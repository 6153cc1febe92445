// Telemetry of a pose against a truth that can be worked out by hand: camera axes along ECI, the target straight ahead
// or at a place whose pixel OpenCV gives.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/camera/camera_truth.h"
#include "tests/unit/host_sim/sensors/editable_camera.h"

namespace vbar::sensors {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using fsw::Vector3;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kMission = R"(
[mission]
duration_h = 1.0
[guidance]
mode = "idle"
[[spacecraft]]
name = "servicer"
flight_computer = {}
sensors.gnss = {}
sensors.camera = { camera = "tron", navigation = "pose", position_body_m = [0.0, 0.0, 0.5] }
actuators.thruster = {}
attitude = { profile = "commanded" }
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 90, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
[[spacecraft]]
name = "target"
model = "tango"
attitude = { profile = "tumble" }
relative = { to = "servicer", a_roe_m = [0, -10, 0, 0, 0, 0] }
)";

void set(double (&to)[4], const Quaterniond& q) {
  const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz, wxyz + 4, to);
}
void set(double (&to)[3], const Vector3& v) {
  std::copy(v.begin(), v.end(), to);
}

class PoseTruth : public testing::Test {
 protected:
  void SetUp() override {
    truth_.time = mission_.epoch;
    truth_.spacecraft = {{"servicer", {kPlace, kVelocity}, truth::AttitudeState{}},
                         {"target", {kPlace + Vector3(1.2, -0.7, 6.5), kVelocity}, truth::AttitudeState{}}};
    truth_.spacecraft[1].attitude->q_body_eci = kQ.conjugate();
    truth_.spacecraft[1].attitude->rate_body = kRate;
    pose_.pnp_inliers = 8;
    pose_.filter_runs = pose_.has_attitude = 1;
    pose_.images_used = 1;
    set(pose_.pnp_q_camera_body, kQ);
    set(pose_.q_camera_body, kQ);
    set(pose_.pnp_position_camera_m, kAhead);
    set(pose_.rate_body, kRate);
    for (int k = 0, place = 0; k < 6; place += ++k + 1) pose_.covariance_attitude[place] = 1.0;
  }

  [[nodiscard]] PoseRow row() {
    auto row = report::row_of<PoseRow>(pose_);
    keypoints_.clear();
    append_keypoints(100.0, pose_, keypoints_);
    add_truth(row, keypoints_, pose_, keypoints_body_m_, known_, mission_.spacecraft[0], truth_);
    return row;
  }

  /// Each of six independent components of the attitude's error is one sigma.
  void set_attitude_sigmas(const Vector3& rotation, const Vector3& rate) {
    for (int k = 0, place = 0; k < 6; place += ++k + 1)
      pose_.covariance_attitude[place] = std::pow(k < 3 ? rotation(k) : rate(k - 3), 2.0);
  }

  const Vector3 kPlace{7.0e6, 0.0, 0.0};
  const Vector3 kVelocity{0.0, 100.0, 7546.0};
  const Vector3 kAhead{1.2, -0.7, 6.0};  // of the camera, half a metre before the servicer's centre of mass
  const Vector3 kRate{0.01, -0.02, 0.005};
  const Quaterniond kQ{AngleAxisd(0.7, Vector3(0.6, 0.0, -0.8))};  // camera from body
  mission::Mission mission_ = sensors::parse_mission(kMission, "m.toml");
  CameraSensor known_ = *navigation_camera(mission_.spacecraft[0]);
  twins::TruthSnapshot truth_;
  telemetry_pose pose_{};
  double keypoints_body_m_[33] = {};
  std::vector<KeypointRow> keypoints_;
};

TEST_F(PoseTruth, AnExactPoseHasNoError) {
  const PoseRow exact = row();
  EXPECT_NEAR(exact.range_m.value(), std::sqrt(1.44 + 0.49 + 36.0), 1e-9);
  EXPECT_NEAR(exact.pnp_error_deg.value(), 0.0, 1e-6);
  EXPECT_NEAR(exact.attitude_error_deg.value(), 0.0, 1e-12);
  EXPECT_NEAR(exact.rate_error_radps.value(), 0.0, 1e-15);
  EXPECT_NEAR(exact.attitude_nees.value(), 0.0, 1e-12);
}

TEST_F(PoseTruth, PnpErrorIsInTheCamerasAxes) {
  set(pose_.pnp_position_camera_m, kAhead + Vector3(0.1, -0.2, 0.3));
  set(pose_.pnp_q_camera_body, kQ * Quaterniond(AngleAxisd(5.0 * kDegree, Vector3(0.0, 0.6, 0.8))));
  const PoseRow off = row();
  EXPECT_NEAR(off.pnp_error_x_m.value(), 0.1, 1e-9);
  EXPECT_NEAR(off.pnp_error_y_m.value(), -0.2, 1e-9);
  EXPECT_NEAR(off.pnp_error_z_m.value(), 0.3, 1e-9);
  EXPECT_NEAR(off.pnp_error_deg.value(), 5.0, 1e-9);
  pose_.pnp_inliers = 0;
  EXPECT_FALSE(row().pnp_error_deg.has_value()) << "no pose";
}

TEST_F(PoseTruth, AttitudeErrorIsARotationAboutBodyAxes) {
  const Vector3 rotation = kDegree * Vector3(1.0, -2.0, 2.0), rate(1e-3, 2e-3, -2e-3);
  for (const double sign : {1.0, -1.0}) {
    Quaterniond q = kQ * Quaterniond(AngleAxisd(rotation.norm(), rotation.normalized()));
    q.coeffs() *= sign;  // the same attitude
    set(pose_.q_camera_body, q);
    set(pose_.rate_body, kRate + rate);
    set_attitude_sigmas(rotation, rate);
    const PoseRow off = row();
    EXPECT_NEAR(off.attitude_error_x_deg.value(), 1.0, 1e-9);
    EXPECT_NEAR(off.attitude_error_y_deg.value(), -2.0, 1e-9);
    EXPECT_NEAR(off.attitude_error_z_deg.value(), 2.0, 1e-9);
    EXPECT_NEAR(off.attitude_error_deg.value(), 3.0, 1e-9);
    EXPECT_NEAR(off.rate_error_radps.value(), 3e-3, 1e-15);
    EXPECT_NEAR(off.attitude_nees.value(), 6.0, 1e-9);
  }
  pose_.covariance_attitude[0] = -1.0;
  EXPECT_FALSE(row().attitude_nees.has_value());
  pose_.has_attitude = 0;
  EXPECT_FALSE(row().attitude_error_deg.has_value());
}

TEST_F(PoseTruth, AnAttitudeHalfATurnOffIsHalfATurnOff) {
  set(pose_.q_camera_body, kQ * Quaterniond(AngleAxisd(179.0 * kDegree, Vector3::UnitY())));
  EXPECT_NEAR(row().attitude_error_deg.value(), 179.0, 1e-9);
  set(pose_.q_camera_body, kQ * Quaterniond(AngleAxisd(181.0 * kDegree, Vector3::UnitY())));
  EXPECT_NEAR(row().attitude_error_deg.value(), 179.0, 1e-9);
  EXPECT_NEAR(row().attitude_error_y_deg.value(), -179.0, 1e-9);
}

// cv::projectPoints of OpenCV 4.6 gives (1533.595087, 264.488355) of the point (1.2, -0.7, 6) and (1213.924513,
// 1299.152424) of (0.4, 1.1, 4.5). Telemetry is in single precision: 1.2e-4 px of such numbers.
TEST_F(PoseTruth, KeypointErrorsArePixelsOfTheLens) {
  const Vector3 body = kQ.conjugate() * (Vector3(0.4, 1.1, 4.5) - kAhead);
  std::copy(body.begin(), body.end(), keypoints_body_m_ + 9);  // keypoint 3; the others are at the centre of mass
  for (int k = 0; k < 11; ++k) {
    pose_.keypoint_fate[k] = 2;
    pose_.x_px[k] = 1535.5951F;
    pose_.y_px[k] = 261.48835F;
  }
  pose_.x_px[3] = 1213.4245F;
  pose_.y_px[3] = 1299.1524F;
  pose_.keypoint_fate[5] = 0;
  static_cast<void>(row());
  ASSERT_EQ(keypoints_.size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_EQ(keypoints_[k].error_x_px.has_value(), k != 5) << "the network has no keypoint 5 in this image";
    if (k == 5) continue;
    EXPECT_NEAR(keypoints_[k].error_x_px.value(), k == 3 ? -0.5 : 2.0, 2e-4) << k;
    EXPECT_NEAR(keypoints_[k].error_y_px.value(), k == 3 ? 0.0 : -3.0, 2e-4) << k;
  }
}

TEST_F(PoseTruth, KeypointErrorsOfATestbedAreThoseThroughItsCalibratedLens) {
  pose_.keypoint_fate[0] = 2;
  static_cast<void>(row());
  const double x = keypoints_[0].error_x_px.value(), y = keypoints_[0].error_y_px.value();
  known_.settings.optics.principal_point_px[0] += 3.0;
  known_.settings.optics.principal_point_px[1] -= 2.0;
  static_cast<void>(row());
  EXPECT_NEAR(keypoints_[0].error_x_px.value(), x - 3.0, 1e-9);
  EXPECT_NEAR(keypoints_[0].error_y_px.value(), y + 2.0, 1e-9);
}

TEST_F(PoseTruth, AKeypointBehindTheCameraHasNoError) {
  pose_.keypoint_fate[0] = 2;
  truth_.spacecraft[1].orbit.position_eci = kPlace + Vector3(0.0, 0.0, -5.0);
  EXPECT_NEAR(row().range_m.value(), 5.5, 1e-9);
  EXPECT_FALSE(keypoints_[0].error_x_px.has_value());
}

TEST_F(PoseTruth, NeesIsOfImagesThatTheFilterUsed) {
  const auto elements = [](const fsw::orbit::CartesianState& state) {
    return fsw::orbit::qns_from_cartesian(state).value();
  };
  const fsw::Vector6 roe =
      elements(truth_.spacecraft[0].orbit).a *
      fsw::orbit::roe_from_qns(elements(truth_.spacecraft[0].orbit), elements(truth_.spacecraft[1].orbit));
  for (int k = 0, place = 0; k < 6; place += ++k + 1) {
    const double sigma = 1.0 + k;
    pose_.covariance_a_roe[place] = sigma * sigma;
    pose_.a_roe_osculating_m[k] = roe(k) + (k % 2 == 0 ? sigma : -sigma);
  }
  EXPECT_FALSE(row().nees.has_value());
  pose_.fate = 2;
  EXPECT_NEAR(row().nees.value(), 6.0, 1e-9);  // each of six independent components off by its sigma
  pose_.images_used = 0;
  EXPECT_FALSE(row().nees.has_value()) << "what was known beforehand is not the filter's";
  EXPECT_FALSE(row().attitude_error_deg.has_value());
}

// From above the North Pole to the Sun: nothing stands between; from the night side at 629 km the Earth does.
TEST_F(PoseTruth, SunlightIsThatOfTheTargetsPlace) {
  const Vector3 to_sun = Vector3(-0.43, 0.83, 0.36).normalized();  // on 18 July
  mission_.epoch = truth_.time = fsw::GpsTime{995'000'000'000'000'000};
  truth_.spacecraft[1].orbit.position_eci = 7.0e6 * to_sun;
  EXPECT_EQ(row().sunlit.value(), 1.0);
  truth_.spacecraft[1].orbit.position_eci = -7.0e6 * to_sun;
  EXPECT_EQ(row().sunlit.value(), 0.0);
}

bool has_no_truth(const PoseRow& row) {
  return !row.range_m && !row.sunlit && !row.pnp_error_x_m && !row.pnp_error_deg && !row.attitude_error_deg &&
         !row.attitude_error_x_deg && !row.rate_error_radps && !row.nees && !row.attitude_nees;
}

TEST_F(PoseTruth, WithoutTheTruthThereAreNoErrors) {
  const twins::TruthSnapshot whole = truth_;
  truth_.spacecraft[0].attitude.reset();
  EXPECT_TRUE(has_no_truth(row())) << "the servicer's attitude";
  truth_ = whole;
  truth_.spacecraft[1].attitude.reset();
  EXPECT_TRUE(has_no_truth(row())) << "the target's attitude";
  truth_ = whole;
  truth_.spacecraft.pop_back();
  EXPECT_TRUE(has_no_truth(row())) << "the target";
  truth_ = whole;
  remove_camera(mission_.spacecraft[0]);
  EXPECT_TRUE(has_no_truth(row())) << "the camera";
  for (const KeypointRow& keypoint : keypoints_) EXPECT_FALSE(keypoint.error_x_px.has_value());
}

TEST_F(PoseTruth, ANanOfTheTruthIsNotAnErrorOfZero) {
  truth_.spacecraft[1].orbit.position_eci.x() = kNan;
  pose_.keypoint_fate[0] = 2;
  const PoseRow of_place = row();
  EXPECT_TRUE(std::isnan(of_place.range_m.value()));
  EXPECT_TRUE(std::isnan(of_place.pnp_error_x_m.value()));
  EXPECT_FALSE(keypoints_[0].error_x_px.has_value());

  SetUp();
  truth_.spacecraft[1].attitude->q_body_eci.x() = kNan;
  truth_.spacecraft[1].attitude->rate_body.x() = kNan;
  const PoseRow of_attitude = row();
  EXPECT_TRUE(std::isnan(of_attitude.pnp_error_deg.value()));
  EXPECT_TRUE(std::isnan(of_attitude.attitude_error_deg.value()));
  EXPECT_TRUE(std::isnan(of_attitude.attitude_nees.value()));
}

PoseRow image(double step_time_s, double pnp_error_deg, double sunlit) {
  PoseRow row;
  row.step_time_s = step_time_s;
  row.pnp_inliers = 7;
  row.pnp_error_deg = pnp_error_deg;
  row.sunlit = sunlit;
  row.fate = 2;
  return row;
}

KeypointRow keypoint(double error_x_px, double error_y_px, double variance_px2) {
  KeypointRow row;
  row.covariance_xx_px2 = row.covariance_yy_px2 = static_cast<float>(variance_px2);
  row.error_x_px = error_x_px;
  row.error_y_px = error_y_px;
  return row;
}

TEST(PoseSummary, CountsAndAveragesOverTheRun) {
  report::RunRecord record;
  record.extensions = extensions();
  record.tables.rows<PoseRow>() = {image(10.0, 2.0, 1.0), image(20.0, 11.0, 0.5), image(30.0, 170.0, 0.0), {}};
  record.tables.rows<PoseRow>()[3].step_time_s = 40.0;
  record.tables.rows<PoseRow>()[0].attitude_error_deg = 1.0;
  record.tables.rows<PoseRow>()[1].attitude_error_deg = 3.0;
  record.tables.rows<PoseRow>()[0].nees = 5.0;
  record.tables.rows<PoseRow>()[1].nees = 8.0;
  record.tables.rows<PoseRow>()[0].attitude_nees = 4.0;
  record.tables.rows<PoseRow>()[1].attitude_nees = 40.0;
  record.tables.rows<PoseRow>()[1].fate = 3;  // by position alone: the attitude's is not the filter's own
  record.tables.rows<PoseRow>()[3].attitude_restarts = 2;
  record.tables.rows<PoseRow>()[3].restarts = 1;
  record.tables.rows<KeypointRow>() = {keypoint(3.0, 4.0, 25.0), keypoint(0.6, 0.8, 0.5), keypoint(6.0, 8.0, 1.0), {}};
  for (const double time_s : {10.0, 20.0, 30.0, 40.0}) {
    report::EstimateRow estimate;
    estimate.time_s = time_s;
    estimate.navigation_valid = 1;
    estimate.relative_position_rtn = {0.1 * time_s, 0.0, 0.0};
    record.estimates.push_back(estimate);
    record.truth.push_back({});
    record.truth.back().time_s = time_s;
  }
  const report::Summary summary = report::summarise(record);
  const auto& figures = summary.sensor_figures.at("pose");
  EXPECT_EQ(figures.at("images"), 4);
  EXPECT_EQ(figures.at("with_pose"), 3);
  EXPECT_EQ(figures.at("poses_over_10_deg"), 2);
  EXPECT_NEAR(figures.at("keypoint_error_px"), 5.0, 1e-12);    // of 1, 5 and 10
  EXPECT_NEAR(figures.at("keypoint_chi_square"), 2.0, 1e-12);  // of 1, 2 and 100
  EXPECT_NEAR(figures.at("lit_navigation_error_mean_m"), 1.5, 1e-12) << "1 m and 2 m; the third image is in eclipse";
  EXPECT_NEAR(figures.at("attitude_nees"), 4.0, 1e-12);
  EXPECT_EQ(figures.at("attitude_restarts"), 2);
  EXPECT_EQ(figures.at("restarts"), 1);
  EXPECT_NEAR(summary.attitude_error_deg.value().mean, 2.0, 1e-12);
  EXPECT_NEAR(summary.navigation_nees.value(), 6.5, 1e-12);
}

TEST(PoseSummary, WithoutImagesIsNone) {
  const report::Summary summary = report::summarise({});
  EXPECT_TRUE(summary.sensor_figures.empty());
  EXPECT_FALSE(summary.navigation_nees.has_value());
}

TEST(PoseSummary, ANanIsSeen) {
  report::RunRecord record;
  record.extensions = extensions();
  record.tables.rows<PoseRow>() = {image(10.0, kNan, 1.0)};
  record.tables.rows<PoseRow>()[0].nees = record.tables.rows<PoseRow>()[0].attitude_nees =
      record.tables.rows<PoseRow>()[0].attitude_error_deg = kNan;
  record.tables.rows<KeypointRow>() = {keypoint(1.0, 0.0, 1.0), keypoint(kNan, 0.0, 1.0), keypoint(2.0, 0.0, 1.0)};
  const report::Summary summary = report::summarise(record);
  const auto& figures = summary.sensor_figures.at("pose");
  EXPECT_EQ(figures.at("poses_over_10_deg"), 1);
  EXPECT_TRUE(std::isnan(figures.at("keypoint_error_px")));
  EXPECT_TRUE(std::isnan(figures.at("keypoint_chi_square")));
  EXPECT_TRUE(std::isnan(figures.at("attitude_nees")));
  EXPECT_TRUE(std::isnan(summary.navigation_nees.value()));
  EXPECT_TRUE(std::isnan(summary.attitude_error_deg.value().mean));
}

}  // namespace
}  // namespace vbar::sensors
