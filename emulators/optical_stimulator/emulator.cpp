#include "emulators/optical_stimulator/emulator.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/wire/emulator_files.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr const char* kTerminal = "rails";
constexpr const char* kControlSocket = "control.sock";
constexpr std::chrono::milliseconds kLookAround{50};
constexpr std::size_t kLensAxis = 0, kDisplayAxis = 1;

zaber::DeviceSettings rail_settings(const BenchSettings& settings) {
  const RailSettings& rails = settings.rails;
  zaber::AxisSettings axis;
  axis.microstep_um = rails.microstep_um;
  axis.travel_um = 1e3 * rails.travel_mm;
  axis.backlash_um = rails.backlash_um;
  axis.repeatability_um = rails.repeatability_um;
  axis.speed_um_s = 1e3 * rails.speed_mm_s;
  axis.start_um = 0.5 * axis.travel_um;
  axis.moves_at_once = settings.pace == Pace::kFast;
  return {1, {axis, axis}, settings.seed};
}

double drawn_zero(const BenchSettings& settings, double zero_mm, const char* axis) {
  engine::RandomStream stream(settings.seed, std::string("bench/rails/zero/") + axis);
  return zero_mm + settings.rails.zero_error_mm * stream.normal();
}

}  // namespace

Bench::Bench(boost::asio::io_context& context, const BenchSettings& settings,
             const std::filesystem::path& data_directory, const std::filesystem::path& directory,
             std::function<void()> exit)
    : settings_(settings),
      directory_(directory),
      path_(settings, camera_of(settings, data_directory)),
      screen_(settings.display.width, settings.display.height, directory_.path()),
      watch_(settings.display, settings.pace, [this](std::vector<std::uint8_t>& grey) { screen_.read(grey); }),
      panel_(settings.display.width, settings.display.height),
      rails_(rail_settings(settings), [this] { return now_s(); }),
      lens_zero_mm_(drawn_zero(settings, settings.rails.lens_zero_mm, "lens")),
      display_zero_mm_(drawn_zero(settings, settings.rails.display_zero_mm, "display")),
      rail_server_(context, rails_, directory_.path() / kTerminal),
      camera_(std::make_unique<CameraLink>(context, settings, path_.camera().settings(),
                                           [this](const ExposureRequest& request) { return expose(request); })),
      faults_(fault_actions(std::move(exit)), directory_.path() / wire::kFaultsFile),
      control_(context, directory_.path() / kControlSocket,
               [this](const std::string& line, const emulators::Answer& answer) {
                 faults_.add(fault_from_json(line), now_s(),
                             [answer](const std::string& injected) { answer("{\"injected\":" + injected + "}"); });
               }),
      timer_(context) {
  rail_server_.on_command = [this] { faults_.advance(now_s()); };
  for (const Fault& fault : settings.faults) faults_.add(fault, now_s());
  look_around();
  write_addresses();
}

Bench::~Bench() = default;

double Bench::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

RailPlaces Bench::rail_places() {
  return {lens_zero_mm_ + 1e-3 * rails_.axis(kLensAxis).carriage_um(),
          display_zero_mm_ + 1e-3 * rails_.axis(kDisplayAxis).carriage_um()};
}

std::vector<std::uint16_t> Bench::expose(const ExposureRequest& request) {
  const auto begin = std::chrono::steady_clock::now();
  const ExposureFaults faults = faults_.begin_exposure(frames_, now_s());
  const Pictures pictures = panel_.show(watch_.during(begin, request.read_out.exposure_s), faults.panel);
  std::vector<std::uint16_t> dn;
  path_.expose(pictures, request, rail_places(), faults, frames_, dn);
  faults_.end_exposure(frames_);
  ++frames_;
  return dn;
}

FaultActions Bench::fault_actions(std::function<void()> exit) {
  FaultActions actions;
  actions.camera = [this](const Fault& fault, bool is_on) { camera_->set_fault(fault, is_on); };
  actions.bump = [this](double x_um, double y_um) { path_.bump(x_um, y_um); };
  actions.stall_rail = [this](std::size_t axis) { rails_.axis(axis).block(); };
  actions.move_rail = [this](std::size_t axis, double um) { rails_.axis(axis).displace(um); };
  actions.rail_stalls = [this](std::size_t axis) { return rails_.axis(axis).stalls(); };
  actions.exit = std::move(exit);
  return actions;
}

/// In between: faults whose time has passed, and an X server that has ended.
void Bench::look_around() {
  faults_.advance(now_s());
  if (screen_.has_ended()) throw std::runtime_error("the X server of the bench has ended");
  timer_.expires_after(kLookAround);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) look_around();
  });
}

void Bench::write_addresses() const {
  nlohmann::ordered_json addresses;
  addresses["display"] = screen_.display();
  addresses["camera"] = camera_->address();
  addresses["rails"]["pty"] = (directory_.path() / kTerminal).string();
  addresses["rails"]["tcp"] = fmt::format("127.0.0.1:{}", rail_server_.tcp_port());
  addresses["control"] = (directory_.path() / kControlSocket).string();
  addresses["faults"] = (directory_.path() / wire::kFaultsFile).string();
  directory_.write_addresses(addresses.dump(2));
}

}  // namespace vbar::optical_stimulator::bench
