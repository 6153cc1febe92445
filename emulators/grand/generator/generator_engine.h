#pragma once
// Emulated generator: vehicles are moved along the samples received, in lock-step or in real time.
//
// Lock-step: the arrival of a sample moves its vehicle exactly to the newest sample's time; nothing else advances it,
// and no clock is read. Real time: generator time t, which is that of the radio, is the host's CLOCK_MONOTONIC t after
// the start, and the motion has been computed in advance of it by the engine's latency: a sample takes effect from
// there on. With a speed factor, for tests of the emulator itself, all times of the generator and its receivers pass
// faster, edges, latencies and bytes alike.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "emulators/grand/control/control_servers.h"
#include "emulators/grand/generator/scenario.h"
#include "emulators/grand/generator/vehicle.h"
#include "hil_drivers/grand/wire/pps_datagram.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

class GeneratorEngine final : public Engine {
 public:
  /// Makes receivers and lines and switches the receivers on. Throws std::runtime_error, std::invalid_argument.
  GeneratorEngine(boost::asio::io_context& context, const Scenario& scenario,
                  const std::filesystem::path& data_directory, const std::filesystem::path& directory,
                  const ReceiverFactory& make_receiver);

  // Interface of the control servers.
  [[nodiscard]] std::size_t vehicles() const override { return vehicles_.size(); }
  [[nodiscard]] EngineState state() const override { return state_; }
  [[nodiscard]] std::string error() const override { return error_; }
  void reset() override;
  std::string set_start_time(fsw::GpsTime time) override;
  std::string set_join(fsw::Duration join) override;
  std::string arm() override;
  std::string start(fsw::Duration delay) override;
  void stop() override;
  void sample(std::size_t vehicle, const TrajectorySample& sample) override;
  [[nodiscard]] VehicleReport report(std::size_t vehicle) const override;
  [[nodiscard]] TrajectorySample flown(std::size_t vehicle, fsw::Duration time) const override;
  [[nodiscard]] std::int64_t system_time_at_pps0_ms() const override { return system_time_at_pps0_ms_; }

  // Interface of the program and the faults.
  [[nodiscard]] Vehicle& vehicle(std::size_t index) { return *vehicles_[index]; }
  [[nodiscard]] bool is_lock_step() const { return scenario_.pace == Pace::kLockStep; }
  /// Time up to which every vehicle has moved; empty if the generator does not run.
  [[nodiscard]] std::optional<fsw::Duration> time() const;
  [[nodiscard]] std::optional<fsw::Duration> time_of(std::size_t vehicle) const;
  [[nodiscard]] std::uint32_t edges_sent() const { return edges_sent_; }
  /// Ends the radiation with an error that the protocols report.
  void fail(std::string error);
  /// Fault of samples, from the next sample of the vehicle on.
  enum class SampleFault { kLost, kDoubled, kSwapped };
  void damage_samples(std::size_t vehicle, SampleFault fault, std::uint64_t count);
  /// Number of the vehicle's samples damaged so far.
  [[nodiscard]] std::uint64_t damaged_samples(std::size_t vehicle) const { return sample_faults_[vehicle].damaged; }

  std::function<void(const wire::PpsDatagram&)> on_edge;  ///< at each generator second
  std::function<void()> on_advance;  ///< after each 100 ms of any vehicle, and at each tick in real time

 private:
  using Clock = std::chrono::steady_clock;

  struct SampleFaults {
    SampleFault kind = SampleFault::kLost;
    std::uint64_t remaining = 0, damaged = 0;
    std::optional<TrajectorySample> held;
  };

  void receive(std::size_t vehicle, const TrajectorySample& sample);
  void fly(std::size_t vehicle, fsw::Duration time);
  void report_extrapolation(std::size_t vehicle);
  void send_edges();
  void send_edge(std::uint32_t count, std::int64_t monotonic_ns);
  void end(EngineState state);
  void wait_for_tick();
  void tick(Clock::time_point now);
  void free_running_edge(Clock::time_point edge);
  // Scaled real time.
  [[nodiscard]] std::chrono::nanoseconds on_the_wall(fsw::Duration span) const;
  [[nodiscard]] fsw::Duration of_the_generator(Clock::duration span) const;

  Scenario scenario_;
  std::filesystem::path data_directory_;
  std::shared_ptr<twins::gnss::Constellation> constellation_;
  twins::gnss::AntennaPattern pattern_;
  std::vector<std::unique_ptr<Vehicle>> vehicles_;
  std::vector<bool> warned_;  ///< for each vehicle: a warning of missing samples was given
  std::vector<SampleFaults> sample_faults_;

  EngineState state_ = EngineState::kIdle;
  std::string error_;
  fsw::Duration join_;
  std::optional<fsw::GpsTime> start_time_;
  std::uint32_t edges_sent_ = 0;
  engine::RandomStream edge_jitter_;

  // Real time.
  boost::asio::steady_timer timer_;
  Clock::time_point origin_;     ///< edges run freely from here on until the start
  Clock::time_point last_edge_;  ///< last of those edges
  Clock::time_point last_tick_;
  Clock::time_point zero_;  ///< generator time 0
  std::int64_t system_time_at_pps0_ms_ = 0;
};

}  // namespace vbar::grand::bench
