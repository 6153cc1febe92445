#pragma once
// The kinds of sensors of this program, and missions read with them.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/mission/load.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

/// Returns all kinds, in the order in which the sensors of a spacecraft measure at one instant.
[[nodiscard]] std::span<const SensorKind* const> sensor_kinds();

/// Returns the kind of a sensor of a mission that was loaded with installation().
[[nodiscard]] const SensorKind& kind_of(const mission::Sensor& sensor);

/// Returns the kinds, clock sources and testbeds of this program; the data folder is mission::data_directory().
[[nodiscard]] mission::Installation installation();

/// Loads a mission by mission::load_mission with installation().
mission::Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides = {});
mission::Mission parse_mission(std::string_view text, const std::filesystem::path& file,
                               std::span<const std::string> overrides = {});

struct MadeSources {
  std::vector<twins::NamedSource> sources;
  std::vector<std::shared_ptr<testbeds::TestbedRun>> testbeds;  ///< that provide some of them
  std::vector<std::string> data_notes{};                        ///< on the files that they read
};

/// Makes the sources of all that the flight software of `servicer` receives from its sensors. `outlook`, which must
/// outlive them, is required by testbeds.
[[nodiscard]] MadeSources make_sources(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                       const std::filesystem::path& data_directory,
                                       twins::TruthOutlook* outlook = nullptr);

/// make_sources, or its replacement in a test.
using MakeSources =
    std::function<MadeSources(const mission::Mission& mission, const mission::Spacecraft& servicer,
                              const std::filesystem::path& data_directory, twins::TruthOutlook* outlook)>;

/// Makes the restorer of packets that a log holds in another form: that of the first kind with such packets. Throws
/// twins::DamagedLog. `mission` and `servicer` must outlive it.
[[nodiscard]] std::unique_ptr<twins::TileSource> make_tile_source(const RestoreContext& context,
                                                                  twins::ImagesOfLog&& images);

/// Makes the evaluations of the sensors of `servicer`, whose kinds have one.
[[nodiscard]] std::vector<NamedEvaluation> make_evaluations(const mission::Mission& mission,
                                                            const mission::Spacecraft& servicer,
                                                            report::RunRecord& record);

/// Adds the facts that the summary states about the sensors of `servicer`.
void add_facts(const mission::Mission& mission, const mission::Spacecraft& servicer, report::RunFacts& facts);

/// Returns the extensions by which the kinds and the testbeds add to record, summary and report.
[[nodiscard]] report::Extensions extensions();

/// Returns the telecommands before the first step, in this order: guidance, its sensors, the waypoints, the mode.
[[nodiscard]] std::vector<twins::Packet> telecommands_of(const TelecommandContext& context);

}  // namespace vbar::sensors
