#pragma once
// A control server with an engine that flies every sample at once, in a thread of its own, and the driver's end in the
// thread of the test.

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <gtest/gtest.h>

#include "emulators/grand/control/control_servers.h"
#include "hil_drivers/grand/generators/generator.h"

namespace vbar::grand::test {

inline constexpr fsw::GpsTime kStart{fsw::kNanosecondsPerSecond * 995'126'400};  ///< 2011-07-19 16:00:00
inline constexpr fsw::Duration kTenth{100'000'000};
inline fsw::Duration tenths(std::int64_t n) {
  return {n * kTenth.ns};
}

/// A sample at this time whose numbers are all different.
TrajectorySample sample_at(fsw::Duration time, double first = 1.0);
bool is_same(const TrajectorySample& a, const TrajectorySample& b);

/// Records what the server calls; each sample is flown at once, at most up to `limit`.
class FakeEngine final : public bench::Engine {
 public:
  explicit FakeEngine(std::size_t count) : samples(count), reports(count) {}

  [[nodiscard]] std::size_t vehicles() const override { return samples.size(); }
  [[nodiscard]] bench::EngineState state() const override { return stage; }
  [[nodiscard]] std::string error() const override { return error_text; }
  void reset() override {
    calls += "reset ";
    stage = bench::EngineState::kIdle;
  }
  std::string set_start_time(fsw::GpsTime time) override {
    start_time = time;
    return refusal;
  }
  std::string set_join(fsw::Duration time) override {
    join = time;
    return {};
  }
  std::string arm() override {
    calls += "arm ";
    stage = bench::EngineState::kArmed;
    return {};
  }
  std::string start(fsw::Duration after) override {
    calls += "start ";
    delay = after;
    stage = bench::EngineState::kStreaming;
    return {};
  }
  void stop() override {
    calls += "stop ";
    stage = bench::EngineState::kStopped;
  }
  void sample(std::size_t vehicle, const TrajectorySample& sample) override;
  [[nodiscard]] bench::VehicleReport report(std::size_t vehicle) const override { return reports[vehicle]; }
  /// The last sample, moved along its velocity.
  [[nodiscard]] TrajectorySample flown(std::size_t vehicle, fsw::Duration time) const override {
    if (samples[vehicle].empty()) return {};
    TrajectorySample sample = samples[vehicle].back();
    sample.position_ecef_m += fsw::seconds({time.ns - sample.time.ns}) * sample.velocity_ecef_mps;
    return sample;
  }
  [[nodiscard]] std::int64_t system_time_at_pps0_ms() const override { return pps0_ms; }

  bench::EngineState stage = bench::EngineState::kIdle;
  std::string calls, error_text, refusal;
  fsw::GpsTime start_time;
  fsw::Duration join, delay;
  std::int64_t pps0_ms = 0;
  int ignored_samples = 0;  ///< number of samples that are lost before one is flown
  std::vector<std::vector<TrajectorySample>> samples;
  std::vector<bench::VehicleReport> reports;
};

class Loopback {
 public:
  explicit Loopback(const bench::ControlSettings& settings, std::size_t vehicles = 2);
  ~Loopback();
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  /// Calls `use` in the thread of the server and waits for it.
  void in_server(const std::function<void(FakeEngine&, bench::ControlServers&)>& use);
  void set_faults(const bench::ControlFaults& faults);
  bench::ControlStatistics statistics();

  [[nodiscard]] const std::vector<std::uint16_t>& control_ports() const { return control_ports_; }
  [[nodiscard]] const std::vector<std::uint16_t>& hil_ports() const { return hil_ports_; }
  [[nodiscard]] GeneratorPlan plan(Pace pace = Pace::kLockStep) const;
  /// The driver's end; `table` is the text of its settings.
  [[nodiscard]] std::unique_ptr<Generator> generator(const std::string& kind, const std::string& table = "",
                                                     Pace pace = Pace::kLockStep) const;

 private:
  void fire_edges();

  boost::asio::io_context context_;
  FakeEngine engine_;
  std::unique_ptr<bench::ControlServers> servers_;
  boost::asio::steady_timer edges_;
  std::vector<std::uint16_t> control_ports_, hil_ports_;
  std::thread thread_;
};

/// Prepares and starts with samples at time 0.
void prepare(Generator& generator, std::size_t vehicles = 2);

/// The message of the std::runtime_error that `use` throws; "" if it throws none.
std::string error_of(const std::function<void()>& use);

inline std::chrono::steady_clock::time_point soon(double s = 2.0) {
  return std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace vbar::grand::test
