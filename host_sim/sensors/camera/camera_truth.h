#pragma once
// The truth at each image's exposure, kept until the flight software has reported on that image.

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

class TruthRecorder {
 public:
  /// Keeps the truth of an exposure, once for each image: two cameras may expose at the same time.
  void keep(const twins::TruthSnapshot& truth) { kept_.emplace(truth.time, truth); }

  /// Returns the truth of an exposure and releases it. If there is none, the exposure is counted and the result empty.
  std::optional<twins::TruthSnapshot> take(fsw::GpsTime exposure) {
    auto node = kept_.extract(exposure);
    if (node) return std::move(node.mapped());
    ++without_truth_;
    return std::nullopt;
  }

  /// Returns the number of images whose truth was asked for and missing.
  [[nodiscard]] int without_truth() const { return without_truth_; }
  [[nodiscard]] std::size_t size() const { return kept_.size(); }

 private:
  std::multimap<fsw::GpsTime, twins::TruthSnapshot> kept_;
  int without_truth_ = 0;
};

// What was true of a camera and its target at an exposure, to judge by what the flight software made of the image.

/// Radius of the sphere about the centre of mass of Tango, the spacecraft that cameras see here, that holds its body
/// and antennas.
inline constexpr double kSpacecraftRadius_m = 0.73;

/// A camera in orbit at the middle of an exposure.
struct TrueCamera {
  fsw::Vector3 position_eci = fsw::Vector3::Zero();
  Eigen::Quaterniond q_camera_eci = Eigen::Quaterniond::Identity();

  [[nodiscard]] fsw::Vector3 towards(const twins::SpacecraftTruth& other) const {
    return other.orbit.position_eci - position_eci;
  }
};

/// Returns the true camera at an exposure. `servicer` must have an attitude.
[[nodiscard]] TrueCamera true_camera(const CameraSensor& camera, const twins::SpacecraftTruth& servicer);

/// Returns the image point of a direction by pinhole and Brown-Conrady distortion, forwards (Brown 1966); none behind
/// the camera.
[[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const twins::camera::CameraSettings& settings,
                                                      const fsw::Vector3& los_camera);

/// Returns the symmetric matrix whose lower triangle by rows a packet carries.
[[nodiscard]] fsw::Matrix6 symmetric(const double (&lower_triangle)[21]);

/// Returns Error' covariance^-1 error; none for a covariance that is not positive definite.
[[nodiscard]] std::optional<double> normalised_square(const fsw::Vector6& error, const fsw::Matrix6& covariance);

/// Returns the normalised estimation error squared of osculating ROE times the servicer's osculating semi-major axis
/// (m), six degrees of freedom. (Another semi-major axis, such as the mission's mean one, differs by up to 10 km: an
/// error of a thousandth of the elements, which exceeds the standard deviations of navigation.)
[[nodiscard]] std::optional<double> nees_of_roe(const double (&a_roe_m)[6], const double (&covariance_m2)[21],
                                                const fsw::orbit::CartesianState& servicer,
                                                const fsw::orbit::CartesianState& target);

// The truth of an image that the flight software has processed: the place of the target, and the errors of bearing,
// attitude and estimate.

/// Fills the true part of `row` (range, errors, the object that is the target, the spacecraft that was chosen, NEES)
/// from the truth at the exposure. The truth must hold `servicer` and the spacecraft that it observes; without them, or
/// without an attitude, `row` stays as it is. `known`: the camera as calibrated on the ground; that of a testbed is
/// another than the mission's. `objects`: those of the same image, null if telemetry did not report them.
void add_truth(ImageRow& row, const telemetry_image& image, const telemetry_objects* objects, const CameraSensor& known,
               const mission::Spacecraft& servicer, const twins::TruthSnapshot& truth);

// Telemetry of a pose and its keypoints, and their truth.

/// Appends eleven rows, without the truth.
void append_keypoints(double exposure_s, const telemetry_pose& pose, std::vector<KeypointRow>& rows);

/// Sets what was true at the exposure beside the row and the last eleven of `keypoints`, the row's own.
/// `keypoints_body_m`: from the target's centre of mass, as telecommanded. `known`: the lens through which the
/// keypoints were seen; that of a testbed's camera is another than the mission's. Nothing where the truth lacks an
/// attitude.
void add_truth(PoseRow& row, std::vector<KeypointRow>& keypoints, const telemetry_pose& pose,
               const double (&keypoints_body_m)[33], const CameraSensor& known, const mission::Spacecraft& servicer,
               const twins::TruthSnapshot& truth);

}  // namespace vbar::sensors
