#pragma once
// Measurement scheduling: one relative navigation filter and a list of measurement sources.
//
// Sources turn packets into records, which wait in one queue in order of their time tags. The filter advances from
// record to record, never beyond the oldest time since which a record of a source is pending. Late inputs are therefore
// used without going back, and their order of arrival has no effect.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/filter/propagation.h"
#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/measurements/source.h"
#include "fsw/measurements/source_list.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/outbox.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/navigation/attitude_gate.h"
#include "fsw/navigation/receiver_watch.h"
#include "fsw/navigation/state_integrity.h"

namespace vbar::fsw::navigation {

class MeasurementScheduler {
 public:
  /// Selects and configures the sources from all telecommands in force together, if one of them is new: their order of
  /// arrival has no effect. Without telecommands, true states are used. Estimates stay; the blocks of a source that is
  /// no longer selected are deactivated.
  void configure(GpsTime now, const messaging::Telecommands& telecommands);

  /// Processes the packets of the step. `burns` are the servicer's from the epoch on, executed or commanded, in order
  /// of time. Records before the epoch are counted as unusable.
  void update(GpsTime now, messaging::Inbox& inbox, std::span<const filter::Burn> burns);

  /// Notes the commanded pointing of the camera, valid until the next command.
  void set_pointing(const measurements::Pointing& pointing) { platform_.pointing = pointing; }

  [[nodiscard]] const filter::RelativeNavigationFilter& filter() const { return filter_; }
  /// Returns the decoded epochs of the receivers, from the epoch of the filter on.
  [[nodiscard]] const gnss::GnssFrontEnd& gnss() const { return gnss_; }
  /// Protect the filter from the end of a step to the beginning of the next one (state_integrity.h).
  void seal() { integrity_.seal(filter_); }
  [[nodiscard]] Integrity verify() { return integrity_.verify(filter_); }
  /// Returns whether the relative orbit suffices to plan.
  [[nodiscard]] bool valid() const { return filter_.solution_status() == filter::SolutionStatus::kEstimated; }
  template <class Source>
  [[nodiscard]] bool uses() const {
    return source<Source>().aid().is_on();
  }
  template <class Source>
  [[nodiscard]] const Source& source() const {
    return std::get<Source>(sources_);
  }
  /// Returns the time of the latest processed measurement of the relative orbit.
  [[nodiscard]] GpsTime last_measurement() const;

  /// Checks the sources after update(): innovations outside their band, repeated restarts, records that contradict an
  /// orbit which others confirm, a star tracker or a pose network in error, and silent receivers. One fault stands for
  /// all sources and states the first.
  ///
  /// A source whose innovations are outside their band, or which restarts repeatedly, is isolated for kIsolation if
  /// others confirm the orbit: its records are not processed. Otherwise the covariance of the orbit is scaled by the
  /// excess of the innovations; innovations that are too small leave it as it is, which is conservative.
  void check_sources(GpsTime now, faults::FaultMonitor& faults);

  static constexpr Duration kIsolation = duration_of_seconds(600);
  /// Inflation of the absolute orbit, m/s, if its only receiver contradicts it: as after an unknown burn.
  static constexpr double kAbsoluteOrbitInflation = 0.05;

  /// Sends the telemetry of the sources in use, and an event of each change of the state of any source.
  void report(messaging::Outbox& outbox, std::int64_t step, GpsTime now, const messaging::Inbox& inbox) const;
  /// Discards the changes of state that were reported.
  void forget_transitions();

 private:
  void select(GpsTime now, const messaging::Telecommands& telecommands);
  void take_attitudes(GpsTime now, messaging::Inbox& inbox);
  [[nodiscard]] std::optional<Matrix3> commanded_attitude(GpsTime time) const;
  void check_attitudes(GpsTime now, faults::FaultMonitor& faults) const;
  template <class Source>
  void isolate(GpsTime now, std::size_t index, Source& source);
  [[nodiscard]] bool is_isolated(std::size_t index) const { return isolated_until_[index] > filter_.epoch(); }
  [[nodiscard]] GpsTime fusion_horizon(GpsTime now) const;
  void process_records(measurements::Context& context, std::span<const filter::Burn> burns);

  /// Counts the attitudes of the servicer in the step.
  struct Attitudes {
    int received = 0;
    int refused = 0;
    double difference = 0.0;  ///< of the last rejected one, rad
  };

  filter::RelativeNavigationFilter filter_;
  StateIntegrity integrity_;
  measurements::RecordQueue queue_;
  measurements::Platform platform_;
  AttitudeGate attitude_gate_;
  Attitudes attitudes_;
  gnss::GnssFrontEnd gnss_;
  measurements::SourceList sources_;
  std::array<GpsTime, std::tuple_size_v<measurements::SourceList>>
      isolated_until_{};  ///< earlier records are not processed
  ReceiverWatch receivers_;
};

}  // namespace vbar::fsw::navigation
