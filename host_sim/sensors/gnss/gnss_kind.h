#pragma once
// kind = "gnss": a receiver and a star tracker. Its data and, over the crosslink, those of a partner's receiver.

#include <optional>
#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/report/extension.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/crosslink.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/recorded_receiver.h"

namespace vbar::sensors {

/// Settings of a receiver; `observed` is the partner: the spacecraft whose receiver's data come over the crosslink;
/// empty: this one's go to its partner, or they are all there is, beside a camera of a target that does not cooperate.
struct GnssSensor : mission::SensorSettings {
  twins::gnss::GnssReceiverSettings receiver;
  testbeds::ReceiverLine line;               ///< line of a receiver in a testbed
  twins::gnss::RecordingSettings recording;  ///< files of a recorded receiver, of source "rinex"
};

/// Source of a recorded receiver in the place of the twin.
inline constexpr std::string_view kRinex = "rinex";

/// [navigation.carrier_phase], [constellation] and [links.crosslink].
struct GnssShared : mission::SharedSettings {
  vbar::carrier_configuration carrier{};  ///< without the antenna
  twins::gnss::ConstellationSettings constellation;
  twins::gnss::CrosslinkSettings crosslink;
  fsw::Duration crosslink_from{};  ///< after the epoch of the mission: before, the partner's receiver is off
};

extern const SensorKind kGnss;

/// Makes the section of carrier-phase navigation: beside the paper, integers, consistency (section_gnss.cpp).
[[nodiscard]] report::Section gnss_section(const report::RunRecord& record);
/// Returns the figures of the paper's experiment 3, software and hardware in the loop, if the run meets its waypoints
/// by GNSS.
[[nodiscard]] std::vector<report::PaperColumn> gnss_paper_columns(const report::RunRecord& record);

// In gnss_figures.cpp: how hardware differs from a twin.
[[nodiscard]] report::Section signal_noise_section(const report::RunRecord& record);
/// Returns the time (s) from the run's first step until the relative position error stays below 20 mm; empty: it does
/// not.
[[nodiscard]] std::optional<double> time_to_20_mm(const report::RunRecord& record);
void summarise_gnss(const report::RunRecord& record, report::Summary& summary);

/// Returns the NEES of the relative state; NIS of all codes and carrier phases of an epoch.
[[nodiscard]] std::vector<report::ConsistencyFigure> gnss_consistency(const report::RunRecord& record);

// In gnss_kind.cpp.
std::shared_ptr<const mission::SensorSettings> read_gnss(const mission::TableReader& section,
                                                         const mission::SensorContext& context);
std::shared_ptr<const mission::SharedSettings> read_gnss_shared(const mission::TableReader& document,
                                                                const mission::Mission& mission);

/// Returns the telecommand of the receiver of the spacecraft that flies, with the nominal antenna.
[[nodiscard]] vbar::receiver_configuration receiver_configuration_of(const mission::Spacecraft& servicer);
/// Returns the telecommand of carrier-phase navigation with the nominal antenna of the GNSS partner, which the servicer
/// must have.
[[nodiscard]] vbar::carrier_configuration carrier_configuration_of(const mission::Mission& mission,
                                                                   const mission::Spacecraft& servicer);

/// Returns the distance (m) between where the antennas of `servicer` and its partner are and where navigation takes
/// them to be, from the run's own draws, as if the bodies had parallel axes. For the report only. None without a GNSS
/// pair.
[[nodiscard]] std::optional<double> gnss_static_floor_m(const mission::Mission& mission,
                                                        const mission::Spacecraft& servicer);

}  // namespace vbar::sensors
