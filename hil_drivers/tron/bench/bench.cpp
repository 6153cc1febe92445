#include "hil_drivers/tron/bench/bench.h"

#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/bench_lines/json_table.h"
#include "hil_drivers/tron/calibrate/board/board_design.h"
#include "host_sim/mission/names.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::tron::bench {
namespace {

constexpr const char* kControlSocket = "control.sock";
constexpr const char* kFaultFile = "faults.jsonl";
constexpr const char* kTruthFile = "truth.csv";
constexpr const char* kSummaryFile = "summary.json";
constexpr const char* kControlLine = "control line";
constexpr std::chrono::milliseconds kLookAround{50};

constexpr mission::Names<Mounted, kMountedThings> kMounted{
    {{"target", Mounted::kTarget}, {"board", Mounted::kBoard}, {"patch", Mounted::kPatch}}};

std::array<Eigen::Isometry3d, kMountedThings> mounts_of(const BenchFile& laboratory) {
  // The white patch is a part of the board.
  const Eigen::Isometry3d board = calibrate::T_flange_board(laboratory);
  return {laboratory.target.T_flange_target(laboratory.scale), board, board};
}

}  // namespace

Bench::Bench(boost::asio::io_context& context, const BenchSettings& settings, const BenchPlace& place,
             std::function<void()> exit)
    : settings_(settings),
      directory_(place.directory),
      world_(settings.laboratory, mounts_of(settings.laboratory), settings.errors, settings.seed),
      robots_(context, settings, world_, place.ports),
      clock_(context, settings.clock, robots_.both()),
      camera_(context, settings, true_camera(settings, place.data),
              [this](const gige::Request& request) { return expose(request); }),
      truth_(place.truth.empty() ? directory_.path() / kTruthFile : place.truth),
      exit_(std::move(exit)),
      faults_([this](const Fault& fault, bool is_on) { act(fault, is_on); }, directory_.path() / kFaultFile),
      control_(context, directory_.path() / kControlSocket,
               [this](const std::string& line, const bench_lines::Answer& answer) { control(line, answer); }),
      timer_(context) {
  clock_.before_cycle([this](std::uint64_t cycle) { begin_cycle(cycle); });
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
}

gige::Image Bench::expose(const gige::Request& request) {
  TrueExposure exposure;
  exposure.image = images_;
  exposure.cycle = clock_.cycle();
  exposure.bench_s = clock_.time_s();
  exposure.exposure_s = request.exposure_s;
  exposure.mounted = mounted_;
  exposure.posture = robots_.true_posture();
  exposure.T_C_mounted = world_.T_C_mounted(exposure.posture, mounted_);
  truth_.write(exposure);
  faults_.end_exposure(images_++, wall_s());
  return {};
}

void Bench::act(const Fault& fault, bool is_on) {
  if (camera_.set_fault(fault, is_on) || robots_.set_fault(fault, is_on)) return;
  if (fault.kind == FaultKind::kMountSlipped) world_.slip(1e-3 * fault.value);
  if (fault.kind == FaultKind::kBenchExit) exit_();
}

/// A fault, or {"do": "mount", "what": "board"}, {"do": "summary"}.
void Bench::control(const std::string& line, const bench_lines::Answer& answer) {
  const toml::table table =
      bench_lines::table_of_json(line, kControlLine, R"({"do": "mount", "what": "board"} or {"kind": "lamp_out"})");
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
  addresses["control"] = (directory_.path() / kControlSocket).string();
  addresses["faults"] = (directory_.path() / kFaultFile).string();
  directory_.write_addresses(addresses.dump(2));
}

}  // namespace vbar::tron::bench
