#pragma once
// The absolute orbit filter estimates the servicer's own orbit from the single-point positions of its receiver.
//
// State: x = [r(3) m, v(3) m/s, g(3) m], ECI; g is the slowly varying error of single-point positions (broadcast orbits
// and clocks, ionosphere), a first-order Gauss-Markov process. Measurement: z = r + g + noise, at reception.
//
// An orbit that took these errors for white noise would underestimate its covariance, and the a-priori orbit of the
// target would be referred to a wrong one. It is re-initialised by its own failure only, never by a change of sensors.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/filter/burn.h"
#include "fsw/filter/propagation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::filter {

struct AbsoluteOrbitSettings {
  double slow_error_sigma_m = 1.5;    ///< slow error of single-point positions, per axis
  double slow_error_time_s = 1800.0;  ///< its correlation time
  double acceleration_psd = 1e-9;     ///< m^2/s^3: Sun, Moon and tides, 1.5e-6 m/s^2 that vary with the orbit
  double start_velocity_sigma = 5.0;  ///< m/s, of the velocity from the first two positions
  double gate = 25.0;                 ///< normalised innovation squared of a position: 5 sigma of three degrees
};

/// A single-point position of the servicer's centre of mass.
struct AbsolutePosition {
  Vector3 position_eci = Vector3::Zero();       ///< m, at reception
  Matrix3 covariance_m2 = Matrix3::Identity();  ///< covariance of the noise; the slow error is a state
  double early_s = 0.0;                         ///< the position is this much before the tag: the receiver clock
};

class AbsoluteOrbitFilter {
 public:
  using Estimate = estimation::Estimate<9>;

  void configure(const AbsoluteOrbitSettings& settings) { settings_ = settings; }

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] orbit::CartesianState state() const {
    return {.position_eci = estimate_.mean().head<3>(), .velocity_eci = estimate_.mean().segment<3>(3)};
  }
  /// Covariance of position and velocity, ECI, m and m/s.
  [[nodiscard]] Matrix6 covariance() const { return estimate_.head_covariance<6>(); }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  /// Number of times that consecutive positions contradicted the orbit.
  [[nodiscard]] int inflations() const { return inflations_; }

  /// Initialises with a known state; `sigma_m` and `sigma_mps` per axis.
  void initialize(const orbit::CartesianState& state, double sigma_m, double sigma_mps);

  /// Processes a position at the epoch. The second one within two minutes initialises the orbit; one beyond the gate is
  /// rejected (false), and the last of kMaxRejected consecutive rejections inflates the covariance in order to be used.
  bool process(GpsTime time, const AbsolutePosition& measured);

  /// Normalised innovation squared of the last position, three degrees of freedom; 0 of one that initialises the orbit.
  [[nodiscard]] double nis() const { return nis_; }

  /// Propagates by `dt` s, with the thrust on all of it.
  void advance(const filter::Propagation& propagation, double dt, const filter::Thrust& thrust = {});
  /// Adds a burn (m/s, ECI), known to `sigma` per axis.
  void add_impulse(const Vector3& dv_eci, double sigma);

  static constexpr int kMaxRejected = 6;

 private:
  struct First {
    bool is_known = false;
    GpsTime time;
    AbsolutePosition position;
  };

  void initialize_from_two(GpsTime time, const AbsolutePosition& measured);
  void widen(double residual_m);
  void fail();

  AbsoluteOrbitSettings settings_;
  bool started_ = false;
  First first_;
  int rejected_in_a_row_ = 0;
  int inflations_ = 0;
  double nis_ = 0.0;
  Estimate estimate_;
};

}  // namespace vbar::fsw::filter
