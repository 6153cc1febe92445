#pragma once
// Interface of an observer of a run: the log, the record, the hashes, a live view.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

/// Is called for each event in the order of time; an observer overrides the functions of the events that it needs.
class RunObserver {
 public:
  RunObserver() = default;
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;
  virtual ~RunObserver() = default;

  /// The truth of a measurement of a source that is evaluated (PacketSource::truth_is_compared).
  virtual void on_measured(std::string_view /*source*/, const twins::TruthSnapshot& /*truth*/) {}
  /// Data from which packets that are still to come can be made again (twins::Measurement::recipe).
  virtual void on_recipe(fsw::GpsTime /*time*/, const twins::LoggedImage& /*recipe*/) {}
  /// An image that cannot be made again (twins::Measurement::recording), before its packets are passed on. An exception
  /// ends the run.
  virtual void on_recording(fsw::GpsTime /*time*/, const twins::LoggedImage& /*recording*/) {}
  /// A source or an actuator has added a note to a measurement or a burn.
  virtual void on_note(fsw::GpsTime /*time*/, std::string_view /*source*/, const twins::Note& /*note*/) {}
  /// A source failed an epoch, in one sentence.
  virtual void on_failure(fsw::GpsTime /*time*/, std::string_view /*source*/, std::string_view /*reason*/) {}

  /// The time of a waypoint (an index of the timetable), before any burn of that instant.
  virtual void on_waypoint(std::size_t /*waypoint*/, const twins::TruthSnapshot& /*truth*/) {}

  /// A flight step begins.
  virtual void on_truth(const twins::TruthSnapshot& /*truth*/) {}
  /// A flight step has ended: `inputs` are all its packets, those of a wired receiver included and the tick last;
  /// `outputs` are the packets of the answer.
  virtual void on_step(std::uint32_t /*step*/, fsw::GpsTime /*time*/, std::span<const pil::Packet> /*inputs*/,
                       std::span<const pil::Packet> /*outputs*/) {}
  /// The answer of the step, with its cost.
  virtual void on_answer(fsw::GpsTime /*time*/, const pil::StepResult& /*answer*/) {}

  /// A burn of the timetable is about to happen.
  virtual void on_prescribed(fsw::GpsTime /*time*/, const maneuver_command& /*command*/) {}
  /// A burn has been executed or rejected.
  virtual void on_execution(fsw::GpsTime /*time*/, const executed_maneuver& /*executed*/) {}
};

}  // namespace vbar::app
