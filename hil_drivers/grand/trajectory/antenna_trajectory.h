#pragma once
// Noise of the antenna's phase centre (Appendix A of the paper: 1 mm on each axis at each epoch of the receiver) as a
// smooth motion: between the values of two epochs the phase centre moves along a quintic with zero velocity and
// acceleration at both ends. A step would be a step of every carrier phase.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

/// Epochs of a receiver: GPS time `offset` after every multiple of `period` (LOG ... ONTIME 10 9).
struct ReceiverEpochs {
  fsw::Duration period = fsw::duration_of_seconds(10);
  fsw::Duration offset = fsw::duration_of_seconds(9);
};

class PhaseCentreNoise {
 public:
  /// Draws from the stream "gnss/<spacecraft>/antenna_noise" of `seed`; the value of an epoch depends on its time only.
  /// Throws std::invalid_argument for a period that is not positive.
  PhaseCentreNoise(double sigma_m, const ReceiverEpochs& epochs, std::uint64_t seed, std::string_view spacecraft);

  /// Returns the displacement in body axes, m, and its three derivatives with respect to time.
  std::array<fsw::Vector3, 4> at(fsw::GpsTime time);

 private:
  [[nodiscard]] fsw::Vector3 value_of(std::int64_t epoch);

  double sigma_m_;
  ReceiverEpochs epochs_;
  engine::RandomStream stream_;
  // Values at both ends of the interval that begins with epoch_: a cache.
  std::int64_t epoch_ = INT64_MIN;
  std::array<fsw::Vector3, 2> ends_{};
};

// Motion of the true phase centre of one spacecraft's antenna, from the truth about its body.

class AntennaTrajectory {
 public:
  /// The errors of the body frame are those the digital twin draws for the same seed and spacecraft. `start` is the
  /// time of the first sample.
  AntennaTrajectory(const twins::gnss::BodyFrameSettings& settings, const ReceiverEpochs& epochs, fsw::GpsTime start,
                    std::uint64_t seed, std::string_view spacecraft);

  /// Returns the sample of the present truth. All derivatives are those of one curve. The centre of mass contributes
  /// its acceleration and the jerk of the two-body problem; the arm contributes rotation at the body's rate and angular
  /// acceleration (constant from sample to sample) and the noise of the phase centre. An angular acceleration missing
  /// in the truth counts as zero. Throws std::invalid_argument if the truth has no acceleration, is not finite or lies
  /// before the start.
  TrajectorySample at(const twins::gnss::BodyTruth& truth);

  /// Takes the Earth's rotation at a time near the next sample's, from which, with that of the sample, its angular
  /// velocity follows: about the pole of date, which polar motion keeps away from the z axis, with precession and
  /// nutation. Each sample does the same for the one after it. Without one the Earth turns about z at GPS's rate.
  void observe_earth(fsw::GpsTime time, const fsw::Matrix3& R_ecef_eci);

  [[nodiscard]] const twins::gnss::BodyFrameErrors& errors() const { return errors_; }
  /// Rotation from the axes of the body to those of the antenna.
  [[nodiscard]] const fsw::Matrix3& R_antenna_body() const { return R_antenna_body_; }

 private:
  twins::gnss::BodyFrameSettings settings_;
  twins::gnss::BodyFrameErrors errors_;
  fsw::Vector3 antenna_body_m_;  ///< from the true centre of mass, without noise
  fsw::Matrix3 R_antenna_body_;
  PhaseCentreNoise noise_;
  fsw::GpsTime start_;
  struct Observed {
    fsw::GpsTime time;
    fsw::Matrix3 R_ecef_eci;
  };
  std::optional<Observed> earth_;
  fsw::Vector3 earth_rate_ecef_;  ///< angular velocity against ECI, rad/s
};

}  // namespace vbar::grand
