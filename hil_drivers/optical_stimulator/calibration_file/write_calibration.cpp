#include <cerrno>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "host_sim/files/write_error.h"

namespace vbar::optical_stimulator {
namespace {

template <typename Numbers>
std::string array_of(const Numbers& numbers) {
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
  template <typename Number>
  void key(std::string_view name, const Number& value) {
    text_ += fmt::format("{} = {}\n", name, value);
  }
  void figure(std::string_view name, const Figure& figure) {
    key(name, figure.value);
    key(fmt::format("{}_sigma", name), figure.sigma);
  }
  void lens(const LensTerms& lens) {
    key("centre_px", array_of(lens.centre_px));
    key("scale_px", lens.scale_px);
    key("rotation_rad", lens.rotation_rad);
    key("tilt_rad", array_of(lens.tilt_rad));
    key("distortion", array_of(lens.distortion));
  }
  void residuals(std::string_view name, const ResidualFigures& figures) {
    section(name);
    key("mean_arcsec", figures.mean_arcsec);
    key("p95_arcsec", figures.p95_arcsec);
    key("dots", figures.dots);
  }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_ = "# Calibration of the Optical Stimulator, written by vbar_os_calibrate.\n";
};

void write(Document& out, const Validity& validity) {
  out.section("validity");
  out.key("date_utc", toml_string(validity.date_utc));
  out.key("emulated", validity.emulated);
  out.key("camera_vendor", toml_string(validity.camera_vendor));
  out.key("camera_model", toml_string(validity.camera_model));
  out.key("camera_serial", toml_string(validity.camera_serial));
  out.key("rail_lens_mm", validity.rail_lens_mm);
  out.key("rail_display_mm", validity.rail_display_mm);
  out.key("display_px", array_of(std::array{validity.display_width_px, validity.display_height_px}));
  out.key("display_rate_hz", validity.display_rate_hz);
  const auto& region = validity.region;
  out.key("region_px", array_of(std::array{region.x, region.y, region.width, region.height}));
  out.key("exposure_s", validity.exposure_s);
}

void write(Document& out, const ChebyshevField& field, double sigma_px) {
  out.section("geometry.field");
  out.key("degree", field.degree);
  out.key("low_px", array_of(field.low_px));
  out.key("high_px", array_of(field.high_px));
  out.key("x_px", array_of(field.x_px));
  out.key("y_px", array_of(field.y_px));
  out.key("sigma_px", sigma_px);
}

void write(Document& out, const CountsToLight& light) {
  out.section("light");
  out.figure("full_pixel_electrons_per_s", light.full_pixel_electrons_per_s);
  out.figure("black_pixel_electrons_per_s", light.black_pixel_electrons_per_s);
  out.figure("gamma", light.gamma);
  out.figure("first_count", light.first_count);
  out.key("residual", light.residual);
}

void write(Document& out, const UniformityGrid& grid) {
  out.section("uniformity");
  out.key("columns", grid.columns);
  out.key("rows", grid.rows);
  out.key("first_px", array_of(grid.first_px));
  out.key("step_px", array_of(grid.step_px));
  out.key("values", array_of(grid.values));
  out.key("sigma", grid.sigma);
}

void write(Document& out, const CameraFigures& camera) {
  out.section("camera");
  out.figure("offset_dn", camera.offset_dn);
  out.figure("gain_dn_per_electron", camera.gain_dn_per_electron);
  out.figure("read_noise_electrons", camera.read_noise_electrons);
  out.figure("background_electrons_per_s", camera.background_electrons_per_s);
  out.figure("point_spread_sigma_px", camera.point_spread_sigma_px);
  out.key("bits", camera.bits);
  for (const HotPixel& hot : camera.hot_pixels) {
    out.key("\n[[camera.hot_pixel]]\nat_px", array_of(std::array{hot.x, hot.y}));
    out.key("electrons_per_s", hot.electrons_per_s);
  }
}

}  // namespace

std::string toml_of(const BenchCalibration& calibration) {
  Document out;
  out.key("centroid_floor_px", calibration.centroid_floor_px);
  write(out, calibration.validity);
  out.section("geometry.lens");
  out.lens(calibration.geometry.lens);
  out.section("geometry.lens_sigma");
  out.lens(calibration.lens_sigma);
  write(out, calibration.geometry.field, calibration.field_sigma_px);
  write(out, calibration.light);
  write(out, calibration.uniformity);
  write(out, calibration.camera);
  const HeldOutResiduals& held_out = calibration.held_out;
  out.section("held_out");
  out.key("goal_reached", held_out.goal_reached);
  out.residuals("held_out.region", held_out.region);
  out.residuals("held_out.detector", held_out.detector);
  out.residuals("held_out.region_lens_terms", held_out.region_lens_terms);
  out.residuals("held_out.detector_lens_terms", held_out.detector_lens_terms);
  return std::move(out).text();
}

void save_calibration(const BenchCalibration& calibration, const std::filesystem::path& file) {
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

}  // namespace vbar::optical_stimulator
