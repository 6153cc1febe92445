#pragma once
// [testbed.grand]: the GNSS testbed of a mission.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/common/testbed_use.h"
#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/pps/time_base.h"
#include "hil_drivers/grand/receiver_link.h"
#include "hil_drivers/grand/trajectory/antenna_trajectory.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/sensors/testbed.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

/// Value of testbed.grand.pps that means the socket named by the emulator.
inline constexpr const char* kEdgesOfBench = "socket";

struct GrandSettings : mission::TestbedSettings {
  const GeneratorKind* generator = nullptr;
  std::shared_ptr<const GeneratorSettings> generator_settings;
  std::string host = "127.0.0.1";
  std::uint16_t control_port =
      0;  ///< port of the generator, or of its first instance, the next follow; 0: as the bench says
  std::uint16_t hil_port = 0;  ///< 0: as the generator states
  fsw::Duration sample_period;
  fsw::Duration lead;  ///< a sample's own time before its sending; real time only
  fsw::Duration join;
  Pace pace = Pace::kLockStep;
  std::string pps;        ///< "none", a source of edges (pps/edge_source.h), or kEdgesOfBench
  std::string bench;      ///< command line of the emulator; empty: hardware, or an emulator that runs already
  fsw::Duration give_up;  ///< duration of a receiver's loss after which the run ends
  bool week_shift = false;
  testbeds::OnFailure on_failure = testbeds::OnFailure::kStop;
  std::string chrony;  ///< socket of chronyd's refclock SOCK, to which edges are forwarded; empty: none
};

/// Reads the table. Throws MissionError.
std::shared_ptr<const mission::TestbedSettings> read_grand(const mission::TableReader& section);

// Addresses of an emulator or a testbed: addresses.json, which it writes once it listens.

struct TestbedAddresses {
  std::vector<std::uint16_t> control_ports;
  std::string pps;  ///< path of its socket of edges; may be empty
  // Devices by spacecraft: the tty of the command port, and of the second one, to which the board is connected.
  std::map<std::string, std::string> receivers, board_lines;
};

/// Reads the file. Throws std::runtime_error that names it.
[[nodiscard]] TestbedAddresses read_addresses(const std::filesystem::path& file);

// Times at which the samples of the trajectory are sent: their lead on the generator's time, late and missing ones.

class SampleTimes {
 public:
  explicit SampleTimes(fsw::Duration period) : period_(period) {}

  struct Second {
    std::int64_t samples = 0, late = 0, missing = 0;
    std::optional<double> lead_min_ms;
    double lead_sum_ms = 0.0;
  };

  /// Records a sample for `time` that follows one for `before` (below zero: none). `lead` is its own time before the
  /// generator's; empty in lock-step.
  void add(fsw::Duration time, fsw::Duration before, std::optional<fsw::Duration> lead) {
    ++second_.samples;
    if (before.ns >= 0) second_.missing += std::max<std::int64_t>(0, (time.ns - before.ns) / period_.ns - 1);
    if (!lead) return;
    const double lead_ms = 1e3 * fsw::seconds(*lead);
    if (lead_ms < 0.0) ++second_.late;
    second_.lead_min_ms = std::min(second_.lead_min_ms.value_or(lead_ms), lead_ms);
    second_.lead_sum_ms += lead_ms;
  }

  /// Returns the figures since the last call of this function.
  [[nodiscard]] Second take() { return std::exchange(second_, {}); }

 private:
  fsw::Duration period_;
  Second second_;
};

// Spacecraft in the testbed: the trajectory of its antenna and its receiver.

struct Vehicle {
  explicit Vehicle(testbeds::ReceiverPlan of) : plan(std::move(of)) {}

  testbeds::ReceiverPlan plan;
  // Members that exist from the start of the testbed on.
  std::optional<AntennaTrajectory> trajectory;
  std::unique_ptr<ReceiverLink> link;
  fsw::Duration last_sample{-1};  ///< time of the last sample sent, since the start
  GeneratorState state{};
  std::unique_ptr<twins::gnss::ReceiverBytes> twin;  ///< once it has taken over
};

// GNSS testbed during one run: one RF generator and the receivers of both spacecraft, shared by their sources.

class GrandRun final : public testbeds::TestbedRun, public std::enable_shared_from_this<GrandRun> {
 public:
  GrandRun(const GrandSettings& settings, const testbeds::RunContext& context);
  ~GrandRun() override;

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
  [[nodiscard]] twins::gnss::ReceiverOutput exchange_by_testbed(std::size_t vehicle,
                                                                const twins::gnss::BodyTruth& truth);
  [[nodiscard]] std::runtime_error error_of(const std::string& reason);
  void hand_over(fsw::GpsTime time, const std::string& reason);
  /// Returns the epochs of the vehicle's twin, which has those of the period in the calls of the testbed.
  [[nodiscard]] twins::gnss::ReceiverOutput output_of_twin(Vehicle& vehicle, const twins::gnss::BodyTruth& truth) const;

  GrandSettings settings_;
  testbeds::RunContext context_;
  fsw::GpsTime start_;
  bool is_started_ = false, is_stopped_ = false;
  std::optional<testbeds::EmulatorProcess> process_;
  TestbedAddresses addresses_;  ///< addresses written by the process, if there is one
  std::vector<Vehicle> vehicles_;
  std::unique_ptr<Generator> generator_;
  std::optional<TimeBase> time_base_;  ///< real time only
  SampleTimes sample_times_;
  testbeds::TestbedUse use_;
  report::RunRecord* record_ = nullptr;
};

// Receiver of the testbed as the sensor of its spacecraft calls it: a trajectory sample is sent, bytes are returned.

class GrandRun;

class GrandSource final : public twins::gnss::ReceiverBytes {
 public:
  GrandSource(std::shared_ptr<GrandRun> bench, std::size_t vehicle);

  void start(fsw::GpsTime first_epoch) override;
  void stop(twins::StopReason reason) override;
  [[nodiscard]] twins::TruthDetail truth_detail() const override { return twins::TruthDetail::kAccelerations; }
  [[nodiscard]] std::optional<fsw::Duration> call_period() const override;
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const override;
  twins::gnss::ReceiverOutput output_at(const twins::gnss::BodyTruth& truth) override;

 private:
  std::shared_ptr<GrandRun> bench_;
  std::size_t vehicle_;
};

// [testbed.grand]: the GNSS testbed, registered in ../testbeds.cpp.

extern const testbeds::TestbedKind kGrand;

}  // namespace vbar::grand
