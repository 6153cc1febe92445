#pragma once
// Turns what happens in a run into the rows of its record: truth, what the flight software said, maneuvers, waypoints
// met.

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/app/gallery_keeper.h"
#include "host_sim/app/pose_gallery.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/truth/attitude/attitude_state.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

/// True states of the pair that flies.
struct PairTruth {
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
};

/// True attitude of a spacecraft that has one.
struct NamedAttitude {
  std::string spacecraft;
  truth::AttitudeState attitude;
};

class FlightRecorder {
 public:
  /// `servicer`: the spacecraft of the mission whose flight software speaks.
  FlightRecorder(const mission::Mission& mission, const mission::Spacecraft& servicer, report::RunRecord& record);

  /// Truth when a sensor measured: what an image showed is told steps later. The last few are kept.
  void on_measured(const twins::TruthSnapshot& truth);

  /// Truth at the time of a flight step.
  void on_truth(fsw::GpsTime time, const PairTruth& truth);

  /// Attitudes at the time of a flight step.
  void on_attitudes(fsw::GpsTime time, const std::vector<NamedAttitude>& attitudes);

  /// Truth at the time of a waypoint, before any burn of that instant.
  void on_waypoint(const mission::Waypoint& waypoint, const PairTruth& truth);

  /// What the flight software got with the step at `time`, before its answer.
  void on_inputs(fsw::GpsTime time, std::span<const pil::Packet> inputs) {
    gallery_.on_inputs(time, inputs);
    pose_gallery_.on_inputs(time, inputs);
  }

  /// The flight software's answer to a step: its telemetry becomes a row, its commands maneuvers yet to be executed.
  void on_answer(fsw::GpsTime time, const pil::StepResult& answer);

  /// A burn of the mission file is about to happen.
  void on_prescribed(fsw::GpsTime time, const maneuver_command& command);

  /// What became of a command.
  void on_execution(fsw::GpsTime time, const executed_maneuver& executed);

  /// Completes what can only be known at the end: the gallery.
  void finish();

 private:
  [[nodiscard]] double mission_seconds(fsw::GpsTime time) const { return fsw::seconds(time - mission_.epoch); }
  /// What a step said of an image, in two packets.
  struct ImageTelemetry {
    fsw::GpsTime exposure;
    std::optional<telemetry_image> image;
    std::optional<telemetry_objects> objects;
    std::optional<telemetry_pose> pose;
  };

  void on_any_telemetry(double step_time_s, const fsw::packets::PacketView& packet);
  void on_telemetry(report::EstimateRow& row, ImageTelemetry& told, const fsw::packets::PacketView& packet);
  void on_image(const report::EstimateRow& step, const ImageTelemetry& told);
  void on_pose(const report::EstimateRow& step, const ImageTelemetry& told);
  void on_command(fsw::GpsTime step_time, const fsw::packets::PacketView& packet);
  void add_maneuver(fsw::GpsTime command_time, fsw::GpsTime burn_time, const maneuver_command& command);

  const mission::Mission& mission_;
  const mission::Spacecraft& servicer_;
  std::deque<twins::TruthSnapshot> measured_;       ///< oldest first
  std::optional<pose_configuration> known_target_;  ///< as telecommanded, with navigation by the pose network
  report::RunRecord& record_;
  GalleryKeeper gallery_;
  PoseGallery pose_gallery_;
};

}  // namespace vbar::app
