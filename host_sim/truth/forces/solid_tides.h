#pragma once
// The elastic response of the Earth to the Moon, the Sun and polar motion, as changes of the low degrees of its gravity
// field (IERS Conventions 2010, IERS Technical Note 36, chapter 6):
//   step 1   the same Love numbers for every frequency (section 6.2.1, eq. 6.6 and 6.7);
//   step 2   corrections for core resonance and anelasticity by frequency (eq. 6.8, tables 6.5a, b, c);
//   pole     the change of the centrifugal potential by polar motion, of the solid Earth and of the oceans
//            (sections 6.4 and 6.5, of the oceans degree 2 alone, nine tenths of it).
// Corrections to normalised coefficients. Not here: the ocean tides (section 6.3), which need a model of some hundred
// coefficients; their acceleration of a low satellite is about a tenth of the solid Earth's, some 3e-8 m/s^2.

#include <string_view>

#include "fsw/core/types.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/low_degree_field.h"

namespace vbar::truth {

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

}  // namespace vbar::truth
