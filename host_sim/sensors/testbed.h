#pragma once
// A testbed: hardware, or an emulator of it that uses the same wire protocols, in the place of digital twins. A driver
// is a folder of hil_drivers, and one line in its testbeds.cpp, or optional_testbeds.cpp if it needs libraries of its
// own.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fsw/packets/packet.h"
#include "host_sim/engine/clock.h"
#include "host_sim/mission/sensor_reader.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/run_record.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/scene.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/receiver_bytes.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::testbeds {

/// Path of the receiver's data to the flight software of its own spacecraft.
enum class Wiring {
  kHost,   ///< a serial line of the host, which passes the bytes on
  kBoard,  ///< another port of the receiver to a UART of the board; the line of the host mirrors it
};

/// Connection and configuration of a GNSS receiver of a testbed.
struct ReceiverLine {
  std::string port;  ///< tty of the receiver's command port; empty: as the testbed states
  int baud = 115200;
  Wiring wired = Wiring::kHost;
  double log_offset_s = 9.0;    ///< time of the receiver's epochs after a flight step, modulo their period
  bool clock_adjust = true;     ///< the receiver steers its clock to GPS time
  double max_latency_s = 0.95;  ///< latency of its first epoch: from the time of the tag to its last byte
};

/// Receiver of one spacecraft.
struct ReceiverPlan {
  std::string spacecraft;
  twins::gnss::GnssReceiverSettings settings;
  ReceiverLine line;
};

/// Camera of one sensor.
struct CameraPlan {
  std::string name;                        ///< "servicer/camera": in messages, and for random numbers
  twins::camera::CameraSettings settings;  ///< settings as the mission has them
  /// Renders what the camera sees through another projection, onto the region of `settings`, with the models of the
  /// mission. Throws std::runtime_error for data files that cannot be read.
  std::function<std::unique_ptr<twins::camera::SceneRenderer>(
      const twins::camera::CameraSettings& settings, std::shared_ptr<const twins::camera::Projection> projection)>
      make_scene;
};

/// Source of packets as a whole: a sensor, or one source for a pair of receivers.
struct PacketPlan {
  std::string name;                         ///< name of the source, "servicer/gnss": in messages
  std::vector<fsw::packets::Apid> allowed;  ///< messages that it may send
  std::uint8_t spacecraft = 0;              ///< number in the headers of its packets
  std::uint8_t unit = 0;                    ///< number in the headers of its packets
  bool truth_is_compared = false;           ///< as PacketSource::truth_is_compared
  std::size_t packets_max = 65535;          ///< packets in one epoch; those beyond are rejected
  /// Returns the reason why a packet of an allowed message cannot be a measurement of this sensor, whose packet is then
  /// rejected; empty if it can. May be null.
  std::function<std::string(const fsw::packets::PacketView&)> fault_of_value = {};
};

/// True motion of all spacecraft of a mission.
struct TruthPlan {
  const mission::Mission& mission;
  const mission::Spacecraft& servicer;  ///< the spacecraft that flies; mission and servicer outlive the truth
  std::filesystem::path data_directory;
  twins::TruthSnapshot start;  ///< states at the start of the run, by vbar's truth model
  std::shared_ptr<const truth::EarthOrientationSeries> earth_orientation;  ///< series of the mission
};

/// World of a run whose motion is the testbed's. All functions but stop() throw std::runtime_error, one sentence that
/// names the truth.
class TestbedTruth : public twins::TrueWorld, public twins::TruthOutlook {
 public:
  /// Starts the truth, before the run folder exists, and before the sources of the run. A second call has no effect.
  virtual void start() = 0;
  /// Stops the truth however the run ended, also after a start() that threw; a second call has no effect. The
  /// destructor does the same.
  virtual void stop() noexcept = 0;
  /// Number of times that the testbed was asked for states.
  [[nodiscard]] virtual std::int64_t exchanges() const = 0;
};

/// Configuration of the flight software for a camera of the testbed.
struct CalibratedCamera {
  twins::camera::CameraSettings settings;
  std::optional<double> centroid_floor_px;  ///< error of a centroid that calibration leaves, each axis
};

struct RunContext {
  const mission::Mission& mission;
  std::filesystem::path data_directory;
  twins::TruthOutlook& outlook;
};

/// Testbed during one run, shared by all sensors that it provides. Order of calls: the sensors are made, their sources
/// are started and prepare the testbed, begin(), the run, the sources are stopped, finish(). The last two follow any
/// end of a run that had begun.
class TestbedRun {
 public:
  TestbedRun() = default;
  TestbedRun(const TestbedRun&) = delete;
  TestbedRun& operator=(const TestbedRun&) = delete;
  virtual ~TestbedRun() = default;

  /// Makes a receiver; null: the testbed has no GNSS receivers. Throws std::runtime_error if the plan cannot be met.
  /// The receiver keeps this run alive.
  [[nodiscard]] virtual std::unique_ptr<twins::gnss::ReceiverBytes> make_receiver(const ReceiverPlan& plan) {
    static_cast<void>(plan);
    return nullptr;
  }

  /// Makes a camera; null: the testbed has none. Errors and lifetime are those of make_receiver.
  [[nodiscard]] virtual std::unique_ptr<twins::camera::ImageTaker> make_camera(const CameraPlan& plan) {
    static_cast<void>(plan);
    return nullptr;
  }

  /// Makes a source of packets; null: the testbed has none of its own. Errors and lifetime are those of make_receiver.
  [[nodiscard]] virtual std::unique_ptr<twins::PacketSource> make_packets(const PacketPlan& plan) {
    static_cast<void>(plan);
    return nullptr;
  }

  /// Begins the record of the run in `record` and, unless the path is empty, in `folder`; the testbed's time starts.
  /// Throws std::runtime_error, one sentence. `record` outlives the run.
  virtual void begin(report::RunRecord& record, const std::filesystem::path& folder) = 0;

  /// Returns the clock that the run follows, after begin(); null: the mission's.
  [[nodiscard]] virtual engine::WallClock* clock() { return nullptr; }

  /// Adds the figures at the end of the run to the record. Does not throw.
  virtual void finish() noexcept = 0;
};

struct TestbedKind : mission::TestbedReader {
  std::shared_ptr<TestbedRun> (*open)(const mission::TestbedSettings& settings, const RunContext& context);
  /// Tables, figures of the summary and report section.
  report::Extension report{};
  /// Returns the camera of the mission as the testbed has calibrated it. Null: as the mission has it. Throws
  /// MissionError for a calibration that cannot be read.
  CalibratedCamera (*calibrated_camera)(const mission::TestbedSettings& settings, const mission::Mission& mission,
                                        const std::filesystem::path& data_directory,
                                        const twins::camera::CameraSettings& of_mission) = nullptr;
  /// Makes the truth of a run, if the kind supplies it. Throws std::runtime_error if the plan cannot be met.
  std::unique_ptr<TestbedTruth> (*make_truth)(const mission::TestbedSettings& settings,
                                              const TruthPlan& plan) = nullptr;
  /// Whether its camera gives the light of any commanded exposure, whatever its own: a display shows in its exposure
  /// the electrons of another.
  bool shows_commanded_exposures = false;
};

}  // namespace vbar::testbeds
