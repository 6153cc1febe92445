#include "emulators/optical_stimulator/settings.h"

#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/sensors/settings/camera_file.h"

namespace vbar::optical_stimulator::bench {
namespace {

using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::read;
using mission::TableReader;

constexpr mission::Names<Pace, 2> kPaces{{{"real", Pace::kReal}, {"fast", Pace::kFast}}};

template <std::size_t size>
void read(const TableReader& section, std::string_view key, Range range, std::array<double, size>& values) {
  if (!section.has(key)) return;
  const std::vector<double> found = section.numbers(key, size, size, range);
  for (std::size_t k = 0; k < size; ++k) values[k] = found[k];
}

void read_lenses(const TableReader& section, BenchSettings& bench) {
  read(section, "f1_mm", from_to(5.0, 2000.0), bench.lenses.f1_mm);
  read(section, "f2_mm", from_to(5.0, 2000.0), bench.lenses.f2_mm);
  read(section, "distortion", from_to(-100.0, 100.0), bench.optics.distortion);
  section.finish();
}

void read_display(const TableReader& section, BenchSettings& bench) {
  DisplaySettings& display = bench.display;
  read(section, "width", 16, 8192, display.width);
  read(section, "height", 16, 8192, display.height);
  read(section, "pitch_um", from_to(1.0, 200.0), bench.pose.pitch_um);
  read(section, "shift_mm", from_to(-10.0, 10.0), bench.pose.shift_mm);
  read(section, "turn_mrad", from_to(-200.0, 200.0), bench.pose.turn_mrad);
  read(section, "tilt_mrad", from_to(-200.0, 200.0), bench.pose.tilt_mrad);
  read(section, "full_luminance", above_to(0.0, 1e5), bench.light.full_luminance);
  read(section, "gamma", from_to(0.5, 5.0), bench.light.gamma);
  read(section, "first_count", from_to(0.0, 100.0), bench.light.first_count);
  read(section, "contrast", from_to(10.0, 1e12), bench.light.contrast);
  read(section, "pixel_unevenness", from_to(0.0, 0.5), bench.light.pixel_unevenness);
  read(section, "field_unevenness", from_to(0.0, 0.2), bench.field.light);
  read(section, "refresh_hz", from_to(1.0, 240.0), display.refresh_hz);
  read(section, "latency_frames", 0, 30, display.latency_frames);
  read(section, "response_ms", from_to(0.0, 100.0), display.response_ms);
  section.finish();
}

void read_field(const TableReader& section, FieldSettings& field) {
  read(section, "waves", 0, 1000, field.waves);
  read(section, "wave_length_px", from_to(50.0, 1e5), field.wave_length_px);
  read(section, "direction_arcsec", from_to(0.0, 600.0), field.direction_arcsec);
  section.finish();
}

void read_camera(const TableReader& section, BenchSettings& bench) {
  CameraErrors& camera = bench.camera;
  camera.file = section.name("file", camera.file);
  read(section, "gain_factor", from_to(0.1, 10.0), camera.gain_factor);
  read(section, "read_noise_factor", from_to(0.0, 10.0), camera.read_noise_factor);
  read(section, "offset_dn", from_to(-1000.0, 1000.0), camera.offset_dn);
  read(section, "hot_pixels", 0, 10000, camera.hot_pixels);
  read(section, "point_spread_sigma_px", from_to(0.2, 10.0), bench.optics.point_spread_sigma_px);
  read(section, "coma_px", from_to(0.0, 0.12), bench.optics.coma_px);
  read(section, "turn_mrad", from_to(-100.0, 100.0), bench.optics.camera_turn_mrad);
  bench.identity.vendor = section.text("vendor", bench.identity.vendor);
  bench.identity.model = section.text("model", bench.identity.model);
  bench.identity.serial = section.text("serial", bench.identity.serial);
  section.finish();
}

void read_rails(const TableReader& section, BenchSettings& bench) {
  RailSettings& rails = bench.rails;
  read(section, "microstep_um", above_to(0.0, 1000.0), rails.microstep_um);
  read(section, "backlash_um", from_to(0.0, 1000.0), rails.backlash_um);
  read(section, "repeatability_um", from_to(0.0, 1000.0), rails.repeatability_um);
  read(section, "travel_mm", from_to(1.0, 1000.0), rails.travel_mm);
  read(section, "lens_zero_mm", from_to(0.0, 1000.0), rails.lens_zero_mm);
  read(section, "display_zero_mm", from_to(0.0, 1000.0), rails.display_zero_mm);
  read(section, "zero_error_mm", from_to(0.0, 10.0), rails.zero_error_mm);
  read(section, "speed_mm_s", above_to(0.0, 1000.0), rails.speed_mm_s);
  section.finish();
}

void read_drift(const TableReader& section, DriftSettings& drift) {
  read(section, "day", 0, 1'000'000, drift.day);
  read(section, "day_shift_um", from_to(0.0, 1000.0), drift.day_shift_um);
  read(section, "day_scale_ppm", from_to(0.0, 1e4), drift.day_scale_ppm);
  read(section, "run_shift_um", from_to(0.0, 1000.0), drift.run_shift_um);
  read(section, "run_scale_ppm", from_to(0.0, 1e4), drift.run_scale_ppm);
  read(section, "run_frames", 1, 10'000'000, drift.run_frames);
  section.finish();
}

}  // namespace

BenchSettings read_bench(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  toml::table table =
      mission::parse_toml(mission::read_text_file(file, "the file of an optical bench (TOML)"), file.string());
  for (const std::string& assignment : assignments) mission::apply_override(table, assignment);
  const TableReader document(table, file.string());
  BenchSettings bench;
  bench.seed = static_cast<std::uint64_t>(document.integer("seed", 0, INT64_MAX, 1));
  bench.pace = document.choice<Pace>("pace", kPaces, bench.pace);
  bench.noise = document.flag("noise", bench.noise);
  read_lenses(document.table("lenses"), bench);
  read_display(document.table("display"), bench);
  read_field(document.table("field"), bench.field);
  read_camera(document.table("camera"), bench);
  read_rails(document.table("rails"), bench);
  read_drift(document.table("drift"), bench.drift);
  for (const TableReader& section : document.tables("fault")) bench.faults.push_back(read_fault(section));
  document.finish();
  return bench;
}

twins::camera::CameraSettings camera_of(const BenchSettings& settings, const std::filesystem::path& data_directory) {
  twins::camera::CameraSettings camera =
      sensors::load_camera(data_directory / "cameras" / (settings.camera.file + ".toml")).settings();
  camera.detector.gain_dn_per_electron *= settings.camera.gain_factor;
  camera.detector.read_noise_electrons *= settings.camera.read_noise_factor;
  camera.detector.offset_dn += settings.camera.offset_dn;
  camera.detector.hot_pixels = settings.camera.hot_pixels;
  camera.region = {0, 0, camera.detector.width, camera.detector.height};
  return camera;
}

}  // namespace vbar::optical_stimulator::bench
