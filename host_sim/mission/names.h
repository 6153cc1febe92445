#pragma once
// The names of the enumerations in mission files, summaries and messages: one list each.

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <utility>

#include <vbar/fields.h>

#include "host_sim/mission/mission.h"

namespace vbar::mission {

template <class Enum, std::size_t N>
using Names = std::array<std::pair<std::string_view, Enum>, N>;

inline constexpr Names<ElementsKind, 2> kElementsKinds{
    {{"osculating", ElementsKind::kOsculating}, {"mean", ElementsKind::kMean}}};
inline constexpr Names<FlightTarget, 5> kFlightTargets{{{"in_process", FlightTarget::kInProcess},
                                                        {"host_process", FlightTarget::kHostProcess},
                                                        {"zynq_qemu", FlightTarget::kZynqQemu},
                                                        {"zynq_linux_qemu", FlightTarget::kZynqLinuxQemu},
                                                        {"board", FlightTarget::kBoard}}};
inline constexpr Names<FlightLink, 2> kFlightLinks{{{"serial", FlightLink::kSerial}, {"udp", FlightLink::kUdp}}};
/// The words of waypoint.kSolver in vbar.lcm, without none.
inline constexpr auto kSolvers = [] {
  Names<Solver, std::size(codes::waypoint_kSolver) - 1> names{};
  std::size_t count = 0;
  for (const Code& code : codes::waypoint_kSolver)
    if (code.value != waypoint::kSolverNone) names[count++] = {code.word, static_cast<Solver>(code.value)};
  return names;
}();
inline constexpr Names<Mode, 5> kModes{{{"idle", Mode::kIdle},
                                        {"approach", Mode::kApproach},
                                        {"station_keeping", Mode::kStationKeeping},
                                        {"hold", Mode::kHold},
                                        {"retreat", Mode::kRetreat}}};
inline constexpr Names<FaultKind, 12> kFaultKinds{{{"silent", FaultKind::kSilent},
                                                   {"frozen", FaultKind::kFrozen},
                                                   {"receiver_silent", FaultKind::kReceiverSilent},
                                                   {"target_turned", FaultKind::kTargetTurned},
                                                   {"attitude_error", FaultKind::kAttitudeError},
                                                   {"thrust_scale", FaultKind::kThrustScale},
                                                   {"thrust_uncommanded", FaultKind::kThrustUncommanded},
                                                   {"computer_silent", FaultKind::kComputerSilent},
                                                   {"computer_reboot", FaultKind::kComputerReboot},
                                                   {"cycle_slip", FaultKind::kCycleSlip},
                                                   {"clock_jump", FaultKind::kClockJump},
                                                   {"receiver_reset", FaultKind::kReceiverReset}}};
inline constexpr Names<Apriori, 3> kAprioris{
    {{"none", Apriori::kNone}, {"orbit", Apriori::kOrbit}, {"roe", Apriori::kRoe}}};
inline constexpr Names<ImagesInLog, 2> kImagesInLog{
    {{"recipes", ImagesInLog::kRecipes}, {"tiles", ImagesInLog::kTiles}}};
inline constexpr Names<engine::ClockMode, 2> kClockModes{
    {{"lock_step", engine::ClockMode::kLockStep}, {"real_time", engine::ClockMode::kRealTime}}};
inline constexpr Names<engine::LatencyKind, 4> kLatencyKinds{{{"constant", engine::LatencyKind::kConstant},
                                                              {"uniform", engine::LatencyKind::kUniform},
                                                              {"normal", engine::LatencyKind::kNormal},
                                                              {"exponential", engine::LatencyKind::kExponential}}};

inline constexpr Names<truth::GeomagneticIndex, 2> kGeomagneticIndices{
    {{"daily", truth::GeomagneticIndex::kDaily}, {"three_hourly", truth::GeomagneticIndex::kThreeHourly}}};
inline constexpr Names<truth::Shadow, 3> kShadows{{{"none", truth::Shadow::kNone},
                                                   {"cylindrical", truth::Shadow::kCylindrical},
                                                   {"conical", truth::Shadow::kConical}}};

/// Returns the name of an enumerator; empty for an invalid value.
template <class Enum, std::size_t N>
constexpr std::string_view name_in(const Names<Enum, N>& names, Enum value) {
  for (const auto& [name, candidate] : names)
    if (candidate == value) return name;
  return {};
}

}  // namespace vbar::mission
