#pragma once
// Whether faults took effect and ended, by witnesses that have no part in causing them: packets that the flight
// computer received and sent, and the truth.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/app/run_observer.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"

namespace vbar::faults {

class FaultLog final : public app::RunObserver {
 public:
  /// `servicer` and `target`: names in the truth. All must outlive it.
  FaultLog(const mission::Mission& mission, std::string servicer, std::string target, report::RunRecord& record);

  void on_truth(const twins::TruthSnapshot& truth) override;
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override;
  void on_execution(fsw::GpsTime time, const executed_maneuver& executed) override;

  /// Writes the rows and the figures of the summary.
  void finish();

 private:
  /// What a witness has seen of one fault.
  struct State {
    mission::Fault fault;
    std::optional<double> effect_s, recovered_s;
    int witnessed = 0;
    std::string evidence;
  };
  /// Packets of one kind and unit.
  struct Stream {
    fsw::GpsTime last;
    fsw::Duration interval{0};
  };
  using StreamKey = std::pair<fsw::packets::Apid, std::uint8_t>;

  void witness_effect(State& state, fsw::GpsTime time, const std::string& evidence);
  void witness_recovery(State& state, fsw::GpsTime time);
  void look_at_packets(fsw::GpsTime time, std::span<const pil::Packet> inputs);
  void look_at_silence(State& state, fsw::GpsTime time);
  void look_at_poses(State& state);
  void look_at_images(State& state, fsw::GpsTime time);
  void look_at_attitudes(State& state, fsw::GpsTime time, std::span<const pil::Packet> inputs);
  [[nodiscard]] std::optional<StreamKey> stream_of(const mission::Fault& fault) const;

  const mission::Mission& mission_;
  std::string servicer_;
  std::string target_;
  report::RunRecord& record_;
  std::vector<State> states_;
  std::map<StreamKey, Stream> streams_;
  std::map<std::uint8_t, std::array<std::uint64_t, 2>> image_sums_;  ///< of each camera: the last one and the present
  std::map<std::int32_t, double> commanded_dv_;
  std::optional<twins::SpacecraftTruth> truth_;
  fsw::GpsTime truth_time_;
  std::optional<double> min_distance_m_;  ///< from the first fault on
};

}  // namespace vbar::faults
