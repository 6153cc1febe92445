#include "emulators/tron/emulator.h"

#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "emulators/common/control_line.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/wire/emulator_files.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::tron::bench {
namespace {

constexpr const char* kControlSocket = "control.sock";
constexpr const char* kTruthFile = "truth.csv";
constexpr const char* kSummaryFile = "summary.json";
constexpr const char* kControlLine = "control line";
constexpr std::chrono::milliseconds kLookAround{50};

constexpr mission::Names<Mounted, kMountedThings> kMounted{
    {{"target", Mounted::kTarget}, {"board", Mounted::kBoard}, {"patch", Mounted::kPatch}}};

std::array<Eigen::Isometry3d, kMountedThings> mounts_of(const TestbedDesign& laboratory) {
  // The white patch is a part of the board.
  const Eigen::Isometry3d board = calibrate::T_flange_board(laboratory);
  return {laboratory.target.T_flange_target(laboratory.scale), board, board};
}

nlohmann::ordered_json lights_summary(const SourceCounts& counts) {
  nlohmann::ordered_json summary;
  summary["accepted"] = counts.accepted;
  summary["unreadable"] = counts.unreadable;
  summary["out_of_sequence"] = counts.out_of_sequence;
  summary["refused_sources"] = counts.refused_sources;
  summary["terminations"] = counts.terminations;
  summary["losses"] = counts.losses;
  return summary;
}

nlohmann::ordered_json camera_summary(const gige::Device::Statistics& counts) {
  nlohmann::ordered_json summary;
  summary["triggers"] = counts.acquisition.triggers;
  summary["triggers_dropped"] = counts.acquisition.triggers_dropped;
  summary["exposures"] = counts.acquisition.exposures;
  summary["frames_dropped"] = counts.acquisition.frames_dropped;
  summary["packets"] = counts.stream.packets;
  summary["packets_resent"] = counts.stream.packets_resent;
  return summary;
}

ObjectStreamSettings stream_settings(const BenchSettings& settings, const DriverPorts& ports) {
  ObjectStreamSettings stream;
  stream.vicon = settings.laboratory.vicon;
  if (ports.vicon != 0) stream.vicon.port = ports.vicon;
  stream.block_bytes = settings.vicon_block_bytes;
  return stream;
}

}  // namespace

Bench::Bench(boost::asio::io_context& context, const BenchSettings& settings, const MeasuredPosture& place,
             std::function<void()> exit)
    : settings_(settings),
      vicon_port_(stream_settings(settings, place.ports).vicon.port),
      directory_(place.directory),
      world_(settings.laboratory, mounts_of(settings.laboratory), settings.errors, settings.seed),
      robots_(context, settings, world_, place.ports),
      capture_errors_(settings.capture, settings.seed),
      capture_view_(settings_.laboratory, world_),
      vicon_(context, stream_settings(settings, place.ports), capture_errors_,
             [this](CaptureObject object) { return capture_view_.tracked(object, robots_.true_posture()); }),
      rig_(settings.laboratory.lamp, settings.lights, settings.seed),
      lights_(context, settings.laboratory.sacn, 0, rig_),
      clock_(context, settings.clock, robots_.both()),
      sensor_(true_camera(settings, place.data)),
      renderer_(settings_.laboratory, settings.gap, settings.seed, place.data),
      truth_(place.truth.empty() ? directory_.path() / kTruthFile : place.truth),
      exit_(std::move(exit)),
      faults_([this](const Fault& fault, bool is_on) { act(fault, is_on); }, directory_.path() / wire::kFaultsFile),
      camera_(context, settings, sensor_,
              {[this](const gige::Request& request) { return look(request); },
               [this](const LabView& view) { return render(view); }, [this] { end_exposure(); }}),
      control_(context, directory_.path() / kControlSocket,
               [this](const std::string& line, const emulators::Answer& answer) { control(line, answer); }),
      timer_(context) {
  clock_.before_cycle([this](std::uint64_t cycle) { begin_cycle(cycle); });
  clock_.after_motion([this](std::uint64_t) { end_motion(); });
  for (const Fault& fault : settings.faults) faults_.add(fault, wall_s());
  look_around();
  clock_.start();
  write_addresses();
}

Bench::~Bench() {
  std::ofstream(directory_.path() / kSummaryFile) << summary().dump(2) << "\n";
}

double Bench::wall_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Bench::begin_cycle(std::uint64_t cycle) {
  faults_.begin_cycle(cycle, wall_s());
  lights_.begin_cycle(clock_.time_s());
}

void Bench::end_motion() {
  if (vicon_.tick(clock_.time_s()) > 0) faults_.vicon_frame_sent();
}

LabView Bench::look(const gige::Request& request) {
  const Posture posture = robots_.true_posture();
  const TrueLights lights = rig_.lights();
  const auto located = capture_view_.located(posture);
  truth_.write({images_, clock_.cycle(), clock_.time_s(), request.exposure_s, mounted_,
                world_.T_C_mounted(posture, mounted_), posture, lights.lamp_power, lights.lamp_azimuth_rad,
                lights.box_power, located[0], located[1]});
  LabView view;
  view.T_L_C = world_.T_L_C(posture);
  view.T_L_T = world_.T_L_mounted(posture, Mounted::kTarget);
  if (mounted_ != Mounted::kTarget) view.T_L_board = world_.T_L_mounted(posture, mounted_);
  for (const Capsule& link : capture_view_.arms(posture)) view.arms.push_back({link.from, link.to, link.radius_m});
  view.lamp = {lights.lamp_azimuth_rad, lights.lamp_power};
  view.box_powers = lights.box_power;
  view.camera = sensor_;
  view.camera.region = request.region;
  view.camera.exposure_s = exposure_factor_ * request.exposure_s;
  view.camera.detector.gain_dn_per_electron *= gain_factor_ * std::pow(10.0, request.gain_db / 20.0);
  view.camera.detector.offset_dn = request.black_level_dn;
  view.frame = static_cast<std::int64_t>(images_);
  return view;
}

std::vector<std::uint16_t> Bench::render(const LabView& view) {
  try {
    return renderer_.expose(view);
  } catch (const std::exception& error) {
    // The driver gets an image without light.
    ++views_refused_;
    fmt::print(stderr, "vbar_tron_bench: image {}: {}\n", view.frame, error.what());
    return {};
  }
}

void Bench::end_exposure() {
  faults_.end_exposure(images_++, wall_s());
}

bool Bench::set_light_or_capture(const Fault& fault, bool is_on) {
  const CaptureObject object = fault.is_of_target ? CaptureObject::kTarget : CaptureObject::kCamera;
  switch (fault.kind) {
    case FaultKind::kViconHidden:
      vicon_.set_hidden(object, is_on);
      return true;
    case FaultKind::kViconZeros:
      vicon_.set_zeros(object, is_on);
      return true;
    case FaultKind::kViconFrozen:
      vicon_.set_frozen(object, is_on);
      return true;
    case FaultKind::kViconOffset:
      vicon_.set_offset(object, is_on ? 1e-3 * fault.value : 0.0);
      return true;
    case FaultKind::kLampOut:
      rig_.set_lamp_out(is_on);
      return true;
    case FaultKind::kBoxOut:
      rig_.set_box_out(fault.box, is_on);
      return true;
    default:
      return false;
  }
}

void Bench::act(const Fault& fault, bool is_on) {
  if (set_light_or_capture(fault, is_on)) return;
  if (camera_.set_fault(fault, is_on) || robots_.set_fault(fault, is_on)) return;
  if (fault.kind == FaultKind::kExposure) exposure_factor_ = is_on ? fault.value : 1.0;
  if (fault.kind == FaultKind::kGain) gain_factor_ = is_on ? fault.value : 1.0;
  if (fault.kind == FaultKind::kMountSlipped) world_.slip(1e-3 * fault.value);
  if (fault.kind == FaultKind::kBenchExit) exit_();
}

/// A fault, or {"do": "mount", "what": "board"}, {"do": "summary"}.
void Bench::control(const std::string& line, const emulators::Answer& answer) {
  const toml::table table =
      emulators::table_of_json(line, kControlLine, R"({"do": "mount", "what": "board"} or {"kind": "lamp_out"})");
  const mission::TableReader command(table, kControlLine);
  if (!command.has("do")) {
    faults_.add(fault_from_json(line), wall_s(),
                [answer](const std::string& injected) { answer("{\"injected\":" + injected + "}"); });
    return;
  }
  enum class Do { kMount, kSummary };
  constexpr mission::Names<Do, 2> kCommands{{{"mount", Do::kMount}, {"summary", Do::kSummary}}};
  switch (command.choice<Do>("do", kCommands)) {
    case Do::kMount:
      mounted_ = command.choice<Mounted>("what", kMounted);
      command.finish();
      return answer(fmt::format(R"({{"mounted":"{}"}})", mission::name_in(kMounted, mounted_)));
    case Do::kSummary:
      command.finish();
      return answer(summary().dump());
  }
}

nlohmann::ordered_json Bench::summary() const {
  nlohmann::ordered_json summary;
  summary["seed"] = settings_.seed;
  summary["cycles"] = clock_.cycle();
  summary["bench_s"] = clock_.time_s();
  summary["clock_overruns"] = clock_.overruns();
  summary["images"] = images_;
  summary["views_refused"] = views_refused_.load();
  summary["vicon_frames"] = vicon_.frames();
  summary["sacn"] = lights_summary(lights_.counts());
  summary["camera"] = camera_summary(camera_.statistics());
  summary.update(robots_.summary());
  return summary;
}

/// In between: faults whose time has passed.
void Bench::look_around() {
  faults_.advance(wall_s());
  timer_.expires_after(kLookAround);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) look_around();
  });
}

void Bench::write_addresses() const {
  const auto robot = [](const Controller& controller) {
    const ControllerSettings& settings = controller.settings();
    nlohmann::ordered_json json;
    json["rsi_port"] = settings.ethernet.port;
    json["eki"] = fmt::format("{}:{}", settings.robot.line.address, controller.eki_port());
    return json;
  };
  nlohmann::ordered_json addresses;
  addresses["clock"] = settings_.clock.kind == ClockKind::kReal ? "real" : "virtual";
  addresses["camera"] = camera_.address();
  addresses["camera_robot"] = robot(robots_.of_camera());
  addresses["target_robot"] = robot(robots_.of_target());
  addresses["vicon_port"] = vicon_port_;
  addresses["sacn"] = lights_.address();
  addresses["control"] = (directory_.path() / kControlSocket).string();
  addresses["faults"] = (directory_.path() / wire::kFaultsFile).string();
  directory_.write_addresses(addresses.dump(2));
}

}  // namespace vbar::tron::bench
