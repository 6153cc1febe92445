#pragma once
// The measurements of a sensor beside the truth: rows of the record, made while the mission flies.

#include <any>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/packet.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/sensor_reader.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/run_record.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/twins/packet_log.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

/// Evaluates a sensor: called on events in their order; a class overrides the calls that it needs.
class Evaluation {
 public:
  Evaluation() = default;
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;
  virtual ~Evaluation() = default;

  /// Receives the truth of a measurement of this sensor, if its source is one whose truth is compared.
  virtual void on_measured(const twins::TruthSnapshot& /*truth*/) {}
  /// Receives the bytes that the flight software received, from all sensors, with the step at `time`.
  virtual void on_inputs(fsw::GpsTime /*time*/, std::span<const twins::Packet> /*inputs*/) {}
  /// Receives the answer of the flight software: telemetry and commands.
  virtual void on_answer(fsw::GpsTime /*time*/, std::span<const fsw::packets::PacketView> /*answer*/) {}
  /// Ends the evaluation when the run is over, however it ended.
  virtual void finish() {}
};

struct EvaluationContext {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< carries the sensor and the flight software
  report::RunRecord& record;            ///< outlives the evaluation
};

/// Pairs an evaluation with the source whose truth it receives.
struct NamedEvaluation {
  std::string source;  ///< "servicer/lidar"
  std::unique_ptr<Evaluation> evaluation;
};

// A kind of sensor: all properties by which the program handles it, registered in sensor_kinds.cpp.

/// Telecommands to one spacecraft in the order in which they are sent.
class Telecommands {
 public:
  Telecommands(fsw::GpsTime time, std::uint8_t spacecraft) : time_(time), spacecraft_(spacecraft) {}

  /// Adds a telecommand; `unit` is that of the device that it is for. Throws std::runtime_error for a message that
  /// holds a NaN or an infinity.
  template <class Message>
  void add(const Message& message, std::uint8_t unit = 0) {
    fsw::packets::PacketHeader header;
    header.time = time_;
    header.spacecraft = spacecraft_;
    header.unit = unit;
    twins::Packet packet(fsw::packets::kMaxPacketBytes);
    const auto size = fsw::packets::encode(header, message, packet);
    if (!size.ok()) throw std::runtime_error("a telecommand cannot be sent: it contains a number that is not finite");
    packet.resize(size.value());
    packets_.push_back(std::move(packet));
  }

  [[nodiscard]] const std::vector<twins::Packet>& packets() const { return packets_; }

 private:
  fsw::GpsTime time_;
  std::uint8_t spacecraft_;
  std::vector<twins::Packet> packets_;
};

/// Data that are known on the ground when the telecommands of the start are made.
struct TelecommandContext {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< carries the flight software
  std::filesystem::path data_directory;
  const truth::EarthOrientationSeries& earth_orientation;
  /// Returns the true state of a spacecraft at the start, from which a-priori knowledge is drawn.
  std::function<fsw::orbit::CartesianState(std::string_view spacecraft)> state_at_start;
};

/// Objects that several sources of one run share, by name: the sky over all receivers.
class SharedObjects {
 public:
  /// Returns the object of that name, which the first caller makes.
  template <class Object, class Make>
  std::shared_ptr<Object> get(const std::string& name, const Make& make) {
    std::any& object = objects_[name];
    if (!object.has_value()) object = std::shared_ptr<Object>(make());
    return std::any_cast<std::shared_ptr<Object>>(object);
  }

 private:
  std::map<std::string, std::any> objects_;
};

struct MakeContext {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< carries the sensor and the flight software
  std::filesystem::path data_directory;
  SharedObjects& shared;
  testbeds::OpenTestbeds& testbeds;
  twins::TruthOutlook* outlook;          ///< null: no testbed can be used
  std::vector<std::string>& data_notes;  ///< on files that are left out in part: report::Summary::data_notes
};

/// Run for which the packets of a log are restored.
struct RestoreContext {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< carries the sensors and the flight software; outlives what is made
  std::filesystem::path data_directory;
};

/// The packets that carry the measurements of a sensor.
struct MeasurementPackets {
  fsw::packets::Apid apid = fsw::packets::Apid::kIdealNavigation;
  std::optional<fsw::packets::Apid> by_crosslink{};  ///< from a spacecraft without flight software; empty: the same
  /// Unit in their headers. Null: 0.
  std::uint8_t (*unit)(const mission::Sensor& sensor, const mission::Spacecraft& carrier) = nullptr;
};

struct SensorKind : mission::SensorReader {
  MeasurementPackets packets{};
  /// Adds the telecommands about the sensor that the flight software receives before its first step. Null: none.
  void (*add_telecommands)(const mission::Sensor& sensor, const TelecommandContext& context,
                           Telecommands& telecommands) = nullptr;
  /// Adds the sources of the sensor's packets. Throws what a recorded log and data files throw.
  void (*add_sources)(const mission::Sensor& sensor, const MakeContext& context,
                      std::vector<twins::NamedSource>& sources) = nullptr;
  /// Adds the facts that the summary states about the sensor: its source, the navigation by it. Null: nothing.
  void (*add_facts)(const mission::Sensor& sensor, const mission::Mission& mission, const mission::Spacecraft& servicer,
                    report::RunFacts& facts) = nullptr;
  /// Compares the measurements of the sensor with the truth. Null, or a null result: nothing does.
  std::unique_ptr<Evaluation> (*evaluate)(const mission::Sensor& sensor, const EvaluationContext& context) = nullptr;
  /// Whether the evaluation receives the truth of each measurement.
  bool compares_measurements = false;
  /// Tables, summary figures and report section, for all sensors of the kind together.
  report::Extension report{};
  /// Restores the packets of all sensors of the kind that a log holds in another form. Null: logs hold the packets.
  /// Throws twins::DamagedLog.
  std::unique_ptr<twins::TileSource> (*make_tile_source)(const RestoreContext& context,
                                                         twins::ImagesOfLog&& images) = nullptr;
};

/// Returns the name of a source: "servicer/gnss".
[[nodiscard]] inline std::string source_name(const mission::Spacecraft& carrier, const mission::Sensor& sensor) {
  return carrier.name + "/" + sensor.name;
}

/// Returns the number of the sensor among those of its kind on the spacecraft: the unit in packet headers.
[[nodiscard]] inline std::uint8_t unit_of(const mission::Sensor& sensor, const mission::Spacecraft& carrier) {
  std::uint8_t unit = 0;
  for (const mission::Sensor& other : carrier.sensors) {
    if (other.name == sensor.name) break;
    if (other.kind == sensor.kind) ++unit;
  }
  return unit;
}

/// Returns the settings of a sensor of the kind whose settings are `Settings`.
template <class Settings>
const Settings& settings_of(const mission::Sensor& sensor) {
  return dynamic_cast<const Settings&>(*sensor.settings);
}

// Packets of a sensor that a testbed provides whole.

/// Returns why a packet of an allowed message cannot be a measurement of the sensor; empty if it can.
using FaultOfValue = std::function<std::string(const fsw::packets::PacketView&)>;

/// Limits of one epoch: packets beyond are rejected.
struct PacketLimits {
  std::size_t packets_max = 65535;
  FaultOfValue fault_of_value = {};
};

/// Makes the source of a sensor's packets about `carrier`, if a testbed provides whole packets: a sensor in another
/// process. Null for any other source. `kind`: that of the sensor. Throws std::runtime_error if the testbed cannot, and
/// without a run.
[[nodiscard]] std::unique_ptr<twins::PacketSource> packets_of_testbed(const mission::Sensor& sensor,
                                                                      const SensorKind& kind,
                                                                      const MakeContext& context,
                                                                      const mission::Spacecraft& carrier,
                                                                      std::vector<fsw::packets::Apid> allowed,
                                                                      std::uint8_t unit, PacketLimits limits = {});

/// Returns such a source for a kind of sensor that testbeds provide in no other form: throws std::runtime_error for
/// another source of a testbed.
[[nodiscard]] std::unique_ptr<twins::PacketSource> only_packets_of_testbed(const mission::Sensor& sensor,
                                                                           const SensorKind& kind,
                                                                           const MakeContext& context,
                                                                           fsw::packets::Apid allowed,
                                                                           FaultOfValue fault_of_value = {});

}  // namespace vbar::sensors
