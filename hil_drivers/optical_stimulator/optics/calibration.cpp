#include "hil_drivers/optical_stimulator/optics/calibration.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/output_file.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::optical_stimulator {

namespace {

struct Cell {
  std::size_t index;
  double share;  ///< share of the next node
};

Cell cell_of(double coordinate, double first, double step, int nodes) {
  const double place = std::clamp((coordinate - first) / step, 0.0, nodes - 1.0);
  const double index = std::min(std::floor(place), std::max(nodes - 2.0, 0.0));
  return {static_cast<std::size_t>(index), place - index};
}

}  // namespace

double UniformityGrid::at(const fsw::Vector2& display_px) const {
  if (values.empty()) return 1.0;
  const Cell x = cell_of(display_px.x(), first_px.x(), step_px.x(), columns);
  const Cell y = cell_of(display_px.y(), first_px.y(), step_px.y(), rows);
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t corner = y.index * width + x.index;
  const std::size_t right = columns > 1 ? 1 : 0, below = rows > 1 ? width : 0;
  const double upper = (1.0 - x.share) * values[corner] + x.share * values[corner + right];
  const double lower = (1.0 - x.share) * values[corner + below] + x.share * values[corner + below + right];
  return (1.0 - y.share) * upper + y.share * lower;
}

double CountsToLight::electrons_per_s(double count) const {
  if (!(count > first_count.value)) return 0.0;
  return full_pixel_electrons_per_s.value *
         std::pow((count - first_count.value) / (255.0 - first_count.value), gamma.value);
}

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

StimulatorCalibration read_calibration(const TableReader& document) {
  StimulatorCalibration calibration;
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

StimulatorCalibration parse_calibration(std::string_view text, const std::string& file) {
  const toml::table table = mission::parse_toml(text, file);
  return read_calibration(TableReader(table, file));
}

StimulatorCalibration load_calibration(const std::filesystem::path& file) {
  return parse_calibration(
      mission::read_data_text(file, "a calibration of the Optical Stimulator (TOML), as vbar_os_calibrate writes it"),
      file.string());
}

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

std::string toml_of(const StimulatorCalibration& calibration) {
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

void save_calibration(const StimulatorCalibration& calibration, const std::filesystem::path& file) {
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
