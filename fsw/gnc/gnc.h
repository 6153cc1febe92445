#pragma once
// The flight software: packets in, a step, packets out. Its complete state is this one object.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/assessment.h"
#include "fsw/gnc/burn_monitor.h"
#include "fsw/gnc/guard_feed.h"
#include "fsw/gnc/guidance.h"
#include "fsw/gnc/image_watch.h"
#include "fsw/gnc/inbox.h"
#include "fsw/gnc/management.h"
#include "fsw/gnc/navigation.h"
#include "fsw/gnc/outbox.h"
#include "fsw/gnc/retreat_sequence.h"
#include "fsw/gnc/telecommands.h"
#include "fsw/gnc/tick_gate.h"

namespace vbar::fsw::gnc {

class Gnc {
 public:
  Gnc(std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context);

  void set_sink(vbar_packet_sink sink, void* sink_context) { outbox_.set_sink(sink, sink_context); }

  /// Checks and files one packet for the coming step.
  Status receive(std::span<const std::uint8_t> packet) { return inbox_.receive(packet); }

  /// Runs the step at `now`. Only discards the packets of the step, and reports its health, if `now` is not later than
  /// the last step (kBadSequence), too far ahead of it or outside the clock's range (kOutOfRange): tick_gate.h.
  Status step(GpsTime now);

 private:
  Status refuse(GpsTime now, TickGate::Verdict verdict);
  void manage();
  void navigate();
  void assess();
  void supervise();
  void respond();
  void control();
  void report();

  /// What is commanded for an impulse that is wanted, with the thruster as its burns have shown it.
  [[nodiscard]] Vector3 command_for(const Vector3& dv_rtn) const;

  void report_navigation();
  void point_camera();
  void command_exposures();
  [[nodiscard]] std::optional<sources::Pointing> pointing_to_target() const;
  void report_control();
  void report_safety();
  void report_health();
  void report_events();

  Inbox inbox_;
  Outbox outbox_;
  Telecommands telecommands_;
  Management management_;
  Navigation navigation_;
  Guidance guidance_;
  RetreatSequence retreat_;
  Assessment assessment_;
  BurnMonitor burns_;
  guard::Guard guard_;
  ImageWatch images_;
  std::optional<vbar::attitude> attitude_;  ///< the last one received, for the guard
  GpsTime now_;
  GpsTime started_;   ///< first step
  GpsTime expected_;  ///< time of the next step
  TickGate ticks_;
  std::int64_t step_ = 0;
  faults::FaultMonitor faults_;
  std::int32_t packets_dropped_ = 0;  ///< of the inbox, until the last step
  bool stepped_ = false;
  bool has_navigated_ = false;  ///< since the first step
};

}  // namespace vbar::fsw::gnc
