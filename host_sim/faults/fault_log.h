#pragma once
// Whether faults took effect and ended, by observers that have no part in causing them: packets that the flight
// computer received and sent, and the truth.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/faults/fault_observers.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/faults/run_observer.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"

namespace vbar::faults {

class FaultLog final : public app::RunObserver {
 public:
  /// `schedule`: when faults begin, of `mission`. `servicer` and `target`: names in the truth. All must outlive it.
  FaultLog(const mission::Mission& mission, const FaultSchedule& schedule, std::string servicer, std::string target,
           report::RunRecord& record);

  void on_truth(const twins::TruthSnapshot& truth) override;
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override;
  void on_execution(fsw::GpsTime time, const executed_maneuver& executed) override;

  /// Writes the rows and the figures of the summary.
  void finish();

 private:
  /// Observed effects of one fault.
  struct State {
    const mission::Fault& fault;
    std::optional<double> effect_s;
    std::optional<fsw::GpsTime> over;  ///< what it disturbed is right again
    int witnessed = 0;
    std::string evidence;
    std::optional<telemetry_gnss> at_effect;  ///< kCycleSlip: the last telemetry of carrier phase then
  };
  /// Packets of one kind and unit.
  struct Stream {
    fsw::GpsTime last;
    fsw::Duration interval{0};
  };

  void observe_effect(State& state, fsw::GpsTime time, const std::string& evidence);
  void observe_end(State& state, fsw::GpsTime time);
  void look_at_packets(fsw::GpsTime time, std::span<const pil::Packet> inputs);
  void look_at_silence(State& state, fsw::GpsTime time);
  void look_at_poses(State& state);
  void look_for_target(State& state);
  void look_at_images(State& state, fsw::GpsTime time);
  void look_at_attitudes(State& state, fsw::GpsTime time, std::span<const pil::Packet> inputs);
  void look_at_outputs(fsw::GpsTime time, std::span<const pil::Packet> outputs);
  void look_at_receiver(State& state, fsw::GpsTime time);
  void look_for_slip(State& state, const ReceiverEpoch& epoch, fsw::GpsTime time);
  void look_for_reaction(State& state, fsw::GpsTime time);
  void look_at_estimate(fsw::GpsTime time, const telemetry_navigation& estimate);
  [[nodiscard]] std::optional<fsw::GpsTime> first_consistent(fsw::GpsTime from) const;
  [[nodiscard]] std::optional<fsw::GpsTime> recovery_of(const State& state) const;
  [[nodiscard]] report::FaultRow row_of(const State& state) const;

  const mission::Mission& mission_;
  std::string servicer_;
  std::string target_;
  report::RunRecord& record_;
  std::vector<State> states_;
  std::map<StreamKey, Stream> streams_;
  /// Last and present sum of each camera.
  std::map<std::uint8_t, std::array<std::uint64_t, 2>> image_sums_;
  std::map<std::int32_t, double> commanded_dv_;
  std::map<fsw::packets::Apid, ReceiverObserver> receivers_;
  std::map<fsw::packets::Apid, std::vector<ReceiverEpoch>> epochs_;  ///< epochs of the present step
  std::optional<telemetry_gnss> carrier_phase_;                      ///< the last one
  /// Whether the estimate of a step is valid and within its sigmas of the truth.
  struct Consistency {
    fsw::GpsTime time;
    bool is_consistent = false;
  };
  AidWatch aids_;
  std::vector<Consistency> consistency_;
  std::optional<twins::SpacecraftTruth> target_truth_;
  bool looks_at_receivers_ = false;  ///< decoding costs, and most faults are not theirs
  std::optional<twins::SpacecraftTruth> truth_;
  fsw::GpsTime truth_time_;
  std::optional<double> min_distance_m_;  ///< from the first fault on
};

}  // namespace vbar::faults
