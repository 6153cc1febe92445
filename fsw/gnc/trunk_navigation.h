#pragma once
// Navigation of one trunk (fsw/trunk) and a list of sources.
//
// Sources turn packets into records, which wait in one queue in order of their time tags. The trunk is advanced from
// record to record, never beyond the oldest time of which a source still owes a record: late inputs are used without
// going back, and their order of arrival has no effect.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/attitude_gate.h"
#include "fsw/gnc/inbox.h"
#include "fsw/gnc/outbox.h"
#include "fsw/gnc/receiver_watch.h"
#include "fsw/gnc/state_integrity.h"
#include "fsw/gnc/telecommands.h"
#include "fsw/navigation/burn.h"
#include "fsw/sources/source.h"
#include "fsw/sources/source_list.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::gnc {

class TrunkNavigation {
 public:
  /// Selects and sets the sources (true states until a telecommand does) from all telecommands in force together, if
  /// one of them is new: their order of arrival has no effect. Estimates stay; the blocks of a source that is not
  /// selected any more rest.
  void configure(GpsTime now, const Telecommands& telecommands);

  /// Processes the packets of the step. `burns`: the servicer's from the epoch on, executed or commanded, in order of
  /// time. Records before the epoch are counted as unusable.
  void update(GpsTime now, Inbox& inbox, std::span<const navigation::Burn> burns);

  /// Commanded pointing of the camera, valid until the next command.
  void set_pointing(const sources::Pointing& pointing) { platform_.pointing = pointing; }

  [[nodiscard]] const filter::RelativeNavigationFilter& trunk() const { return trunk_; }
  /// The receivers' epochs as decoded, from the trunk's epoch on.
  [[nodiscard]] const sources::GnssFrontEnd& gnss() const { return gnss_; }
  /// At the end of a step, and at the beginning of the next one (state_integrity.h).
  void seal() { integrity_.seal(trunk_); }
  [[nodiscard]] Integrity verify() { return integrity_.verify(trunk_); }
  /// Whether the relative orbit suffices to plan.
  [[nodiscard]] bool valid() const { return trunk_.solution_status() == filter::SolutionStatus::kEstimated; }
  template <class Source>
  [[nodiscard]] bool uses() const {
    return source<Source>().aid().is_on();
  }
  template <class Source>
  [[nodiscard]] const Source& source() const {
    return std::get<Source>(sources_);
  }
  /// Latest measurement of the relative orbit that was processed.
  [[nodiscard]] GpsTime last_measurement() const;

  /// After update(): innovations outside their band, repeated restarts, records that contradict an orbit which others
  /// confirm, a star tracker or a pose network in error, and receivers that fall silent. One fault stands for all
  /// sources: it states the first.
  ///
  /// A source whose innovations are outside their band, or which restarts repeatedly, is isolated for kIsolation if
  /// others confirm the orbit: its records are not processed. Otherwise the covariance of the orbit grows by what the
  /// innovations are too large; too small ones leave it as it is, which is on the safe side.
  void check_sources(GpsTime now, faults::FaultMonitor& faults);

  static constexpr Duration kIsolation = duration_of_seconds(600);
  /// As after an unknown burn, m/s: the own orbit of a receiver that contradicts it and that nothing else measures.
  static constexpr double kAbsoluteOrbitInflation = 0.05;

  /// Sends the telemetry of the sources in use, and an event of each change of the state of any source.
  void report(Outbox& outbox, std::int64_t step, GpsTime now, const Inbox& inbox) const;
  /// Forgets the changes of state that were reported.
  void forget_transitions();

 private:
  void select(GpsTime now, const Telecommands& telecommands);
  void take_attitudes(GpsTime now, Inbox& inbox);
  [[nodiscard]] std::optional<Matrix3> commanded_attitude(GpsTime time) const;
  void check_attitudes(GpsTime now, faults::FaultMonitor& faults) const;
  template <class Source>
  void isolate(GpsTime now, std::size_t index, Source& source);
  [[nodiscard]] bool is_isolated(std::size_t index) const { return isolated_until_[index] > trunk_.epoch(); }
  [[nodiscard]] GpsTime fusion_horizon(GpsTime now) const;
  void process_records(sources::Context& context, std::span<const navigation::Burn> burns);

  /// Of the servicer, in the step.
  struct Attitudes {
    int received = 0;
    int refused = 0;
    double difference = 0.0;  ///< of the last one refused, rad
  };

  filter::RelativeNavigationFilter trunk_;
  StateIntegrity integrity_;
  sources::RecordQueue queue_;
  sources::Platform platform_;
  AttitudeGate attitude_gate_;
  Attitudes attitudes_;
  sources::GnssFrontEnd gnss_;
  sources::SourceList sources_;
  std::array<GpsTime, std::tuple_size_v<sources::SourceList>> isolated_until_{};  ///< no record before is processed
  ReceiverWatch receivers_;
};

}  // namespace vbar::fsw::gnc
