#pragma once
// The interface of the mission loader to a kind of sensor or a testbed: how its tables are read.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/engine/clock.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

struct Installation;

/// Context in which the table of a sensor is read.
struct SensorContext {
  const Mission& mission;  ///< without the spacecraft further down
  const Installation& installation;
  const std::string& spacecraft;                     ///< that carries the sensor
  const std::vector<std::string>& spacecraft_names;  ///< names of all spacecraft
};

/// Reader of a kind of sensor; all functions throw MissionError.
struct SensorReader {
  std::string_view name;   ///< the value of `kind`
  std::string_view table;  ///< table of the document that only this kind reads; empty: none
  /// Reads the table of one sensor, with the ranges and defaults of its keys.
  std::shared_ptr<const SensorSettings> (*read)(const TableReader& section, const SensorContext& context);
  /// Reads the tables of the document that belong to the kind. Null if it has none.
  std::shared_ptr<const SharedSettings> (*read_shared)(const TableReader& document, const Mission& mission);
  /// Rejects settings that are inconsistent with the complete mission. `section` is the table of the sensor.
  void (*check)(const TableReader& section, const Sensor& sensor, const Spacecraft& spacecraft, const Mission& mission);
};

/// The driver of a testbed, registered under the name of its table.
struct TestbedReader {
  std::string_view name;
  std::shared_ptr<const TestbedSettings> (*read)(const TableReader& section);
  /// The mode that the clock of a run with these settings must have. Null, or no value: any.
  std::optional<engine::ClockMode> (*clock_mode)(const TestbedSettings& settings) = nullptr;
  bool supplies_truth = false;  ///< whether it can be the source of a run's truth
  /// Rejects settings that are inconsistent with the complete mission. Null: none are. `section` is the testbed's
  /// table.
  void (*check)(const TableReader& section, const TestbedSettings& settings, const Mission& mission) = nullptr;
};

/// The sensors, testbeds and clocks of a program.
struct Installation {
  std::filesystem::path data_directory;
  std::vector<const SensorReader*> kinds;
  std::vector<const TestbedReader*> testbeds;
  std::vector<const engine::WallClockSource*> clocks;  ///< the first one is the default
};

/// Makes the clock that the mission names, which the loader has checked.
[[nodiscard]] std::unique_ptr<engine::WallClock> make_wall_clock(const Mission& mission,
                                                                 const Installation& installation);

/// Reads `source` and, for "recorded", `log`: `twin` is the name of the source that this program simulates, the
/// default. Testbeds of the mission are accepted too, and `another` source of the kind, unless it is empty.
void read_source(const TableReader& section, std::string_view twin, const SensorContext& context,
                 SensorSettings& settings, std::string_view another = {});

// A period as missions state it: a number of seconds, or a list of [hour of the mission, seconds].

/// Reads a period. The mission's epoch and start must be known. A single period, also the default, holds from the
/// start; elements of a list before the start are left out.
[[nodiscard]] engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s,
                                           const Mission& mission, const engine::Cadence& default_value);
[[nodiscard]] engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s,
                                           const Mission& mission, fsw::Duration default_value);

}  // namespace vbar::mission
