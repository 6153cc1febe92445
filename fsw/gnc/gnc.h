#pragma once
// The flight software: packets in, a step, packets out. One object is its complete state; a snapshot contains the part
// that outlives a step.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/fdir/burn_monitor.h"
#include "fsw/fdir/image_watch.h"
#include "fsw/fdir/safety_monitor_inputs.h"
#include "fsw/fdir/step_clock.h"
#include "fsw/guidance/drift_assessment.h"
#include "fsw/guidance/guidance.h"
#include "fsw/guidance/management.h"
#include "fsw/guidance/retreat_sequence.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/outbox.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/navigation/measurement_scheduler.h"
#include "fsw/navigation/navigation.h"

namespace vbar::fsw::gnc {

/// Holds the state that one step leaves for the next one. A snapshot contains it, and the counters of inbox and outbox.
struct GncState {
  messaging::Telecommands telecommands_;
  guidance::Management management_;
  navigation::MeasurementScheduler measurements_;
  navigation::NavigationSolution navigation_;
  guidance::Guidance guidance_;
  guidance::RetreatSequence retreat_;
  guidance::Assessment assessment_;
  fdir::BurnMonitor burns_;
  fdir::SafetyMonitor safety_monitor_;
  fdir::ImageWatch images_;
  std::optional<vbar::attitude> attitude_;  ///< the last one received, for the safety monitor
  std::optional<GpsTime> unsafe_since_;     ///< time since which no plan leaves an unsafe drift
  std::optional<GpsTime> assessed_since_;   ///< time of the first assessment of the drift
  std::optional<GpsTime> cautious_since_;   ///< after a restart: time since which navigation has been valid
  GpsTime now_;
  GpsTime started_;  ///< time of the first step
  std::int64_t step_ = 0;
  faults::FaultMonitor faults_;
  std::int32_t packets_dropped_ = 0;  ///< packets dropped by the inbox until the last step
  int failures_ = 0;                  ///< failures of the relative navigation filter until the last step
  Duration promised_period_;          ///< time from the last step to this one, as its tick stated; 0 unknown
  bool stepped_ = false;
  bool has_navigated_ = false;  ///< navigation was valid since the first step
  bool has_settled_ = false;    ///< the drift has been known well enough to judge its probability of collision
  bool is_cautious_ = false;    ///< the mode was commanded long before the first step: what happened since is lost
};

class Gnc : private GncState {
 public:
  Gnc(std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context);

  void set_sink(vbar_packet_sink sink, void* sink_context) { outbox_.set_sink(sink, sink_context); }

  /// Implements vbar_gnc_authenticate and vbar_gnc_telecommand_sequence of the interface in C.
  void authenticate(const packets::TelecommandSecurity& security) { inbox_.authenticate(security); }
  [[nodiscard]] std::uint64_t telecommand_sequence() const { return inbox_.authentication().sequence(); }

  /// Checks one packet and keeps it for the coming step.
  Status receive(std::span<const std::uint8_t> packet) { return inbox_.receive(packet); }

  /// Runs the step at `now`. If the step clock rejects `now` (step_clock.h), the packets of the step are discarded and
  /// only its health is sent: kBadSequence if `now` is not later than the last step, kOutOfRange if it is far ahead or
  /// outside the range of times. After a telecommand that clears the fault of the clock, the next time is accepted.
  Status step(GpsTime now);

  /// Implements vbar_gnc_save and vbar_gnc_restore of the interface in C.
  Status save(std::span<std::uint8_t> snapshot) const;
  Status restore(std::span<const std::uint8_t> snapshot);
  static const std::size_t kSnapshotBytes;

 private:
  // The phases of a step, in this order.

  /// Restores an estimate that was changed since the last step, or restarts.
  void verify_state(GpsTime now);
  void begin_step(GpsTime now);
  void manage();
  void navigate();
  void assess();
  /// Runs the safety monitor, which judges the approach beside navigation.
  void supervise();
  /// Derives the responses to faults: the retreat.
  void respond();
  void proceed_with_caution(const safety_configuration& safety, bool is_demanded);
  void control();
  /// Acts: sends every command of the step, and notes it where its effect is expected.
  void command();
  /// Sends the telemetry of the step; the state stays as it is.
  void report(messaging::Outbox& outbox) const;
  void end_step();

  // Fault checks of the phases (fault_checks.cpp).
  void check_state(GpsTime now, navigation::Integrity integrity);
  void check_step_period(Duration gap);
  void check_inbox();
  void check_navigation();
  void check_drift(const safety_configuration& safety);
  [[nodiscard]] bool is_drift_known(const safety_configuration& safety);
  void check_retreat();
  void check_hold();

  // Commands (commands.cpp).
  void command_maneuvers();
  void point_camera();
  void command_exposures();
  /// Returns what is commanded for an impulse that is wanted, with the thruster as its burns have shown it.
  [[nodiscard]] Vector3 command_for(const Vector3& dv_rtn) const;
  [[nodiscard]] std::optional<measurements::Pointing> pointing_to_target() const;

  // Telemetry (telemetry.cpp).
  void report_navigation(messaging::Outbox& outbox) const;
  void report_control(messaging::Outbox& outbox) const;
  void report_safety(messaging::Outbox& outbox) const;
  void report_health(messaging::Outbox& outbox) const;
  void report_events(messaging::Outbox& outbox) const;

  // Snapshots and the acceptance of steps (restart.cpp).
  [[nodiscard]] bool accepts(GpsTime now);
  void refuse(GpsTime now);
  void restart(GpsTime now);
  void resume(GpsTime now);

  alignas(
      GncState) messaging::Inbox inbox_;  // aligned, to lie behind the padding of the state, which a snapshot contains
  messaging::Outbox outbox_;
  fdir::StepClock clock_;
  Status restored_ = Status::kOk;  ///< status of the restored snapshot, until the step after it
  bool is_restored_ = false;       ///< a snapshot was restored since the last step
};

}  // namespace vbar::fsw::gnc
