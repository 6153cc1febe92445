#include <cerrno>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/tron/calibration_file/calibration.h"
#include "host_sim/files/write_error.h"

namespace vbar::tron {
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
