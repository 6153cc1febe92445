#pragma once
// A gravity field of degrees 2 to 4 whose coefficients change from call to call, as those of the tides do: small enough
// to be summed term by term, where GravityField prepares its series once.

#include <memory>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

/// Fully normalised coefficients, as in gravity_coefficients.h: c[n][m], s[n][m], 0 <= m <= n <= 4. Degrees 0 and 1 are
/// not used.
struct LowDegreeCoefficients {
  static constexpr int kDegree = 4;
  double c[kDegree + 1][kDegree + 1] = {};
  double s[kDegree + 1][kDegree + 1] = {};
};

/// Returns the acceleration, m/s^2 in ITRF, at a position (m, in ITRF, not the centre) in the field of `coefficients`
/// with gravitational parameter `gm` (m^3/s^2) and reference radius `radius` (m).
fsw::Vector3 acceleration_itrf(const LowDegreeCoefficients& coefficients, double gm, double radius,
                               const fsw::Vector3& position_itrf);

// The elastic response of the Earth to the Moon, the Sun and polar motion, as changes of the low degrees of its gravity
// field (IERS Conventions 2010, IERS Technical Note 36, chapter 6):
//   step 1   the same Love numbers for every frequency (section 6.2.1, eq. 6.6 and 6.7);
//   step 2   corrections for core resonance and anelasticity by frequency (eq. 6.8, tables 6.5a, b, c);
//   pole     the change of the centrifugal potential by polar motion, of the solid Earth and of the oceans
//            (sections 6.4 and 6.5, of the oceans degree 2 alone, nine tenths of it).
// Corrections to normalised coefficients. Not here: the ocean tides (section 6.3), which need a model of some hundred
// coefficients; their acceleration of a low satellite is about a tenth of the solid Earth's, some 3e-8 m/s^2.

/// Part of the permanent tide, the mean of the tide over time, that C20 of a gravity model contains: its deformation
/// (zero tide) or nothing (tide free).
enum class TideSystem { kZeroTide, kTideFree };

/// Returns the tide system of a coefficient file: "zero_tide" or "tide_free". Throws std::invalid_argument, naming
/// both, for another.
TideSystem tide_system_named(std::string_view name);

/// A body that raises tides.
struct TidalBody {
  double gm_per_earth_gm = 0.0;
  fsw::Vector3 position_itrf = fsw::Vector3::Zero();  ///< geocentric, m
};

/// Adds the part of step 1 by one body: degree 2 with the Love numbers of an anelastic Earth, degree 3, and degree 4 as
/// changed by the degree-2 tide through the Earth's flattening. `radius`: the gravity model's reference radius, m.
void add_love_number_response(const TidalBody& body, double radius, LowDegreeCoefficients& change);

/// Returns step 1's mean of C20 over all time (section 6.2.2, eq. 6.14): A0 H0 k20 = -4.2e-9. Step 1 contains the whole
/// tide, mean included; a zero-tide C20 contains the deformation of the mean already, so it is subtracted there, and
/// counted once.
double permanent_tide_c20();

/// Tides of step 2. The sums over the tables' 71 lines are e^(i m (GMST + pi)) times sums that change over days; those
/// are kept at hours of TT and interpolated by cubics: error under 1e-18, some 1e-5 of the tables' last digit. The
/// result depends on the date only. Not thread-safe: one object per thread.
class FrequencyDependentTides {
 public:
  /// Adds the corrections of an instant with Greenwich mean sidereal time `gmst`, rad.
  void add(JulianDate tt, double gmst, LowDegreeCoefficients& change);

 private:
  static constexpr int kNodes = 4;
  static constexpr int kSums = 5;  ///< zonal (real), diurnal and semidiurnal (real and imaginary)

  using Sums = Eigen::Matrix<double, kSums, 1>;
  static Sums sums_at(JulianDate tt);

  bool ready_ = false;
  double hour_ = 0.0;
  Sums nodes_[kNodes];
};

/// Adds the pole tides of a pole at (pole_x, pole_y), rad as in Earth orientation data, relative to the secular pole of
/// the Conventions (update of 2018 of section 7.1.4, the mean motion since 2000).
void add_pole_tides(double pole_x, double pole_y, JulianDate tt, LowDegreeCoefficients& change);

// The gravity of the tides of the solid Earth, and of the pole tides, as a force.

/// Force of the tides: one object per spacecraft, as it caches the sums of step 2.
class SolidTidesForce final : public Force {
 public:
  /// Makes the force from `gm` (m^3/s^2), `radius` (m) and `tide_system` of the gravity model that it goes with;
  /// `orientation` of the days to come must not be null.
  SolidTidesForce(double gm, double radius, TideSystem tide_system, fsw::GpsTime epoch,
                  std::shared_ptr<const EarthOrientationSeries> orientation);

  std::string_view name() const override { return "solid_tides"; }
  bool needs_sun_and_moon() const override { return true; }

  /// Throws std::out_of_range outside the Earth orientation data.
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

  /// Returns the change of the gravity model's coefficients that makes the acceleration.
  LowDegreeCoefficients coefficients(const ForceInput& input);

 private:
  double gm_;
  double radius_;
  TideSystem tide_system_;
  fsw::GpsTime epoch_;
  std::shared_ptr<const EarthOrientationSeries> orientation_;
  FrequencyDependentTides frequency_dependent_;
};

}  // namespace vbar::truth
