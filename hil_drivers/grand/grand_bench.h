#pragma once
// GNSS testbed during one run: one RF generator and the receivers of both spacecraft, shared by their sources.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/grand/addresses.h"
#include "hil_drivers/grand/sample_times.h"
#include "hil_drivers/grand/settings.h"
#include "hil_drivers/grand/time_base.h"
#include "hil_drivers/grand/vehicle.h"
#include "hil_drivers/testbed.h"

namespace vbar::grand {

class GrandBench final : public testbeds::TestbedRun, public std::enable_shared_from_this<GrandBench> {
 public:
  GrandBench(const GrandSettings& settings, const testbeds::RunContext& context);
  ~GrandBench() override;

  [[nodiscard]] std::unique_ptr<twins::gnss::ReceiverBytes> make_receiver(const testbeds::ReceiverPlan& plan) override;
  void begin(report::RunRecord& record, const std::filesystem::path& folder) override;
  [[nodiscard]] engine::WallClock* clock() override;
  void finish() noexcept override;

  // Calls of the sources. The first that is started starts the testbed, the first that is stopped stops it.
  void start(fsw::GpsTime first_epoch);
  void stop() noexcept;
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver(std::size_t vehicle) const;
  [[nodiscard]] fsw::Duration sample_period() const { return settings_.sample_period; }
  /// Sends the sample of the vehicle and returns the bytes that its receiver has sent. Throws std::runtime_error, one
  /// sentence, if the run must end.
  twins::gnss::ReceiverOutput exchange(std::size_t vehicle, const twins::gnss::BodyTruth& truth);

 private:
  void start_vehicles(fsw::GpsTime first_epoch);
  void start_generator();
  [[nodiscard]] std::vector<std::uint16_t> control_ports() const;
  [[nodiscard]] std::string device_of(const testbeds::ReceiverPlan& plan) const;
  [[nodiscard]] LinkPlan link_plan(const testbeds::ReceiverPlan& plan, const twins::gnss::BodyTruth& truth) const;
  [[nodiscard]] twins::gnss::BodyTruth truth_at(const std::string& spacecraft, fsw::GpsTime time) const;
  [[nodiscard]] fsw::Duration log_offset(const testbeds::ReceiverPlan& plan) const;
  void send_sample(std::size_t vehicle, const twins::gnss::BodyTruth& truth);
  void wait_for_generator(std::size_t vehicle, fsw::Duration time);
  [[nodiscard]] std::string edge_source() const;
  void end_second(fsw::GpsTime now);
  void poll_states();
  [[noreturn]] void fail(const std::string& reason);

  GrandSettings settings_;
  testbeds::RunContext context_;
  fsw::GpsTime start_;
  bool is_started_ = false, is_stopped_ = false;
  std::optional<bench_process::BenchProcess> process_;
  BenchAddresses addresses_;  ///< addresses written by the process, if there is one
  std::vector<Vehicle> vehicles_;
  std::unique_ptr<Generator> generator_;
  std::optional<TimeBase> time_base_;  ///< real time only
  SampleTimes sample_times_;
  report::RunRecord* record_ = nullptr;
};

}  // namespace vbar::grand
