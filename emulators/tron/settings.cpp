#include "emulators/tron/settings.h"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "emulators/tron/world/world.h"
#include "hil_drivers/tron/protocols/vicon_stream.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/sensors/settings/camera_file.h"

namespace vbar::tron::bench {
namespace {

using mission::above_to;
using mission::from_to;
using mission::read;
using mission::TableReader;

constexpr mission::Names<ClockKind, 2> kClocks{{{"virtual", ClockKind::kVirtual}, {"real", ClockKind::kReal}}};
constexpr std::string_view kLaboratory = "laboratory.";

struct GapKey {
  std::string_view key;
  bool GapSettings::*part;
};
constexpr std::array<GapKey, 7> kGapKeys{{{"surfaces", &GapSettings::surfaces},
                                          {"shape", &GapSettings::shape},
                                          {"lamp", &GapSettings::lamp},
                                          {"earth_light", &GapSettings::earth_light},
                                          {"room", &GapSettings::room},
                                          {"focus", &GapSettings::focus},
                                          {"detector", &GapSettings::detector}}};

/// Keys of the laboratory, and all others.
struct Assignments {
  std::vector<std::string> laboratory, bench;
};

Assignments sorted(const std::vector<std::string>& assignments) {
  Assignments sorted;
  for (const std::string& assignment : assignments) {
    if (assignment.starts_with(kLaboratory))
      sorted.laboratory.push_back(assignment.substr(kLaboratory.size()));
    else
      sorted.bench.push_back(assignment);
  }
  return sorted;
}

void read_clock(const TableReader& section, ClockSettings& clock) {
  clock.kind = section.choice<ClockKind>("kind", kClocks, clock.kind);
  const double patience_s =
      section.number("patience_s", above_to(0.0, 1e5), 1e-3 * static_cast<double>(clock.patience.count()));
  clock.patience = std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * patience_s));
  section.finish();
}

void read_errors(const TableReader& section, ErrorSizes& errors) {
  for (const ErrorKey& key : kErrorKeys) read(section, key.key, from_to(0.0, key.largest), errors.*key.size);
  section.finish();
}

void read_vicon(const TableReader& section, BenchSettings& bench) {
  for (const CaptureErrorKey& key : kCaptureErrorKeys)
    read(section, key.key, from_to(key.smallest, key.largest), bench.capture.*key.size);
  const auto bytes = section.integer("block_bytes", 0, 1024, static_cast<std::int64_t>(bench.vicon_block_bytes));
  bench.vicon_block_bytes = static_cast<std::size_t>(bytes);
  if (std::ranges::find(vicon::kBlockBytes, bench.vicon_block_bytes) == vicon::kBlockBytes.end())
    section.refuse_value("block_bytes", "0, 256, 512 or 1024");
  section.finish();
}

void read_lights(const TableReader& section, LightErrorSizes& lights) {
  for (const LightErrorKey& key : kLightErrorKeys)
    read(section, key.key, from_to(key.smallest, key.largest), lights.*key.size);
  section.finish();
}

void read_gap(const TableReader& section, GapSettings& gap) {
  for (const GapKey& key : kGapKeys) gap.*key.part = section.flag(key.key, gap.*key.part);
  section.finish();
}

void read_camera(const TableReader& section, BenchSettings& bench) {
  CameraIdentity& identity = bench.identity;
  identity.vendor = section.text("vendor", identity.vendor);
  identity.model = section.text("model", identity.model);
  identity.serial = section.text("serial", identity.serial);
  SensorSettings& sensor = bench.sensor;
  read(section, "gain_dn_per_electron", above_to(0.0, 10.0), sensor.gain_dn_per_electron);
  read(section, "read_noise_electrons", from_to(0.0, 1000.0), sensor.read_noise_electrons);
  read(section, "photo_response_nonuniformity", from_to(0.0, 0.5), sensor.photo_response_nonuniformity);
  read(section, "hot_pixels", 0, 10000, sensor.hot_pixels);
  section.finish();
}

}  // namespace

BenchSettings read_bench(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  toml::table table =
      mission::parse_toml(mission::read_text_file(file, "the file of an emulated robotic bench (TOML)"), file.string());
  const Assignments set = sorted(assignments);
  for (const std::string& assignment : set.bench) mission::apply_override(table, assignment);
  const TableReader document(table, file.string());
  BenchSettings bench;
  bench.laboratory = read_testbed_design(file.parent_path() / document.text("laboratory"), set.laboratory);
  bench.seed = static_cast<std::uint64_t>(document.integer("seed", 0, INT64_MAX, 1));
  read_clock(document.table("clock"), bench.clock);
  read_errors(document.table("errors"), bench.errors);
  read_camera(document.table("camera"), bench);
  read_vicon(document.table("vicon"), bench);
  read_lights(document.table("lights"), bench.lights);
  read_gap(document.table("gap"), bench.gap);
  for (const TableReader& section : document.tables("fault")) bench.faults.push_back(read_fault(section));
  document.finish();
  return bench;
}

twins::camera::CameraSettings true_camera(const BenchSettings& settings, const std::filesystem::path& data_directory) {
  constexpr int kBits = 12;
  twins::camera::CameraSettings camera =
      sensors::load_camera(data_directory / "cameras" / (settings.laboratory.camera.file + ".toml")).single;
  camera.detector.bits = kBits;
  camera.detector.gain_dn_per_electron = settings.sensor.gain_dn_per_electron;
  camera.detector.read_noise_electrons = settings.sensor.read_noise_electrons;
  camera.detector.photo_response_nonuniformity = settings.sensor.photo_response_nonuniformity;
  camera.detector.hot_pixels = settings.sensor.hot_pixels;
  camera.region = {0, 0, camera.detector.width, camera.detector.height};
  return with_lens_errors(camera, settings.errors, settings.seed);
}

}  // namespace vbar::tron::bench
