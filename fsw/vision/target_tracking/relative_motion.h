#pragma once
// Relative motion from a sequence of bearings, up to scale: the state of every hypothesis of the tracker.
//
// Bearings of a near-circular relative orbit determine the relative elements up to their scale (Woffinden, Geller
// 2009), so the state is s = [da, dex, dey, dix, diy] / dlambda. With u the servicer's argument of latitude the linear
// map of D'Amico (2010) gives the slopes as exact ratios,
//   y = path_slope - T / (2 a) + (s0 - s1 cos u - s2 sin u) / den,   z = (s3 sin u - s4 cos u) / den,
//   den = 1 + 2 s1 sin u - 2 s2 cos u,
// which multiplied by den are linear in s for a measured slope: a linear filter needs no initial value. T / (2 a) is
// the bend of the orbit between the two. These are the regressors 1, t, cos u, sin u of bearing-only curve fitting with
// their coefficients constrained to one orbit, valid also if the range varies by a fraction of itself within an orbit.

#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/components.h"
#include "fsw/vision/target_tracking/prediction.h"

namespace vbar::fsw::target_tracking {

// Inputs of target tracking at an image: the objects that are not identified stars, and the servicer's own burns.

inline constexpr std::size_t kMaxCandidates = imaging::kMaxObjects;

/// An object of the image that is not an identified star.
struct Candidate {
  Vector3 direction_rtn = Vector3::UnitX();  ///< unit vector from the servicer, in its RTN at the image's time
  double sigma = 0.0;                        ///< rad, 1 sigma of the direction, each axis: centroid and attitude
  double apparent_radius = 0.0;              ///< rad, of its light, without the point-spread function
  imaging::DetectedObject object;            ///< for brightness and for learning hot pixels
};

/// An impulse of the servicer.
struct OwnBurn {
  GpsTime time;
  Vector3 dv_rtn = Vector3::Zero();  ///< m/s, servicer's RTN at its time
  double sigma = 0.0;                ///< m/s, 1 sigma per axis
};

using Matrix25 = Eigen::Matrix<double, 2, 5>;

struct MotionSettings {
  double shape_sigma = 0.08;     ///< 1 sigma of each element of s before the first bearing
  double model_sigma = 5e-5;     ///< rad, added to each bearing: modelling errors from image to image
  double drift_sigma = 1e-4;     ///< 1 sigma of each element of s after an orbit: random walk
  double drift_fraction = 3e-3;  ///< its part proportional to |s|: J2 rotates the relative eccentricity and inclination
};

struct RelativeMotion {
  Vector5 shape = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
};

/// Residual of the measured slopes with respect to the predicted ones.
struct Innovation {
  Vector2 residual = Vector2::Zero();
  Matrix2 covariance = Matrix2::Identity();
  Matrix25 jacobian = Matrix25::Zero();
  double distance = 0.0;     ///< residual' covariance^-1 residual
  double determinant = 1.0;  ///< determinant of the covariance
};

/// Slopes of a candidate, as a measurement.
struct SlopeMeasurement {
  Vector2 slopes = Vector2::Zero();
  Vector2 variance = Vector2::Zero();
};

/// Returns the measurement of a unit vector with 1 sigma (rad) of each axis. Errors are those of slopes_of; kOutOfRange
/// for sigma <= 0.
Result<SlopeMeasurement> slope_measurement(const Vector3& direction_rtn, double sigma, const MotionSettings& settings);

/// Returns the state before the first bearing: only the size of the elements is known.
RelativeMotion unknown_motion(const MotionSettings& settings);

/// Propagates by `dt` seconds. Returns false if the target would pass the servicer: the state is then invalid.
bool propagate(RelativeMotion& motion, const ServicerView& view, double dt, const MotionSettings& settings);

/// Applies an own burn at argument of latitude `latitude` (rad). Without `along_track_m` (0) the elements are almost
/// reset.
void apply_burn(RelativeMotion& motion, const OwnBurn& burn, double latitude, const ServicerView& view,
                const Prediction& prediction, const MotionSettings& settings);

/// Returns the innovation of a measurement. `bend` is -T / (2 a).
Innovation innovation_of(const RelativeMotion& motion, const ServicerView& view, double bend,
                         const SlopeMeasurement& measurement);

/// Updates state and covariance by the Kalman equations.
void update(RelativeMotion& motion, const Innovation& innovation);

/// Predicted slopes and rates with covariance, as in a prediction (in axes that rotate about N only). `bend_rate` is
/// the rate of `bend`, 1/s. They represent all five elements of s, so that they discriminate between orbits at any
/// time.
struct SlopeState {
  Vector5 slopes = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  Matrix5 jacobian = Matrix5::Zero();  ///< with respect to s
};
SlopeState slope_state(const RelativeMotion& motion, const ServicerView& view, double bend, double bend_rate);

/// 1-sigma floors of slopes and of rates (1/s): errors common to all images.
struct SlopeFloors {
  double slope = 0.0;
  double rate = 0.0;
};

/// Normal distribution of a difference of slopes and rates. Very large if its covariance is not regular.
struct SlopeDistance {
  double square = 0.0;           ///< difference' (covariance + floors)^-1 difference
  double log_determinant = 0.0;  ///< ln of the determinant of covariance + floors, except for a constant
};
SlopeDistance slope_distance(const Vector5& difference, const Matrix5& covariance, const SlopeFloors& floors);

}  // namespace vbar::fsw::target_tracking
