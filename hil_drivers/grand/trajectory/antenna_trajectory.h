#pragma once
// Motion of the true phase centre of one spacecraft's antenna, from the truth about its body.

#include <cstdint>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/trajectory/phase_centre_noise.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::grand {

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
};

}  // namespace vbar::grand
