// Emulated Skydel instances on their ports: control by TCP, samples and vehicle information by UDP.

#include <cmath>
#include <optional>

#include "emulators/common/sockets.h"
#include "emulators/grand/control/control_servers.h"
#include "emulators/grand/control/skydel_commands.h"
#include "hil_drivers/grand/trajectory/antenna_attitude.h"
#include "hil_drivers/grand/wire/skydel.h"

namespace vbar::grand::bench {
namespace {

using emulators::Connection;
using emulators::DatagramPort;
using emulators::Listener;

class SkydelServer final : public ControlServers {
 public:
  SkydelServer(boost::asio::io_context& context, Engine& engine, const ControlSettings& settings) : engine_(engine) {
    for (std::size_t k = 0; k < engine.vehicles(); ++k) {
      Port& port = ports_.emplace_back();
      port.control = std::make_shared<Listener>(context, port_at(settings.control_ports, k));
      port.hil = std::make_shared<DatagramPort>(context, port_at(settings.hil_ports, k));
    }
    commands_.emplace(engine, settings, hil_ports());
    for (std::size_t k = 0; k < ports_.size(); ++k) {
      ports_[k].control->start([this, k] { return accept(k); });
      ports_[k].hil->start([this, k](auto datagram, const auto& sender) { receive(k, datagram, sender); });
    }
    engine.on_progress.emplace_back([this, alive = std::weak_ptr<int>(alive_)](std::size_t vehicle) {
      if (alive.expired()) return;
      commands_->note_progress(vehicle);
      send_vehicle_info(vehicle);
    });
  }
  ~SkydelServer() override {
    for (const Port& port : ports_) {
      port.control->close();
      port.hil->close();
    }
  }
  SkydelServer(const SkydelServer&) = delete;
  SkydelServer& operator=(const SkydelServer&) = delete;

  [[nodiscard]] std::vector<std::uint16_t> control_ports() const override {
    std::vector<std::uint16_t> numbers;
    for (const Port& port : ports_) numbers.push_back(port.control->port());
    return numbers;
  }
  [[nodiscard]] std::vector<std::uint16_t> hil_ports() const override {
    std::vector<std::uint16_t> numbers;
    for (const Port& port : ports_) numbers.push_back(port.hil->port());
    return numbers;
  }
  void set_faults(const ControlFaults& faults) override { faults_ = faults; }
  void close_connections() override {
    for (const Port& port : ports_) port.control->close_connections();
  }
  [[nodiscard]] ControlStatistics statistics() const override { return statistics_; }

 private:
  struct Port {
    std::shared_ptr<Listener> control;
    std::shared_ptr<DatagramPort> hil;
    std::optional<DatagramPort::Endpoint> peer = std::nullopt;  ///< who sends the samples
    fsw::Vector3 last_position_m = fsw::Vector3::Zero();
    double odometer_m = -1.0;  ///< negative before the first vehicle information
  };

  Connection::Receive accept(std::size_t instance) {
    if (faults_.refuses_connections) {
      ++statistics_.faults_applied;
      return nullptr;
    }
    return [this, instance, frames = std::make_shared<wire::SkydelFrames>()](Connection& connection, auto bytes) {
      frames->append(bytes);
      try {
        while (connection.is_open()) {
          const auto frame = frames->next();
          if (!frame) return;
          handle(instance, connection, *frame);
        }
      } catch (const wire::WireError&) {
        // Without a frame boundary there is nothing to answer.
        ++statistics_.malformed;
        connection.close();
      }
    };
  }

  void handle(std::size_t instance, Connection& connection, const wire::SkydelFrame& frame) {
    if (frame.kind == wire::SkydelFrameKind::kApiVersion)
      return connection.send(wire::encode_api_version(wire::kSkydelApiVersion));
    if (frame.kind == wire::SkydelFrameKind::kResult) throw wire::WireError("a client sends no results");
    ++statistics_.commands;
    std::string name;
    try {
      name = wire::name_of(frame.json);
    } catch (const wire::WireError& error) {
      return answer(connection, wire::skydel_failure(frame.json, error.what()));
    }
    switch (fault_of(faults_, name, statistics_)) {
      case FaultEffect::kNoAnswer:
        return;
      case FaultEffect::kClosing:
        return connection.close();
      case FaultEffect::kRefusal:
        return answer(connection, wire::skydel_failure(frame.json, faults_.refusal));
      case FaultEffect::kNone:
        break;
    }
    const auto later = [this, alive = std::weak_ptr<int>(alive_),
                        weak = connection.weak_from_this()](const wire::Json& result) {
      const auto open = weak.lock();
      if (open && !alive.expired()) answer(*open, result);
    };
    if (const auto result = commands_->execute(instance, frame.json, later)) answer(connection, *result);
    // The first one states where the vehicle is, so that a client need not wait for it to move.
    if (name == "BeginVehicleInfo") send_vehicle_info(instance);
  }

  void answer(Connection& connection, const wire::Json& result) {
    if (wire::name_of(result) == wire::kSkydelFailure) ++statistics_.refused;
    connection.send(wire::encode_result(result));
  }

  void receive(std::size_t vehicle, std::span<const std::uint8_t> datagram, const DatagramPort::Endpoint& sender) {
    try {
      const wire::SkydelHilMessage message = wire::decode_hil(datagram);
      if (std::holds_alternative<wire::SkydelBye>(message)) {
        ports_[vehicle].peer.reset();
        return;
      }
      ports_[vehicle].peer = sender;
      if (const auto* sample = std::get_if<wire::SkydelSample>(&message)) take(vehicle, *sample);
    } catch (const wire::WireError&) {
      ++statistics_.malformed;
    }
  }

  void take(std::size_t vehicle, const wire::SkydelSample& message) {
    if (!message.name.empty() || !commands_->expects_samples(vehicle)) {
      ++statistics_.samples_refused;
      return;
    }
    ++statistics_.samples;
    const bool is_repeated =
        engine_.state() == EngineState::kStreaming && message.sample.time <= engine_.report(vehicle).time;
    engine_.sample(vehicle, message.sample);
    // A sample that comes again may mean that the vehicle information was lost.
    if (is_repeated) send_vehicle_info(vehicle);
  }

  void send_vehicle_info(std::size_t vehicle) {
    Port& port = ports_[vehicle];
    if (faults_.is_silent || !port.peer || !commands_->sends_vehicle_info(vehicle)) return;
    // The time on the wire has whole milliseconds, in real time unlike that of the motion.
    constexpr std::int64_t kNsPerMs = 1'000'000;
    const std::int64_t time_ms = engine_.report(vehicle).time.ns / kNsPerMs;
    const TrajectorySample flown = engine_.flown(vehicle, {time_ms * kNsPerMs});
    const fsw::Vector3& r = flown.position_ecef_m;
    if (r.isZero()) return;  // it has not been placed
    port.odometer_m = port.odometer_m < 0.0 ? 0.0 : port.odometer_m + (r - port.last_position_m).norm();
    port.last_position_m = r;
    wire::SkydelVehicleInfo info;
    info.time_ms = static_cast<std::uint64_t>(time_ms);
    info.position_ecef_m = r;
    info.yaw_pitch_roll = flown.yaw_pitch_roll;
    info.speed_mps = flown.velocity_ecef_mps.norm();
    const fsw::Vector3 v_ned =
        local_frame(r, flown.velocity_ecef_mps, flown.acceleration_ecef_mps2).R_ned_ecef * flown.velocity_ecef_mps;
    info.heading = std::atan2(v_ned.y(), v_ned.x());
    info.odometer_m = port.odometer_m;
    port.hil->send(wire::encode_vehicle_info(info), *port.peer);
  }

  Engine& engine_;
  std::vector<Port> ports_;
  std::optional<SkydelCommands> commands_;
  ControlFaults faults_;
  ControlStatistics statistics_;
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);  ///< gone when this object is: the engine keeps callbacks
};

}  // namespace

std::unique_ptr<ControlServers> make_skydel_server(boost::asio::io_context& context, Engine& engine,
                                                   const ControlSettings& settings) {
  return std::make_unique<SkydelServer>(context, engine, settings);
}

}  // namespace vbar::grand::bench
