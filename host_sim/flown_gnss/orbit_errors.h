#pragma once
// Errors of the own orbit against a published one, by hour, with the consistency of the covariance.

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/flown_gnss/own_orbit.h"

namespace vbar::flown_gnss {

/// Sums over epochs.
struct ErrorSums {
  std::size_t epochs = 0;  ///< with an orbit of the filter
  std::size_t points = 0;  ///< with a single-point solution
  double point_squares_m2 = 0.0;
  fsw::Vector3 rtn_m = fsw::Vector3::Zero(), rtn_squares_m2 = fsw::Vector3::Zero();
  double nees = 0.0;  ///< of the position, three degrees of freedom
  double nis = 0.0;   ///< of single points, likewise

  void add(const ErrorSums& other);
  [[nodiscard]] double rms_m() const;        ///< of the position, 3D
  [[nodiscard]] double point_rms_m() const;  ///< of the single points, 3D
  [[nodiscard]] fsw::Vector3 mean_rtn_m() const;
  [[nodiscard]] fsw::Vector3 rms_rtn_m() const;
  [[nodiscard]] double mean_nees() const;
  [[nodiscard]] double mean_nis() const;
};

class OrbitErrors {
 public:
  /// `first`: begin of the first hour.
  explicit OrbitErrors(fsw::GpsTime first) : first_(first) {}

  /// Adds an epoch. `truth`: state of the centre of mass at the tag of the epoch, ECI; `antenna_eci`: position of the
  /// antenna then.
  void add(const OwnOrbitEpoch& epoch, const fsw::orbit::CartesianState& truth, const fsw::Vector3& antenna_eci);

  /// Sums of each hour, and of a span of hours [from, to).
  [[nodiscard]] const std::vector<ErrorSums>& hours() const { return hours_; }
  [[nodiscard]] ErrorSums of(std::size_t from_h, std::size_t to_h) const;
  /// Epochs as a table: time (s after the first), error and sigma in RTN (m), NEES, NIS, error of the single point (m),
  /// its satellites.
  [[nodiscard]] const std::string& csv() const { return csv_; }

 private:
  fsw::GpsTime first_;
  std::vector<ErrorSums> hours_;
  std::string csv_ = "time_s,r_m,t_m,n_m,sigma_r_m,sigma_t_m,sigma_n_m,nees,nis,point_error_m,point_satellites\n";
};

/// Returns the power spectral density (m^2/s^3, each axis) of the gravity beyond the degree of the flight software, 20,
/// at a distance from the Earth's centre, m: by Kaula's rule (1966) for the coefficients, 1e-5/n^2, and as white noise
/// of the same spectral density at low frequency. It grows by a factor of six from 700 to 460 km of altitude.
[[nodiscard]] double omitted_gravity_psd(double radius_m);

}  // namespace vbar::flown_gnss
