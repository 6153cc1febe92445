#pragma once
// A mission file flown from start to end with the flight software in this process, and what a test asks about the
// flight.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/faults/run_observer.h"
#include "host_sim/report/run_record.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::test {

struct FlownMission {
  report::RunRecord record;
  bool complete = false;
  pil::Packet commands;   ///< the bytes of all maneuver commands, one packet after the other
  pil::Packet telemetry;  ///< the bytes of all telemetry
};

/// SHA-256 in hexadecimal digits.
std::string sha256(std::span<const std::uint8_t> bytes);

/// Puts something between the simulation and the flight computer; empty: nothing.
using Wrap = std::function<std::unique_ptr<pil::FlightComputer>(std::unique_ptr<pil::FlightComputer>)>;

/// Flies missions/`file` with `overrides` ("path=value", as on the command line). `observer` watches it; may be null.
FlownMission fly(const std::string& file, const std::vector<std::string>& overrides = {}, const Wrap& wrap = {},
                 app::RunObserver* observer = nullptr);

/// Delta-v (m/s) executed by maneuvers that were commanded for waypoints `first` to `last`.
double dv_commanded_for(const report::RunRecord& record, int first, int last);

/// As above: how many maneuvers.
int maneuvers_commanded_for(const report::RunRecord& record, int first, int last);

/// The row of a waypoint. Fails the test, and gives an empty row, if it was never evaluated.
report::WaypointRow waypoint(const report::RunRecord& record, int index);

}  // namespace vbar::test
