#pragma once
// Converts the motion of a body to the bytes of a GNSS receiver: the digital twin, or the driver of a testbed.
// The sensor handles attitude, crosslink and packets (gnss_sensor.h).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/io/serial_line.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::gnss {

/// The truth about the body that carries the receiver.
struct BodyTruth {
  fsw::GpsTime time;                                 ///< whole milliseconds
  fsw::Vector3 position_eci = fsw::Vector3::Zero();  ///< position of the centre of mass
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();
  Eigen::Quaterniond q_body_eci =
      Eigen::Quaterniond::Identity();                  ///< the known attitude of the body; body axes from ECI
  fsw::Vector3 rate_body_eci = fsw::Vector3::Zero();   ///< angular velocity against ECI, rad/s, ECI components
  fsw::Matrix3 R_ecef_eci = fsw::Matrix3::Identity();  ///< the truth's own Earth rotation at `time`
  // For a receiver that requests them; empty for others.
  std::optional<fsw::Vector3> acceleration_eci;           ///< acceleration of the centre of mass, m/s^2
  std::optional<fsw::Vector3> angular_acceleration_body;  ///< rad/s^2, body axes
};

/// The known attitude of the body at an epoch of the receiver.
struct EpochAttitude {
  fsw::GpsTime time;
  Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::Identity();
  fsw::Vector3 rate_body = fsw::Vector3::Zero();  ///< rad/s, body axes
};

/// Output of a receiver at one call.
struct ReceiverOutput {
  std::vector<std::uint8_t> bytes;
  bool is_epoch = true;      ///< false: nothing is delivered, a trajectory sample was taken in between two epochs
  fsw::Duration delay = {};  ///< from the call until the last byte was available, >= 0
  /// Attitude at the measurement of bytes that a device measured before the call. Empty: the epoch is that of the call.
  std::optional<EpochAttitude> measured = std::nullopt;
  bool bytes_bypass_host = false;  ///< the flight computer receives the bytes by a line of its own
  std::vector<Note> notes = {};
  std::string failure = {};  ///< if the receiver gave no data for this epoch: the reason, one sentence
};

/// Returns the truth about one spacecraft, which must have an attitude.
[[nodiscard]] BodyTruth body_truth(const TruthSnapshot& truth, const SpacecraftTruth& spacecraft);

class ReceiverBytes {
 public:
  ReceiverBytes() = default;
  ReceiverBytes(const ReceiverBytes&) = delete;
  ReceiverBytes& operator=(const ReceiverBytes&) = delete;
  virtual ~ReceiverBytes() = default;

  // As those of PacketSource.
  virtual void start(fsw::GpsTime first_epoch) { static_cast<void>(first_epoch); }
  virtual void stop(StopReason reason) { static_cast<void>(reason); }
  [[nodiscard]] virtual TruthDetail truth_detail() const { return TruthDetail::kStates; }
  [[nodiscard]] virtual std::vector<Note> statistics() const { return {}; }
  [[nodiscard]] virtual std::optional<io::WiredReceiver> wired_receiver() const { return std::nullopt; }

  /// Returns the period between calls of output_at; empty: the sensor's period.
  [[nodiscard]] virtual std::optional<fsw::Duration> call_period() const { return std::nullopt; }

  /// Measures once every period, in order.
  virtual ReceiverOutput output_at(const BodyTruth& truth) = 0;

  /// Upsets the receiver as PacketSource::upset().
  virtual bool upset(const Upset& upset) {
    static_cast<void>(upset);
    return false;
  }
};

}  // namespace vbar::twins::gnss
