// Telemetry of an image against a truth that can be worked out by hand: camera axes along ECI, target straight ahead.

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/orbit/sun.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/camera/camera_truth.h"
#include "tests/unit/host_sim/sensors/editable_camera.h"

namespace vbar::sensors {

namespace {

using fsw::Vector3;

constexpr double kArcsecond = 3.14159265358979323846 / 648000.0;
constexpr double kPixel = 1.0 / 5972.696;  // rad, of 5.86 um behind 35 mm

constexpr const char* kMission = R"(
[mission]
duration_h = 1.0
[guidance]
mode = "idle"
[[spacecraft]]
name = "servicer"
flight_computer = {}
sensors.gnss = {}
sensors.camera = { position_body_m = [0.0, 0.0, 0.5] }
actuators.thruster = {}
attitude = { profile = "commanded" }
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 90, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
[[spacecraft]]
name = "target"
body = "tango"
model = "tango"
attitude = { profile = "tumble" }
relative = { to = "servicer", a_roe_m = [0, -1e4, 0, 0, 0, 0] }
[[spacecraft]]
name = "decoy"
model = "tango"
relative = { to = "servicer", a_roe_m = [0, -2e4, 0, 0, 0, 0] }
)";

class ImageTruth : public testing::Test {
 protected:
  void SetUp() override {
    truth_.spacecraft = {{"servicer", {kPlace, kVelocity}, truth::AttitudeState{}},
                         {"target", {kPlace + Vector3(0.0, 0.0, 1e4 + 0.5), kVelocity}, std::nullopt},
                         {"decoy", {kPlace + Vector3(30.0, 0.0, 2e4 + 0.5), kVelocity}, std::nullopt}};
    image_.bearing_eci[2] = 1.0;
    image_.q_eci_camera[0] = 1.0;
    image_.star_method = 1;
  }

  [[nodiscard]] ImageRow row(const telemetry_objects* objects = nullptr) const {
    auto row = report::row_of<ImageRow>(image_);
    add_truth(row, image_, objects, *navigation_camera(mission_.spacecraft[0]), mission_.spacecraft[0], truth_);
    return row;
  }

  void point(const Vector3& direction) {
    const Vector3 unit = direction.normalized();
    std::copy(unit.begin(), unit.end(), image_.bearing_eci);
  }

  const Vector3 kPlace{7.0e6, 0.0, 0.0};
  const Vector3 kVelocity{0.0, 100.0, 7546.0};
  mission::Mission mission_ = sensors::parse_mission(kMission, "m.toml");
  twins::TruthSnapshot truth_;
  telemetry_image image_{};
};

TEST_F(ImageTruth, BearingErrorIsInTheCamerasAxes) {
  point({std::tan(20.0 * kArcsecond), std::tan(-7.0 * kArcsecond), 1.0});
  const ImageRow seen = row();
  EXPECT_NEAR(seen.bearing_error_x_arcsec.value(), 20.0, 1e-6);
  EXPECT_NEAR(seen.bearing_error_y_arcsec.value(), -7.0, 1e-6);
  EXPECT_NEAR(seen.range_m.value(), 1e4, 1e-6) << "from the camera, half a metre nearer than the centre of mass";
  EXPECT_EQ(seen.chosen, "target");
}

TEST_F(ImageTruth, AttitudeErrorIsThatOfTheBoresightAndAboutIt) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(5.0 * kArcsecond, Vector3::UnitX()) *
                             Eigen::AngleAxisd(30.0 * kArcsecond, Vector3::UnitZ()));
  const double wxyz[] = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz, wxyz + 4, image_.q_eci_camera);
  EXPECT_NEAR(row().attitude_error_across_arcsec.value(), 5.0, 1e-3);  // the product of both turns, 4e-4 arcsec
  EXPECT_NEAR(row().attitude_error_roll_arcsec.value(), 30.0, 1e-3);
  image_.star_method = 0;
  EXPECT_FALSE(row().attitude_error_across_arcsec.has_value());
}

TEST_F(ImageTruth, ChoicesAreNamed) {
  point({30.0, 0.0, 2e4});  // 309 arcsec beside the target
  EXPECT_EQ(row().chosen, "decoy");
  point({-1.0, 0.0, 100.0});
  EXPECT_EQ(row().chosen, "nothing");
  image_.status = 3;
  EXPECT_EQ(row().chosen, "");
  EXPECT_FALSE(row().bearing_error_x_arcsec.has_value());
}

// Three pixels of the camera that flies, and the spacecraft's own radius: 0.73 m at 10 km are 0.44 px.
TEST_F(ImageTruth, TheSameObjectIsWithinThreePixelsOfThisCamera) {
  truth_.spacecraft.pop_back();
  for (const double focal_length_mm : {35.0, 7.0}) {
    editable_camera(mission_.spacecraft[0]).settings.optics.focal_length_mm = focal_length_mm;
    const double pixel = 5.86e-3 / focal_length_mm;
    const double limit_px = 3.0 + 0.73e-4 / pixel;
    for (const double off_px : {limit_px - 0.05, limit_px + 0.05}) {
      point({std::tan(off_px * pixel), 0.0, 1.0});
      EXPECT_EQ(row().chosen, off_px < limit_px ? "target" : "nothing") << focal_length_mm << ' ' << off_px;
      telemetry_objects objects{};
      objects.count = 1;
      objects.x_px[0] = static_cast<float>(959.5 + off_px);
      objects.y_px[0] = 599.5F;
      EXPECT_EQ(row(&objects).true_object, off_px < limit_px ? 0 : -1) << focal_length_mm << ' ' << off_px;
    }
  }
}

TEST_F(ImageTruth, ACountBeyondTheFieldIsThatOfTheField) {
  telemetry_objects objects{};
  objects.count = 1000;  // invalid
  objects.x_px[95] = 959.5F;
  objects.y_px[95] = 599.5F;
  EXPECT_EQ(row(&objects).true_object, 95);
}

TEST_F(ImageTruth, ANanOfTheTruthIsNotAnErrorOfZero) {
  truth_.spacecraft[1].orbit.position_eci.x() = std::nan("");
  telemetry_objects objects{};
  objects.count = 1;
  const ImageRow seen = row(&objects);
  EXPECT_TRUE(std::isnan(seen.range_m.value()));
  EXPECT_TRUE(std::isnan(seen.bearing_error_x_arcsec.value()));
  EXPECT_EQ(seen.chosen, "nothing");
  EXPECT_EQ(seen.true_object, -1);
}

TEST_F(ImageTruth, FindsTheObjectThatIsTheTarget) {
  telemetry_objects objects{};
  objects.count = 3;
  const float x[] = {700.0F, 959.5F + static_cast<float>(30.0 / 2e4 / kPixel), 960.4F};
  for (int k = 0; k < 3; ++k) {
    objects.x_px[k] = x[k];
    objects.y_px[k] = 599.0F;
  }
  EXPECT_EQ(row(&objects).true_object, 2) << "the second is the decoy, 9 pixels beside it";
  objects.count = 2;
  EXPECT_EQ(row(&objects).true_object, -1);
  EXPECT_EQ(row().true_object, -1);
}

// Each of six independent components off by its sigma.
TEST_F(ImageTruth, NeesOfOneSigmaEachIsSix) {
  const auto elements = [](const fsw::orbit::CartesianState& state) {
    return fsw::orbit::qns_from_cartesian(state).value();
  };
  truth_.spacecraft[1].orbit.position_eci = kPlace + Vector3(10.0, 20.0, 1e4);
  const fsw::Vector6 roe =
      elements(truth_.spacecraft[0].orbit).a *
      fsw::orbit::roe_from_qns(elements(truth_.spacecraft[0].orbit), elements(truth_.spacecraft[1].orbit));
  std::size_t place = 0;
  for (int k = 0; k < 6; ++k) {
    place += static_cast<std::size_t>(k);
    const double sigma = 1.0 + k;
    image_.covariance_a_roe[place++] = sigma * sigma;
    image_.a_roe_osculating_m[k] = roe(k) + (k % 2 == 0 ? sigma : -sigma);
  }
  EXPECT_FALSE(row().nees.has_value()) << "navigation did not use the image";
  image_.fate = 2;
  EXPECT_NEAR(row().nees.value(), 6.0, 1e-9);
  image_.covariance_a_roe[0] = -1.0;
  EXPECT_FALSE(row().nees.has_value());
}

// Towards the Sun and away from it, at an altitude of 600 km.
TEST_F(ImageTruth, SunlightIsThatOfTheTarget) {
  const Vector3 sun = fsw::orbit::sun_position_gcrf(truth_.time).normalized();
  truth_.spacecraft[1].orbit.position_eci = 7e6 * sun;
  EXPECT_EQ(row().sunlit.value(), 1.0);
  truth_.spacecraft[1].orbit.position_eci = -7e6 * sun;
  EXPECT_EQ(row().sunlit.value(), 0.0);
  truth_.spacecraft[0].attitude.reset();
  EXPECT_FALSE(row().sunlit.has_value());
}

TEST_F(ImageTruth, SummaryCountsLitTargetsThatWereNotFound) {
  struct Case {
    int true_object;
    std::optional<double> sunlit;
    std::int8_t status;
  };
  report::RunRecord record;
  record.extensions = extensions();
  record.summary.target = "target";
  for (const Case& c : {Case{3, 1.0, telemetry_image::kStatusBearing}, Case{3, 1.0, telemetry_image::kStatusNoTarget},
                        Case{0, 0.2, telemetry_image::kStatusSearching}, Case{3, 0.0, telemetry_image::kStatusNoTarget},
                        Case{-1, 1.0, telemetry_image::kStatusNoTarget}, Case{3, {}, telemetry_image::kStatusNoTarget},
                        Case{3, std::nan(""), telemetry_image::kStatusNoTarget}}) {
    ImageRow& seen = record.tables.rows<ImageRow>().emplace_back();
    seen.true_object = c.true_object;
    seen.sunlit = c.sunlit;
    seen.status = c.status;
  }
  const report::Summary summary = report::summarise(record);
  EXPECT_EQ(summary.sensor_figures.at("images").at("lit_among_objects"), 3);
  EXPECT_EQ(summary.sensor_figures.at("images").at("lit_not_found"), 2);
}

TEST_F(ImageTruth, WithoutTheTruthThereAreNoErrors) {
  truth_.spacecraft[0].attitude.reset();
  EXPECT_FALSE(row().range_m.has_value());
  EXPECT_FALSE(row().bearing_error_x_arcsec.has_value());
  EXPECT_FALSE(row().attitude_error_across_arcsec.has_value());
  EXPECT_EQ(row().chosen, "");
}

TEST_F(ImageTruth, SummaryTakesTheUnresolvedTargetOnly) {
  std::vector<ImageRow> rows;
  for (const double x_arcsec : {12.0, -8.0, 12.0, -8.0}) {
    point({x_arcsec * kArcsecond, 3.0 * kArcsecond, 1.0});
    rows.push_back(row());
  }
  rows.push_back(rows.back());
  rows.back().range_m = 1000.0;
  rows.back().bearing_error_x_arcsec = 1e3;
  rows.push_back(rows.front());
  rows.back().chosen = "decoy";
  rows.push_back({});
  rows.back().status = 2;
  report::RunRecord record;
  record.extensions = extensions();
  record.summary.target = "target";
  record.tables.rows<ImageRow>() = rows;
  const report::Summary summary = report::summarise(record);
  const auto& figures = summary.sensor_figures.at("images");
  EXPECT_EQ(figures.at("images"), 7);
  EXPECT_EQ(figures.at("with_bearing"), 6);
  EXPECT_EQ(figures.at("wrong_targets"), 1);
  EXPECT_EQ(figures.at("without_truth"), 1);
  EXPECT_NEAR(summary.bearing_error_arcsec->bias, std::hypot(2.0, 3.0), 1e-6);
  EXPECT_NEAR(summary.bearing_error_arcsec->std, 10.0 / std::sqrt(2.0), 1e-6) << "of two axes, one of them still";
  EXPECT_NEAR(summary.bearing_error_arcsec->mean, 0.5 * (std::hypot(12.0, 3.0) + std::hypot(8.0, 3.0)), 1e-6);
  EXPECT_EQ(summary.star_attitude_error_arcsec->mean, 0.0);

  record.tables.rows<ImageRow>().clear();
  EXPECT_FALSE(report::summarise(record).sensor_figures.contains("images"));
}

twins::Packet packet_of(fsw::GpsTime time, const auto& message) {
  fsw::packets::PacketHeader header;
  header.time = time;
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::encode(header, message, packet).value());
  return packet;
}

// Telemetry of an image comes a step after the image; its header says which truth it is about.
TEST_F(ImageTruth, TheEvaluationTakesTheTruthOfTheExposure) {
  report::RunRecord record;
  record.extensions = extensions();
  const std::vector<NamedEvaluation> evaluations = make_evaluations(mission_, mission_.spacecraft[0], record);
  const auto camera = std::ranges::find(evaluations, "servicer/camera", &NamedEvaluation::source);
  ASSERT_NE(camera, evaluations.end());
  Evaluation& evaluation = *camera->evaluation;
  const fsw::GpsTime exposure = mission_.epoch + fsw::duration_of_seconds(60);
  truth_.time = exposure;
  evaluation.on_measured(truth_);
  truth_.time = exposure + fsw::duration_of_seconds(60);
  truth_.spacecraft[1].orbit.position_eci += Vector3(500.0, 0.0, 0.0);
  evaluation.on_measured(truth_);

  image_.image = 7;
  image_.fate = 2;
  image_.prefit[0] = 1e-5;
  image_.nis = 1.5;
  telemetry_objects objects{};
  objects.image = 7;
  objects.count = 1;
  objects.x_px[0] = 959.5F;
  objects.y_px[0] = 599.5F;
  const twins::Packet packets[] = {packet_of(exposure, objects), packet_of(exposure, image_)};
  const fsw::packets::PacketView answer[] = {fsw::packets::parse_packet(packets[0]).value(),
                                             fsw::packets::parse_packet(packets[1]).value()};
  evaluation.on_answer(truth_.time, answer);
  evaluation.finish();
  ASSERT_EQ(record.tables.rows<ImageRow>().size(), 1U);
  EXPECT_EQ(record.tables.rows<ImageRow>()[0].time_s, 60.0);
  EXPECT_EQ(record.tables.rows<ImageRow>()[0].step_time_s, 120.0);
  EXPECT_EQ(record.tables.rows<ImageRow>()[0].true_object, 0);
  EXPECT_NEAR(record.tables.rows<ImageRow>()[0].bearing_error_x_arcsec.value(), 0.0, 1e-9);
  EXPECT_EQ(record.tables.rows<ObjectRow>().size(), 1U);
  EXPECT_EQ(record.residuals.size(), 2U);

  const twins::Packet stranger =
      packet_of(exposure + fsw::duration_of_seconds(1), image_);  // no truth was kept of that
  const fsw::packets::PacketView without_truth[] = {fsw::packets::parse_packet(stranger).value()};
  evaluation.on_answer(truth_.time, without_truth);
  EXPECT_FALSE(record.tables.rows<ImageRow>()[1].range_m.has_value());
}

TEST(ImageRows, ResidualsAndObjectsAreRows) {
  telemetry_image image{};
  image.prefit[0] = 40.0 * kArcsecond;
  image.prefit[1] = 30.0 * kArcsecond;
  image.postfit[0] = -5.0 * kArcsecond;
  std::vector<report::ResidualRow> residuals;
  append_residuals(report::row_of<ImageRow>(image), residuals);
  EXPECT_TRUE(residuals.empty()) << "the filter did not run";
  // An innovation of 50 arcsec with a variance of 20^2 arcsec^2 in all directions.
  image.nis = 6.25;
  append_residuals(report::row_of<ImageRow>(image), residuals);
  ASSERT_EQ(residuals.size(), 2U);
  EXPECT_EQ(residuals[0].sensor, "bearing_in_plane_arcsec");
  EXPECT_NEAR(residuals[0].postfit, -5.0, 1e-12);
  EXPECT_NEAR(residuals[1].prefit, 30.0, 1e-12);
  EXPECT_NEAR(residuals[0].sigma, 20.0, 1e-12);
  EXPECT_NEAR(residuals[1].sigma, 20.0, 1e-12);

  telemetry_objects objects{};
  objects.count = 2;
  objects.kind[1] = 1;
  objects.star[1] = 32349;
  std::vector<ObjectRow> rows;
  append_objects(60.0, objects, rows);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].star, 32349);
  objects.count = 1000;  // what no flight software says
  append_objects(60.0, objects, rows);
  EXPECT_EQ(rows.size(), 98U);
}

}  // namespace

namespace {

twins::TruthSnapshot truth_at(std::int64_t s) {
  twins::TruthSnapshot truth;
  truth.time = fsw::GpsTime{} + fsw::duration_of_seconds(s);
  truth.spacecraft.resize(1);
  truth.spacecraft[0].name = std::to_string(s);
  return truth;
}

TEST(TruthRecorder, IsKeptUntilTakenHoweverManyFollow) {
  TruthRecorder kept;
  for (std::int64_t s = 0; s < 1000; ++s) kept.keep(truth_at(s));
  const auto truth = kept.take(truth_at(0).time);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->spacecraft[0].name, "0");
  EXPECT_EQ(kept.size(), 999U) << "released";
  EXPECT_EQ(kept.without_truth(), 0);
}

TEST(TruthRecorder, TwoCamerasMayExposeAtTheSameTime) {
  TruthRecorder kept;
  kept.keep(truth_at(1));
  kept.keep(truth_at(1));
  EXPECT_TRUE(kept.take(truth_at(1).time));
  EXPECT_TRUE(kept.take(truth_at(1).time));
}

TEST(TruthRecorder, CountsImagesWithout) {
  TruthRecorder kept;
  kept.keep(truth_at(1));
  EXPECT_FALSE(kept.take(truth_at(2).time));
  EXPECT_TRUE(kept.take(truth_at(1).time));
  EXPECT_FALSE(kept.take(truth_at(1).time)) << "told of twice";
  EXPECT_EQ(kept.without_truth(), 2);
}

}  // namespace

}  // namespace vbar::sensors
