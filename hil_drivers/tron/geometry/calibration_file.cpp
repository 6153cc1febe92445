#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <string>
#include <string_view>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/tron/geometry/calibration.h"
#include "host_sim/files/output_file.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::tron {

namespace {

using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr Range kLength_m = from_to(-100.0, 100.0);
constexpr Range kSmallAngle_rad = from_to(-0.5, 0.5);
constexpr Range kFigure = from_to(0.0, 1e9);

template <std::size_t N>
std::array<double, N> read_array(const TableReader& section, std::string_view key, Range range) {
  std::array<double, N> values{};
  std::ranges::copy(section.numbers(key, N, N, range), values.begin());
  return values;
}

PoseFigures read_pose(const TableReader& section, std::string_view key) {
  if (!section.has(key)) section.refuse(key, "nothing", "rotation_rad and translation_m");
  const TableReader inner = section.table(key);
  PoseFigures pose;
  pose.rotation_rad = inner.three_numbers("rotation_rad", from_to(-7.0, 7.0));
  pose.translation_m = inner.three_numbers("translation_m", kLength_m);
  return pose;
}

bool required_flag(const TableReader& section, std::string_view key) {
  if (!section.has(key)) section.refuse(key, "nothing", "true or false");
  return section.flag(key, false);
}

/// A seed may be beyond TOML's integers: it is written as text.
std::uint64_t read_seed(const TableReader& section) {
  const std::string text = section.text("seed");
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size())
    section.refuse_value("seed", "a whole number from 0 to 2^64 - 1 in quotes");
  return seed;
}

CalibrationValidity read_validity(const TableReader& section) {
  CalibrationValidity validity;
  validity.date_utc = section.text("date_utc");
  validity.bench = section.name("bench");
  validity.emulated = required_flag(section, "emulated");
  validity.seed = read_seed(section);
  validity.camera_model = section.text("camera_model");
  validity.camera_serial = section.text("camera_serial");
  validity.data_sha256 = section.text("data_sha256");
  return validity;
}

LensCalibration read_lens(const TableReader& section) {
  LensCalibration lens;
  const auto size = read_array<2>(section, "size_px", from_to(16.0, 65535.0));
  if (size[0] != std::floor(size[0]) || size[1] != std::floor(size[1])) section.refuse_value("size_px", "integers");
  lens.width_px = static_cast<int>(size[0]);
  lens.height_px = static_cast<int>(size[1]);
  const auto focal = read_array<2>(section, "focal_length_px", above_to(0.0, 1e7));
  lens.fx_px = focal[0];
  lens.fy_px = focal[1];
  const auto centre = read_array<2>(section, "principal_point_px", from_to(-1e6, 1e6));
  lens.cx_px = centre[0];
  lens.cy_px = centre[1];
  lens.distortion = read_array<5>(section, "distortion", from_to(-1e6, 1e6));
  return lens;
}

ArmCalibration read_arm(const TableReader& section) {
  ArmCalibration arm;
  const auto lengths = read_array<6>(section, "lengths_m", from_to(0.0, 10.0));
  arm.lengths = {lengths[0], lengths[1], lengths[2], lengths[3], lengths[4], lengths[5]};
  arm.base = read_pose(section, "base");
  arm.offset_rad = read_array<kJoints>(section, "offset_rad", kSmallAngle_rad);
  for (std::size_t k = 0; k < arm.link.size(); ++k)
    arm.link[k] = read_array<6>(section, fmt::format("after_a{}", k + 1), kSmallAngle_rad);
  arm.flex_rad_m = read_array<kFlexes>(section, "flex_rad_m", kSmallAngle_rad);
  arm.mount = read_pose(section, "mount");
  return arm;
}

TrackCalibration read_track(const TableReader& section) {
  TrackCalibration track;
  track.grid.first_m = section.number("first_m", kLength_m);
  track.grid.step_m = section.number("step_m", from_to(1e-3, 100.0));
  track.grid.middle_m = section.number("middle_m", kLength_m);
  track.grid.plate_m = section.number("plate_m", kLength_m);
  track.scale = section.number("scale", from_to(-0.1, 0.1));
  const std::array<std::string_view, kTrackErrors> names{"roll_rad", "pitch_rad", "yaw_rad", "sideways_m", "height_m"};
  for (std::size_t e = 0; e < names.size(); ++e) {
    const std::size_t count = track.knots.size();
    const auto values = section.numbers(names[e], e == 0 ? 4 : count, e == 0 ? 1000 : count, kSmallAngle_rad);
    if (e == 0) track.knots.resize(values.size());
    for (std::size_t k = 0; k < track.knots.size(); ++k) track.knots[k][e] = values[k];
  }
  return track;
}

ViconCalibration read_vicon(const TableReader& section) {
  ViconCalibration vicon;
  if (!section.has("rotation")) section.refuse("rotation", "nothing", "an order of axes");
  vicon.rotation = section.choice("rotation", {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}, vicon.rotation);
  vicon.T_C_object = read_pose(section, "camera_from_object");
  vicon.T_object_T = read_pose(section, "object_from_target");
  vicon.T_V_L = read_pose(section, "vicon_from_laboratory");
  return vicon;
}

Matrix6 read_covariance(const TableReader& section, std::string_view key) {
  const auto numbers = section.numbers(key, 36, 36, from_to(-10.0, 10.0));
  const Matrix6 matrix = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
  const double size = matrix.cwiseAbs().maxCoeff();
  const bool is_symmetric = (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * size;
  if (!is_symmetric || Eigen::LLT<Matrix6>(matrix).info() != Eigen::Success)
    section.refuse(key, "another matrix", "a symmetric positive definite matrix, row by row");
  return matrix;
}

CameraCalibration read_camera(const TableReader& section) {
  CameraCalibration camera;
  camera.bits = static_cast<int>(section.integer("bits", 8, 16));
  camera.offset_dn = section.number("offset_dn", from_to(0.0, 65535.0));
  camera.read_noise_dn = section.number("read_noise_dn", from_to(0.0, 65535.0));
  camera.lamp_dn_per_s = section.number("lamp_dn_per_s", from_to(0.0, 1e12));
  return camera;
}

LightTable read_light(const TableReader& section) {
  LightTable table;
  table.source = section.text("source");
  table.level = section.numbers("level", 2, 1000, from_to(0.0, 1.0));
  table.light = section.numbers("light", table.level.size(), table.level.size(), from_to(-1.0, 10.0));
  for (std::size_t k = 1; k < table.level.size(); ++k)
    if (!(table.level[k] > table.level[k - 1])) section.refuse_value("level", "levels that increase");
  return table;
}

ErrorFigures read_errors(const TableReader& section, const std::string& against) {
  const auto translation = read_array<3>(section, against + "_translation_mm", kFigure);
  const auto rotation = read_array<3>(section, against + "_rotation_deg", kFigure);
  const auto pixel = read_array<3>(section, against + "_pixel_px", kFigure);
  return {translation[0], translation[1], translation[2], rotation[0], rotation[1],
          rotation[2],    pixel[0],       pixel[1],       pixel[2]};
}

StageFigures read_stage(const TableReader& section) {
  StageFigures stage;
  stage.stage = section.text("stage");
  stage.poses = static_cast<int>(section.integer("poses", 0, 1'000'000));
  stage.board = read_errors(section, "board");
  if (required_flag(section, "is_truth_known")) stage.truth = read_errors(section, "truth");
  return stage;
}

void check_count(const TableReader& document, std::string_view key, std::string_view tables, std::size_t count) {
  const auto stated = static_cast<std::size_t>(document.integer(key, 0, 1000));
  if (stated != count)
    document.refuse(tables, fmt::format("{} tables", count), fmt::format("{}, as {} states", stated, key));
}

Calibration read_calibration(const TableReader& document) {
  Calibration calibration;
  calibration.validity = read_validity(document.table("validity"));
  calibration.lens = read_lens(document.table("lens"));
  calibration.camera_arm = read_arm(document.table("camera_arm"));
  calibration.target_arm = read_arm(document.table("target_arm"));
  calibration.track = read_track(document.table("track"));
  calibration.vicon = read_vicon(document.table("vicon"));
  const TableReader covariance = document.table("covariance");
  calibration.covariance.arms = read_covariance(covariance, "arms");
  calibration.covariance.vicon = read_covariance(covariance, "vicon");
  calibration.camera = read_camera(document.table("camera"));
  for (const TableReader& light : document.tables("light")) calibration.lights.push_back(read_light(light));
  for (const TableReader& stage : document.tables("figures")) calibration.figures.push_back(read_stage(stage));
  check_count(document, "light_tables", "light", calibration.lights.size());
  check_count(document, "stages", "figures", calibration.figures.size());
  document.finish();
  return calibration;
}

}  // namespace

Calibration parse_calibration(std::string_view text, const std::string& file) {
  const toml::table table = mission::parse_toml(text, file);
  return read_calibration(TableReader(table, file));
}

Calibration load_calibration(const std::filesystem::path& file) {
  return parse_calibration(
      mission::read_data_text(file, "a calibration of a robotic bench (TOML), as vbar_tron calibrate writes it"),
      file.string());
}

namespace {

/// TOML reads the shortest form of -0.0 as the integer 0.
template <typename Number>
Number without_negative_zero(Number number) {
  return number == Number{} ? Number{} : number;
}

template <typename Numbers>
std::string array_of(Numbers numbers) {
  for (auto& number : numbers) number = without_negative_zero(number);
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) result += c;
  }
  return result + '"';
}

class Document {
 public:
  void section(std::string_view name) { text_ += fmt::format("\n[{}]\n", name); }
  void element(std::string_view name) { text_ += fmt::format("\n[[{}]]\n", name); }
  template <typename Value>
  void key(std::string_view name, const Value& value) {
    text_ += fmt::format("{} = {}\n", name, value);
  }
  void key(std::string_view name, double value) {
    text_ += fmt::format("{} = {}\n", name, without_negative_zero(value));
  }
  void pose(std::string_view name, const PoseFigures& pose) {
    text_ += fmt::format("{} = {{ rotation_rad = {}, translation_m = {} }}\n", name, array_of(pose.rotation_rad),
                         array_of(pose.translation_m));
  }
  void matrix(std::string_view name, const Matrix6& matrix) {
    text_ += fmt::format("{} = [\n", name);
    for (int row = 0; row < 6; ++row) {
      std::array<double, 6> numbers{};
      for (std::size_t k = 0; k < 6; ++k) numbers[k] = without_negative_zero(matrix(row, static_cast<Eigen::Index>(k)));
      text_ += fmt::format("  {},\n", fmt::join(numbers, ", "));
    }
    text_ += "]\n";
  }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_ = "# Calibration of the robotic bench TRON, written by vbar_tron calibrate.\n";
};

void write(Document& out, const CalibrationValidity& validity) {
  out.section("validity");
  out.key("date_utc", toml_string(validity.date_utc));
  out.key("bench", toml_string(validity.bench));
  out.key("emulated", validity.emulated);
  out.key("seed", toml_string(fmt::format("{}", validity.seed)));
  out.key("camera_model", toml_string(validity.camera_model));
  out.key("camera_serial", toml_string(validity.camera_serial));
  out.key("data_sha256", toml_string(validity.data_sha256));
}

void write(Document& out, const LensCalibration& lens) {
  out.section("lens");
  out.key("size_px", array_of(std::array{lens.width_px, lens.height_px}));
  out.key("focal_length_px", array_of(std::array{lens.fx_px, lens.fy_px}));
  out.key("principal_point_px", array_of(std::array{lens.cx_px, lens.cy_px}));
  out.key("distortion", array_of(lens.distortion));
}

void write(Document& out, std::string_view name, const ArmCalibration& arm) {
  out.section(name);
  const ArmLengths& a = arm.lengths;
  out.key("lengths_m", array_of(std::array{a.d1_m, a.a1_m, a.a2_m, a.a3_m, a.d4_m, a.d6_m}));
  out.pose("base", arm.base);
  out.key("offset_rad", array_of(arm.offset_rad));
  for (std::size_t k = 0; k < arm.link.size(); ++k) out.key(fmt::format("after_a{}", k + 1), array_of(arm.link[k]));
  out.key("flex_rad_m", array_of(arm.flex_rad_m));
  out.pose("mount", arm.mount);
}

void write(Document& out, const TrackCalibration& track) {
  out.section("track");
  out.key("first_m", track.grid.first_m);
  out.key("step_m", track.grid.step_m);
  out.key("middle_m", track.grid.middle_m);
  out.key("plate_m", track.grid.plate_m);
  out.key("scale", track.scale);
  const std::array<std::string_view, kTrackErrors> names{"roll_rad", "pitch_rad", "yaw_rad", "sideways_m", "height_m"};
  for (std::size_t e = 0; e < names.size(); ++e) {
    std::vector<double> values;
    for (const auto& knot : track.knots) values.push_back(knot[e]);
    out.key(names[e], array_of(values));
  }
}

void write(Document& out, const ViconCalibration& vicon) {
  out.section("vicon");
  out.key("rotation", toml_string(vicon.rotation));
  out.pose("camera_from_object", vicon.T_C_object);
  out.pose("object_from_target", vicon.T_object_T);
  out.pose("vicon_from_laboratory", vicon.T_V_L);
}

void write(Document& out, const ErrorFigures& figures, std::string_view against) {
  const auto row = [&](std::string_view name, double mean, double sigma, double median) {
    out.key(fmt::format("{}_{}", against, name), array_of(std::array{mean, sigma, median}));
  };
  row("translation_mm", figures.translation_mean_mm, figures.translation_sigma_mm, figures.translation_median_mm);
  row("rotation_deg", figures.rotation_mean_deg, figures.rotation_sigma_deg, figures.rotation_median_deg);
  row("pixel_px", figures.pixel_mean_px, figures.pixel_sigma_px, figures.pixel_median_px);
}

void write(Document& out, const Calibration& calibration) {
  for (const LightTable& light : calibration.lights) {
    out.element("light");
    out.key("source", toml_string(light.source));
    out.key("level", array_of(light.level));
    out.key("light", array_of(light.light));
  }
  for (const StageFigures& stage : calibration.figures) {
    out.element("figures");
    out.key("stage", toml_string(stage.stage));
    out.key("poses", stage.poses);
    out.key("is_truth_known", stage.truth.has_value());
    write(out, stage.board, "board");
    if (stage.truth) write(out, *stage.truth, "truth");
  }
}

}  // namespace

std::string toml_of(const Calibration& calibration) {
  Document out;
  // Counts first: a file that was cut off between two tables is seen.
  out.key("light_tables", calibration.lights.size());
  out.key("stages", calibration.figures.size());
  write(out, calibration.validity);
  write(out, calibration.lens);
  write(out, "camera_arm", calibration.camera_arm);
  write(out, "target_arm", calibration.target_arm);
  write(out, calibration.track);
  write(out, calibration.vicon);
  out.section("covariance");
  out.matrix("arms", calibration.covariance.arms);
  out.matrix("vicon", calibration.covariance.vicon);
  out.section("camera");
  out.key("bits", calibration.camera.bits);
  out.key("offset_dn", calibration.camera.offset_dn);
  out.key("read_noise_dn", calibration.camera.read_noise_dn);
  out.key("lamp_dn_per_s", calibration.camera.lamp_dn_per_s);
  write(out, calibration);
  return std::move(out).text();
}

void save_calibration(const Calibration& calibration, const std::filesystem::path& file) {
  const std::filesystem::path partial = file.string() + ".partial";
  errno = 0;
  {
    std::ofstream out(partial, std::ios::binary);
    out << toml_of(calibration);
    out.flush();
    if (!out) throw files::write_error(file);
  }
  std::filesystem::rename(partial, file);
}

}  // namespace vbar::tron
