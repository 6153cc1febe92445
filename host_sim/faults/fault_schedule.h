#pragma once
// Subject of a fault: packets, and measurement sources of navigation.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/faults/run_observer.h"
#include "host_sim/mission/mission.h"

namespace vbar::faults {

/// Kind and header unit of packets.
using StreamKey = std::pair<fsw::packets::Apid, std::uint8_t>;

/// The packets of the sensor concerned; empty if there is none.
[[nodiscard]] std::optional<StreamKey> stream_of(const mission::Mission& mission, const mission::Fault& fault);

/// The sources of navigation that a fault concerns: a sum of navigation_configuration::kUse.
[[nodiscard]] std::int32_t aids_concerned(const mission::Mission& mission, const mission::Fault& fault);

// Start of each fault of the scenario: at its time, or once its event has happened. Events are those of the truth, the
// thruster and the packets that the flight computer sent; they are the same in every run with the same bits.

class FaultSchedule final : public app::RunObserver {
 public:
  /// `servicer` and `target`: names in the truth.
  FaultSchedule(std::vector<mission::Fault> faults, std::string servicer, std::string target);

  /// Returns the faults in the order of the file. Indices do not change; the `begin` of a fault does when its event
  /// happens.
  [[nodiscard]] const std::vector<mission::Fault>& faults() const { return faults_; }

  /// A burn that was commanded or announced begins; its execution is not known yet.
  void on_ignition(fsw::GpsTime time);

  void on_truth(const twins::TruthSnapshot& truth) override;
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override;

 private:
  /// The event has happened to all faults that await one of this kind and accept it.
  template <class Accept>
  void happen(mission::FaultEvent::Kind kind, fsw::GpsTime time, const Accept& accept);
  [[nodiscard]] bool awaits(mission::FaultEvent::Kind kind) const;

  std::vector<mission::Fault> faults_;
  std::string servicer_;
  std::string target_;
  int burns_ = 0;
};

}  // namespace vbar::faults
