#pragma once
// The measurements of a sensor beside the truth: rows of the record, made while the mission flies.

#include <memory>
#include <span>
#include <string>

#include "fsw/core/gps_time.h"
#include "fsw/packets/packet.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

/// Evaluates a sensor: called on events in their order; a class overrides the calls that it needs.
class Evaluation {
 public:
  Evaluation() = default;
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;
  virtual ~Evaluation() = default;

  /// Receives the truth of a measurement of this sensor, if its source is one whose truth is compared.
  virtual void on_measured(const twins::TruthSnapshot& /*truth*/) {}
  /// Receives the bytes that the flight software received, from all sensors, with the step at `time`.
  virtual void on_inputs(fsw::GpsTime /*time*/, std::span<const twins::Packet> /*inputs*/) {}
  /// Receives the answer of the flight software: telemetry and commands.
  virtual void on_answer(fsw::GpsTime /*time*/, std::span<const fsw::packets::PacketView> /*answer*/) {}
  /// Ends the evaluation when the run is over, however it ended.
  virtual void finish() {}
};

struct EvaluationContext {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< carries the sensor and the flight software
  report::RunRecord& record;            ///< outlives the evaluation
};

/// Pairs an evaluation with the source whose truth it receives.
struct NamedEvaluation {
  std::string source;  ///< "servicer/lidar"
  std::unique_ptr<Evaluation> evaluation;
};

}  // namespace vbar::sensors
