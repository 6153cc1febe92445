#pragma once
// What was true of a camera and its target at an exposure, to judge by what the flight software made of the image.

#include <array>
#include <optional>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

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

}  // namespace vbar::sensors
