#pragma once
// What turns the motion of a body into the bytes of a GNSS receiver: the digital twin, or the driver of a testbed.
// Attitude, crosslink and packets are the sensor's (gnss_sensor.h).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::gnss {

/// The truth about the body that carries the receiver.
struct BodyTruth {
  fsw::GpsTime time;                                 ///< whole milliseconds
  fsw::Vector3 position_eci = fsw::Vector3::Zero();  ///< of the centre of mass
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();
  Eigen::Quaterniond q_body_eci =
      Eigen::Quaterniond::Identity();                  ///< as the body's attitude is known; body axes from ECI
  fsw::Vector3 rate_body_eci = fsw::Vector3::Zero();   ///< angular velocity against ECI, rad/s, ECI components
  fsw::Matrix3 R_ecef_eci = fsw::Matrix3::Identity();  ///< the truth's own Earth rotation at `time`
  // Of a receiver that asks for them; empty where they are not known.
  std::optional<fsw::Vector3> acceleration_eci;           ///< of the centre of mass, m/s^2
  std::optional<fsw::Vector3> angular_acceleration_body;  ///< rad/s^2, body axes
};

/// What a receiver gave at one call.
struct ReceiverOutput {
  std::vector<std::uint8_t> bytes;
  bool is_epoch = true;      ///< false: nothing is delivered, a trajectory sample was taken in between two epochs
  fsw::Duration delay = {};  ///< from the epoch until the last byte was there, >= 0
  std::vector<Note> notes = {};
  std::string failure = {};  ///< if the receiver gave nothing for this epoch: why, one sentence
};

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

  /// Once every period of the sensor, in order.
  virtual ReceiverOutput output_at(const BodyTruth& truth) = 0;
};

}  // namespace vbar::twins::gnss
