#include "hil_drivers/tron/wired_calibration/wired_bench.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/tron/collision/bench_bodies.h"
#include "hil_drivers/tron/hardware/wired_laboratory.h"
#include "hil_drivers/tron/motion/path_planner.h"

namespace vbar::tron::calibrate {
namespace {

constexpr int kWidth = 1920, kHeight = 1200;
constexpr double kLampDelay_s = 0.1;
constexpr int kInterruptions = 3;  // of a motion

/// The answer of an emulated bench to a line on its control socket.
std::string control(const std::filesystem::path& socket_file, const std::string& line) {
  namespace asio = boost::asio;
  asio::io_context context;
  asio::local::stream_protocol::socket socket(context);
  socket.connect(asio::local::stream_protocol::endpoint(socket_file.string()));
  asio::write(socket, asio::buffer(line + "\n"));
  asio::streambuf buffer;
  asio::read_until(socket, buffer, '\n');
  const std::string answer(asio::buffers_begin(buffer.data()), asio::buffers_end(buffer.data()));
  if (answer.find("\"error\"") != std::string::npos)
    throw std::runtime_error("emulated bench: " + answer.substr(0, answer.find('\n')));
  return answer;
}

DeviceSettings device_settings(const WiredBenchSettings& settings) {
  DeviceSettings devices;
  devices.bench = settings.bench;
  devices.is_emulated = !settings.command.empty();
  devices.region = {0, 0, kWidth, kHeight};
  devices.report = settings.report;
  return devices;
}

}  // namespace

struct WiredBench::Parts {
  explicit Parts(const WiredBenchSettings& of)
      : settings(of), laboratory(device_settings(of)), bodies(of.bench), paths(of.bench, bodies) {}

  WiredBenchSettings settings;
  WiredLaboratory laboratory;
  std::optional<bench_process::BenchProcess> process;
  BenchAddresses addresses;
  BenchBodies bodies;
  PathPlanner paths;
  std::optional<double> lamp_rad;
};

WiredBench::WiredBench(const WiredBenchSettings& settings) : parts_(std::make_unique<Parts>(settings)) {
  Parts& parts = *parts_;
  parts.addresses = addresses_of(settings.bench);
  if (!settings.command.empty()) {
    parts.process.emplace(settings.command + parts.laboratory.port_options(), settings.seed, settings.data_directory);
    parts.addresses = read_addresses(parts.process->addresses_file());
  }
  parts.laboratory.open(parts.addresses);
}

WiredBench::~WiredBench() {
  parts_->laboratory.close();
  if (parts_->process) parts_->process->stop();
}

BenchIdentity WiredBench::identity() {
  const WiredLaboratory& laboratory = parts_->laboratory;
  return {laboratory.camera_model(), laboratory.camera_serial(), laboratory.camera_is_emulated()};
}

void WiredBench::mount(Mounted what) {
  const char* const name = what == Mounted::kBoard ? "board" : "target";
  if (!parts_->addresses.control.empty()) {
    control(parts_->addresses.control, fmt::format(R"({{"do": "mount", "what": "{}"}})", name));
  } else if (parts_->settings.ask) {
    parts_->settings.ask(fmt::format("mount the {} on the plate of the target's arm", name));
  } else {
    throw std::runtime_error(fmt::format("nobody can be asked to mount the {}", name));
  }
}

bool WiredBench::move(const Posture& posture) {
  Parts& parts = *parts_;
  for (int k = 0; k < kInterruptions; ++k) {
    const auto found = parts.paths.plan(parts.laboratory.posture(), posture);
    if (std::holds_alternative<NoPath>(found)) return false;
    const auto path = std::make_shared<const Path>(std::get<Path>(found));
    Motion motion;
    motion.cycles = path->cycles();
    motion.at = [path](int cycle) { return path->at(cycle); };
    if (parts.laboratory.follow(motion) == MotionEnd::kArrived) return true;
    parts.laboratory.recover();
  }
  throw std::runtime_error(fmt::format("robots: a motion was interrupted {} times", kInterruptions));
}

BenchPlace WiredBench::measure() {
  for (int k = 0; k < kInterruptions; ++k) {
    const auto measured = parts_->laboratory.measure();
    if (const auto* const place = std::get_if<MeasuredPlace>(&measured)) {
      BenchPlace result{place->posture, std::nullopt};
      if (place->capture) result.vicon = ViconObjects{place->capture->T_V_camera, place->capture->T_V_target};
      return result;
    }
    parts_->laboratory.recover();
  }
  throw std::runtime_error(fmt::format("robots: a measurement was interrupted {} times", kInterruptions));
}

void WiredBench::light(const LightShares& shares) {
  Parts& parts = *parts_;
  LightLevels levels;
  levels.lamp_power = shares.lamp;
  levels.lamp_azimuth_rad = shares.lamp_azimuth_rad;
  levels.box_power = shares.boxes;
  // Without a table the laboratory sends shares as they are.
  parts.laboratory.light(levels);
  const double way_rad = parts.lamp_rad ? std::abs(shares.lamp_azimuth_rad - *parts.lamp_rad) : std::numbers::pi;
  parts.lamp_rad = shares.lamp_azimuth_rad;
  if (parts.laboratory.hold(way_rad / parts.settings.bench.lamp.speed_rad_s + kLampDelay_s) == MotionEnd::kInterrupted)
    parts.laboratory.recover();
}

BenchImage WiredBench::take(double exposure_s) {
  return {kWidth, kHeight, 12, parts_->laboratory.take(exposure_s).dn};
}

std::filesystem::path WiredBench::truth_file() const {
  return parts_->process ? parts_->process->directory() / "truth.csv" : std::filesystem::path();
}

void WiredBench::stop() noexcept {
  parts_->laboratory.stop();
}

}  // namespace vbar::tron::calibrate
