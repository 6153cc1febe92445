#pragma once
// Navigation of one trunk (fsw/trunk) and a list of sources.
//
// Sources turn packets into records, which wait in one queue in order of their time tags. The trunk is advanced from
// record to record, never beyond the oldest time of which a source still owes a record: late inputs are used without
// going back, and their order of arrival has no effect.

#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

#include "fsw/core/gps_time.h"
#include "fsw/gnc/inbox.h"
#include "fsw/gnc/outbox.h"
#include "fsw/gnc/telecommands.h"
#include "fsw/navigation/burn.h"
#include "fsw/sources/bearings/bearing_source.h"
#include "fsw/sources/carrier_pair/carrier_source.h"
#include "fsw/sources/ideal/ideal_source.h"
#include "fsw/sources/keypoints/keypoint_source.h"
#include "fsw/sources/own_gnss/own_gnss_source.h"
#include "fsw/sources/range_finder/range_source.h"
#include "fsw/sources/source.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::gnc {

class TrunkNavigation {
 public:
  /// Until a telecommand selects other sources, ideal navigation is used.
  TrunkNavigation() { std::get<sources::IdealSource>(sources_).aid().go_to(sources::AidState::kWaiting, GpsTime{}); }

  /// Selects and sets the sources from the telecommands in force, if one of them is new. Estimates stay; the blocks of
  /// a source that is not selected any more rest.
  void configure(GpsTime now, const Telecommands& telecommands);

  /// Processes the packets of the step. `burns`: the servicer's from the epoch on, executed or commanded, in order of
  /// time. Records before the epoch are counted as unusable.
  void update(GpsTime now, Inbox& inbox, std::span<const navigation::Burn> burns);

  /// Commanded pointing of the camera, valid until the next command.
  void set_pointing(const sources::Pointing& pointing) { platform_.pointing = pointing; }

  [[nodiscard]] const trunk::Trunk& trunk() const { return trunk_; }
  /// Whether the relative orbit suffices to plan.
  [[nodiscard]] bool valid() const { return trunk_.knowledge() == trunk::RelativeKnowledge::kEstimated; }
  template <class Source>
  [[nodiscard]] const Source& source() const {
    return std::get<Source>(sources_);
  }
  /// Latest measurement of the relative orbit that was processed.
  [[nodiscard]] GpsTime last_measurement() const;

  /// Telemetry of the sources in use.
  void report(Outbox& outbox, std::int64_t step, GpsTime now, const Inbox& inbox) const;

 private:
  /// Records of one time are processed in this order: the servicer's own position first.
  using Sources = std::tuple<sources::IdealSource, sources::OwnGnssSource, sources::CarrierSource,
                             sources::BearingSource, sources::KeypointSource, sources::RangeSource>;

  static_assert(std::tuple_size_v<Sources> <= trunk::Trunk::kMaxSources);

  /// Telecommand from which the a-priori orbit of the target comes.
  enum class AprioriOrigin : std::uint8_t { kNone, kTarget, kPose };

  void configure_sources(GpsTime now, const Telecommands& telecommands);
  void configure_bearings(const Telecommands& telecommands, trunk::TrunkSettings& blocks);
  void configure_keypoints(const Telecommands& telecommands, trunk::TrunkSettings& blocks);
  void configure_ranges(const Telecommands& telecommands);
  void select_sources(GpsTime now, const Telecommands& telecommands);
  void configure_apriori(const Telecommands& telecommands);
  void take_attitudes(GpsTime now, Inbox& inbox);
  [[nodiscard]] GpsTime owed_until(GpsTime now) const;
  void fold_records(sources::Context& context, std::span<const navigation::Burn> burns);

  trunk::Trunk trunk_;
  sources::RecordQueue queue_;
  sources::Platform platform_;
  sources::GnssFrontEnd gnss_;
  Sources sources_;
  AprioriOrigin apriori_origin_ = AprioriOrigin::kNone;
  std::optional<trunk::TargetApriori> pose_apriori_;  ///< of the pose_configuration in force
};

}  // namespace vbar::fsw::gnc
