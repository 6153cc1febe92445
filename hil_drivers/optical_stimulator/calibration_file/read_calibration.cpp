#include <array>
#include <cmath>
#include <string>

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;
using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr Range kSigma = from_to(0.0, 1e15);
constexpr Range kDisplay_px = from_to(-1e5, 1e5);

template <std::size_t N>
std::array<double, N> read_array(const TableReader& section, std::string_view key, Range range) {
  std::array<double, N> values{};
  std::ranges::copy(section.numbers(key, N, N, range), values.begin());
  return values;
}

template <std::size_t N>
std::array<int, N> read_integers(const TableReader& section, std::string_view key, int low, int high) {
  std::array<int, N> integers{};
  const auto values = read_array<N>(section, key, from_to(low, high));
  for (std::size_t k = 0; k < N; ++k) {
    if (values[k] != std::floor(values[k])) section.refuse_value(key, "integers");
    integers[k] = static_cast<int>(values[k]);
  }
  return integers;
}

Vector2 read_point(const TableReader& section, std::string_view key, Range range) {
  const auto values = read_array<2>(section, key, range);
  return {values[0], values[1]};
}

Figure read_figure(const TableReader& section, const std::string& key, Range range) {
  return {section.number(key, range), section.number(key + "_sigma", kSigma)};
}

Validity read_validity(const TableReader& section) {
  Validity validity;
  validity.date_utc = section.text("date_utc");
  if (!section.has("emulated")) section.refuse("emulated", "nothing", "true or false");
  validity.emulated = section.flag("emulated", true);
  validity.camera_vendor = section.text("camera_vendor");
  validity.camera_model = section.text("camera_model");
  validity.camera_serial = section.text("camera_serial");
  validity.rail_lens_mm = section.number("rail_lens_mm", from_to(-1e4, 1e4));
  validity.rail_display_mm = section.number("rail_display_mm", from_to(-1e4, 1e4));
  const auto display_px = read_integers<2>(section, "display_px", 16, 16384);
  validity.display_width_px = display_px[0];
  validity.display_height_px = display_px[1];
  validity.display_rate_hz = section.number("display_rate_hz", above_to(0.0, 1000.0));
  const auto region = read_integers<4>(section, "region_px", 0, 65535);
  if (region[2] == 0 || region[3] == 0) section.refuse_value("region_px", "x, y, width and height above 0");
  validity.region = {region[0], region[1], region[2], region[3]};
  validity.exposure_s = section.number("exposure_s", above_to(0.0, 60.0));
  return validity;
}

LensTerms read_lens(const TableReader& section, bool is_sigma) {
  LensTerms lens;
  lens.centre_px = read_array<2>(section, "centre_px", kDisplay_px);
  lens.scale_px = section.number("scale_px", is_sigma ? kSigma : from_to(100.0, 1e6));
  lens.rotation_rad = section.number("rotation_rad", from_to(-7.0, 7.0));
  lens.tilt_rad = read_array<2>(section, "tilt_rad", from_to(-1.0, 1.0));
  lens.distortion = read_array<5>(section, "distortion", from_to(-1e6, 1e6));
  return lens;
}

ChebyshevField read_field(const TableReader& section) {
  ChebyshevField field;
  field.degree = static_cast<int>(section.integer("degree", -1, ChebyshevField::kDegreeMax));
  field.low_px = read_point(section, "low_px", kDisplay_px);
  field.high_px = read_point(section, "high_px", kDisplay_px);
  const Vector2 extent = field.high_px - field.low_px;
  if (!(extent.x() > 0.0 && extent.y() > 0.0)) section.refuse_value("high_px", "a point right of and below low_px");
  const std::size_t count = ChebyshevField::term_count(field.degree);
  field.x_px = section.numbers("x_px", count, count, kDisplay_px);
  field.y_px = section.numbers("y_px", count, count, kDisplay_px);
  return field;
}

/// Terms that fold the display, as those of a damaged file may, have no inverse.
void check_inverse(const TableReader& geometry, const DisplayMapParameters& parameters) {
  const DisplayMap map(parameters);
  for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0})
    for (const double y : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const Vector2 pixel(x * (parameters.width_px - 1), y * (parameters.height_px - 1));
      const auto back = map.project(map.direction_of(pixel));
      if (!back || !((*back - pixel).norm() < 1e-6))
        geometry.refuse("lens", "terms that do not map directions onto the whole display one to one",
                        "the terms of a calibration");
    }
}

CountsToLight read_light(const TableReader& section) {
  CountsToLight light;
  light.full_pixel_electrons_per_s = read_figure(section, "full_pixel_electrons_per_s", above_to(0.0, 1e15));
  light.black_pixel_electrons_per_s = read_figure(section, "black_pixel_electrons_per_s", from_to(-1e15, 1e15));
  light.gamma = read_figure(section, "gamma", from_to(0.2, 5.0));
  light.first_count = read_figure(section, "first_count", from_to(-64.0, 128.0));
  light.residual = section.number("residual", kSigma);
  return light;
}

UniformityGrid read_uniformity(const TableReader& section) {
  UniformityGrid grid;
  grid.columns = static_cast<int>(section.integer("columns", 1, 4096));
  grid.rows = static_cast<int>(section.integer("rows", 1, 4096));
  grid.first_px = read_point(section, "first_px", kDisplay_px);
  grid.step_px = read_point(section, "step_px", above_to(0.0, 1e5));
  const std::size_t count = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  grid.values = section.numbers("values", count, count, above_to(0.0, 100.0));
  grid.sigma = section.number("sigma", kSigma);
  return grid;
}

CameraFigures read_camera(const TableReader& section) {
  CameraFigures camera;
  camera.offset_dn = read_figure(section, "offset_dn", from_to(0.0, 65535.0));
  camera.gain_dn_per_electron = read_figure(section, "gain_dn_per_electron", above_to(0.0, 1000.0));
  camera.read_noise_electrons = read_figure(section, "read_noise_electrons", from_to(0.0, 1e5));
  camera.background_electrons_per_s = read_figure(section, "background_electrons_per_s", from_to(-1e9, 1e9));
  camera.point_spread_sigma_px = read_figure(section, "point_spread_sigma_px", above_to(0.0, 100.0));
  camera.bits = static_cast<int>(section.integer("bits", 8, 16));
  for (const TableReader& hot : section.tables("hot_pixel")) {
    const auto at = read_integers<2>(hot, "at_px", 0, 65535);
    camera.hot_pixels.push_back({at[0], at[1], hot.number("electrons_per_s", from_to(-1e12, 1e12))});
  }
  return camera;
}

ResidualFigures read_residuals(const TableReader& section) {
  return {section.number("mean_arcsec", kSigma), section.number("p95_arcsec", kSigma),
          static_cast<int>(section.integer("dots", 0, 1'000'000))};
}

HeldOutResiduals read_held_out(const TableReader& section) {
  HeldOutResiduals held_out;
  if (!section.has("goal_reached")) section.refuse("goal_reached", "nothing", "true or false");
  held_out.goal_reached = section.flag("goal_reached", false);
  held_out.region = read_residuals(section.table("region"));
  held_out.detector = read_residuals(section.table("detector"));
  held_out.region_lens_terms = read_residuals(section.table("region_lens_terms"));
  held_out.detector_lens_terms = read_residuals(section.table("detector_lens_terms"));
  return held_out;
}

BenchCalibration read_calibration(const TableReader& document) {
  BenchCalibration calibration;
  calibration.validity = read_validity(document.table("validity"));
  calibration.geometry.width_px = calibration.validity.display_width_px;
  calibration.geometry.height_px = calibration.validity.display_height_px;
  const TableReader geometry = document.table("geometry");
  calibration.geometry.lens = read_lens(geometry.table("lens"), false);
  calibration.lens_sigma = read_lens(geometry.table("lens_sigma"), true);
  const TableReader field = geometry.table("field");
  calibration.geometry.field = read_field(field);
  calibration.field_sigma_px = field.number("sigma_px", kSigma);
  check_inverse(geometry, calibration.geometry);
  calibration.light = read_light(document.table("light"));
  calibration.uniformity = read_uniformity(document.table("uniformity"));
  calibration.camera = read_camera(document.table("camera"));
  calibration.held_out = read_held_out(document.table("held_out"));
  calibration.centroid_floor_px = document.number("centroid_floor_px", from_to(0.0, 100.0));
  document.finish();
  return calibration;
}

}  // namespace

BenchCalibration parse_calibration(std::string_view text, const std::string& file) {
  const toml::table table = mission::parse_toml(text, file);
  return read_calibration(TableReader(table, file));
}

BenchCalibration load_calibration(const std::filesystem::path& file) {
  return parse_calibration(
      mission::read_data_text(file, "a calibration of the Optical Stimulator (TOML), as vbar_os_calibrate writes it"),
      file.string());
}

}  // namespace vbar::optical_stimulator
