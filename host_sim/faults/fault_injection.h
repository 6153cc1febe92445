#pragma once
// A source whose packets are lost, repeated or wrong while a fault is present. Before its first fault it is
// transparent.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::faults {

class FaultySource final : public twins::PacketSource {
 public:
  /// `name`: of the source, "servicer/camera"; its faults are those of this unit of this spacecraft.
  FaultySource(std::unique_ptr<twins::PacketSource> source, std::shared_ptr<const FaultSchedule> schedule,
               std::string name);

  void start(fsw::GpsTime first_epoch) override { source_->start(first_epoch); }
  void stop(twins::StopReason reason) override { source_->stop(reason); }
  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override {
    return source_->next_epoch(from);
  }
  twins::Measurement measure(const twins::TruthSnapshot& truth) override;
  void command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) override {
    source_->command(packet, effective);
  }
  bool upset(const twins::Upset& upset) override { return source_->upset(upset); }
  [[nodiscard]] twins::TruthDetail truth_detail() const override { return source_->truth_detail(); }
  [[nodiscard]] std::optional<io::WiredReceiver> wired_receiver() const override { return source_->wired_receiver(); }
  [[nodiscard]] bool truth_is_compared() const override { return source_->truth_is_compared(); }
  [[nodiscard]] std::chrono::milliseconds wait_limit() const override { return source_->wait_limit(); }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return source_->statistics(); }

 private:
  /// The truth as this source sees it.
  [[nodiscard]] twins::TruthSnapshot seen(const twins::TruthSnapshot& truth) const;

  /// Applies the faults of the device whose instants have come since the last measurement.
  void upset_device(fsw::GpsTime time);

  /// The tiles of an image, shared with measurements that are pending.
  struct LastImage;

  std::unique_ptr<twins::PacketSource> source_;
  std::shared_ptr<const FaultSchedule> schedule_;
  std::vector<const mission::Fault*> faults_;  ///< faults of the schedule that concern this source
  std::vector<bool> is_upset_;                 ///< by each of them already
  std::shared_ptr<LastImage> last_image_;
};

/// Whether the fault is one of the source of this name.
[[nodiscard]] bool is_of_source(const mission::Fault& fault, std::string_view source);

/// The attitude packet with its attitude turned by `angle` (rad) about the body's x axis; other packets as they are.
[[nodiscard]] twins::Packet with_attitude_error(const twins::Packet& packet, double angle);

/// The tiles of `now` with the pixels of `last`, tile by tile; packets that are no tiles as they are.
[[nodiscard]] std::vector<twins::Packet> with_pixels_of(const std::vector<twins::Packet>& last,
                                                        std::vector<twins::Packet> now);

// A thruster whose burns are too small or too large while a fault is present, or that reports what it did not do.

/// First number of uncommanded impulses; the numbers of flight software stay below.
inline constexpr std::int32_t kFirstUncommanded = 1'000'000'000;

class FaultyThruster final : public twins::Actuator {
 public:
  FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::shared_ptr<FaultSchedule> schedule);

  /// A report that is not to be sent has no packet.
  twins::Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;
  [[nodiscard]] fsw::Duration lead(const vbar::maneuver_command& command) const override {
    return command.maneuver_id < kFirstUncommanded ? thruster_->lead(command) : fsw::Duration{};
  }

 private:
  std::unique_ptr<twins::Actuator> thruster_;
  std::shared_ptr<FaultSchedule> schedule_;
};

/// An impulse of a thruster that is stuck open.
struct UncommandedImpulse {
  fsw::GpsTime time;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
  std::int32_t id = 0;
};

/// Impulses of thrusters that are stuck open: one each second of such a fault, from its middle.
class UncommandedImpulses {
 public:
  explicit UncommandedImpulses(std::shared_ptr<const FaultSchedule> schedule);

  /// Returns the impulses of faults whose beginning has become known since the last call.
  [[nodiscard]] std::vector<UncommandedImpulse> take();

 private:
  std::shared_ptr<const FaultSchedule> schedule_;
  std::vector<bool> is_taken_;  ///< for each fault
  std::int32_t next_id_ = kFirstUncommanded;
};

// Knowledge of the ground when a flight computer has lost its state: what its telemetry reported last. The relative
// orbit takes the place of the a-priori orbit among the telecommands of the start, which may be older than a day, and a
// retreat that was in force is commanded in place of the mode of the start.

/// Oldest relative orbit that is sent, as mean ROE are valid for ten minutes in the flight software.
inline constexpr fsw::Duration kOldestReport = fsw::duration_of_seconds(540);

class ReportedState {
 public:
  /// Packets from the flight software; the last mode and the last valid estimate are kept.
  void take(std::span<const pil::Packet> packets);

  /// The telecommands, with the mode of a retreat that was reported last, and with a target_apriori that states the
  /// relative orbit reported last if that is not older than kOldestReport at `now`. None is added.
  [[nodiscard]] std::vector<pil::Packet> applied_to(std::vector<pil::Packet> telecommands, fsw::GpsTime now) const;

 private:
  struct Report {
    fsw::GpsTime time;
    vbar::telemetry_navigation navigation;
  };
  std::optional<Report> last_;
  bool is_retreating_ = false;
};

/// Mean ROE times a with 1 sigma, of a reported estimate; nothing if the servicer's state is not an orbit. Telemetry
/// has the sigmas of position and velocity without their correlation: those of the ROE are their linear map with the
/// magnitudes of all terms added, an upper bound.
[[nodiscard]] std::optional<vbar::target_apriori> apriori_of(const vbar::telemetry_navigation& reported);

// A flight computer that fails for a time: its packets are lost, and it takes no steps. Afterwards it continues, or
// it is re-initialised, with or without the snapshot of its last step.

class FaultyComputer final : public pil::FlightComputer {
 public:
  using Start = std::function<std::unique_ptr<pil::FlightComputer>()>;

  /// `computer` must outlive it. `start` makes another one in its place; `telecommands` are sent to that one before
  /// its first step, as the ground would when the computer asks for its configuration, with the relative orbit that
  /// its telemetry reported last.
  FaultyComputer(pil::FlightComputer& computer, std::shared_ptr<const FaultSchedule> schedule, Start start,
                 std::vector<pil::Packet> telecommands);

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> packets) override;
  [[nodiscard]] pil::LinkStatistics statistics() const override { return present().statistics(); }
  [[nodiscard]] std::string description() const override { return present().description(); }
  void close() override { present().close(); }

 private:
  pil::StepResult step_of(pil::FlightComputer& computer, std::uint32_t step, std::span<const pil::Packet> packets);
  [[nodiscard]] pil::FlightComputer& present() const { return restarted_ ? *restarted_ : computer_; }

  pil::FlightComputer& computer_;
  std::shared_ptr<const FaultSchedule> schedule_;
  Start start_;
  std::vector<pil::Packet> telecommands_;
  ReportedState reported_;
  std::unique_ptr<pil::FlightComputer> restarted_;
  bool must_restart_ = false;
  std::vector<std::uint8_t> snapshot_;  ///< snapshot of the step before a reboot that keeps the state
};

/// Whether the faults contain one of the flight computer.
[[nodiscard]] bool concern_computer(const std::vector<mission::Fault>& faults);

}  // namespace vbar::faults
