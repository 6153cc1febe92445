#pragma once
// Server whose commands are lines on one TCP port, and whose samples come by UDP: the common part of SimGEN and the
// template.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "emulators/common/sockets.h"
#include "emulators/grand/control/control_servers.h"
#include "hil_drivers/wire/bytes.h"

namespace vbar::grand::bench {

using emulators::Connection;
using emulators::DatagramPort;
using emulators::Listener;

class LineServer : public ControlServers {
 public:
  LineServer(boost::asio::io_context& context, Engine& engine, const ControlSettings& settings, std::size_t udp_ports);
  ~LineServer() override;
  LineServer(const LineServer&) = delete;
  LineServer& operator=(const LineServer&) = delete;

  [[nodiscard]] std::vector<std::uint16_t> control_ports() const override { return hil_ports(); }
  [[nodiscard]] std::vector<std::uint16_t> hil_ports() const override;
  void set_faults(const ControlFaults& faults) override { faults_ = faults; }
  void close_connections() override { listener_->close_connections(); }
  [[nodiscard]] ControlStatistics statistics() const override { return statistics_; }

 protected:
  using Answer = std::function<void(const std::string& text)>;

  /// Begins to serve. The derived class calls it when it is complete.
  void serve();

  // Executes a line; throws Refusal or WireError. Empty: `later` gives the answer.
  virtual std::optional<std::string> execute(const std::string& line, const Answer& later) = 0;
  /// Returns the name of a line's command for ControlFaults.
  [[nodiscard]] virtual std::string command_of(const std::string& line) const = 0;
  [[nodiscard]] virtual std::string refusal_of(const std::string& reason) const = 0;
  /// Processes a datagram. Throws WireError.
  virtual void take_datagram(std::size_t port, std::span<const std::uint8_t> datagram) = 0;

  // Steps of a run. Samples before its beginning wait for the engine to be armed.
  void take_sample(std::size_t vehicle, const TrajectorySample& sample);
  void begin_configuration(fsw::GpsTime start);
  void arm();
  /// Starts at the next edge of the 1PPS, then calls `done`, with the reason of a rejection if it is not empty.
  void start_at_edge(std::function<void(const std::string& refusal)> done);
  void stop_run();
  enum class Stage { kIdle, kConfigured, kArmed, kRunning, kEnded };
  /// Stage of the engine, which may have stopped or restarted by itself.
  [[nodiscard]] Stage stage() const;
  [[nodiscard]] Engine& engine() const { return engine_; }
  /// Time up to which the vehicles have moved: the earliest of those that are behind their last sample; if there is
  /// none, the latest of all.
  [[nodiscard]] fsw::Duration time_into_run() const;

 private:
  Connection::Receive accept();
  void handle(const std::string& line, Connection& connection);
  void drain();
  void follow_engine();

  Engine& engine_;
  std::shared_ptr<Listener> listener_;
  std::vector<std::shared_ptr<DatagramPort>> ports_;
  ControlFaults faults_;
  ControlStatistics statistics_;
  Stage stage_ = Stage::kIdle;
  std::uint64_t run_ = 0;  ///< counts arming and stopping, so that an edge of an earlier run has no effect
  std::vector<std::optional<TrajectorySample>> last_samples_;
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);  ///< expires with this object: the engine keeps callbacks
};

}  // namespace vbar::grand::bench
