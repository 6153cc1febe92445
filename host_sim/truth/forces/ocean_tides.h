#pragma once
// The gravity of the ocean tides (IERS Conventions 2010, section 6.3): changes of the coefficients of the gravity
// field,
//   dC_nm - i dS_nm = sum over waves of (C+ - i S+) e^(i theta) + (C- + i S-) e^(-i theta)   (eq. 6.15),
// theta the Doodson argument of a wave. Of the waves of the model alone, without those between them (admittances), and
// up to degree 8: most of what moves a satellite at 800 km, some 3e-8 m/s^2. The field is made at nodes ten minutes
// apart; its acceleration in between is interpolated by cubics, to 2e-6 of a wave of half a day.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/gravity_coefficients.h"

namespace vbar::truth {

inline constexpr int kOceanTideDegree = 8;

/// Coefficients of one wave at one degree and order, of normalised ones.
struct OceanTideTerm {
  int n = 0, m = 0;
  double c_plus = 0.0, s_plus = 0.0, c_minus = 0.0, s_minus = 0.0;
};

/// One wave: multipliers of Doodson's variables tau, s, h, p, N', p_s.
struct OceanTideWave {
  std::string doodson;
  std::array<int, 6> multipliers{};
  std::vector<OceanTideTerm> terms;
};

/// Reads the table of data/gravity/fes2004_8.txt. Throws std::runtime_error naming file, line and what is accepted.
[[nodiscard]] std::vector<OceanTideWave> load_ocean_tides(const std::filesystem::path& file);

/// As above, of a text. Throws files::FormatError.
[[nodiscard]] std::vector<OceanTideWave> read_ocean_tides(std::string_view text, const std::string& file);

/// Returns the sum of the waves, up to kOceanTideDegree, at an instant with Greenwich mean sidereal time `gmst`, rad.
[[nodiscard]] GravityCoefficients ocean_tide_coefficients(const std::vector<OceanTideWave>& waves, JulianDate tt,
                                                          double gmst);

class OceanTidesForce final : public Force {
 public:
  /// Makes the force from `gm` (m^3/s^2) and `radius` (m) of the gravity model; `waves` and `orientation` must not be
  /// null.
  OceanTidesForce(double gm, double radius, fsw::GpsTime epoch, std::shared_ptr<const std::vector<OceanTideWave>> waves,
                  std::shared_ptr<const EarthOrientationSeries> orientation);

  std::string_view name() const override { return "ocean_tides"; }

  /// Throws std::out_of_range outside the Earth orientation data.
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  const GravityField& node(std::int64_t index);

  double gm_;
  double radius_;
  fsw::GpsTime epoch_;
  std::shared_ptr<const std::vector<OceanTideWave>> waves_;
  std::shared_ptr<const EarthOrientationSeries> orientation_;
  std::map<std::int64_t, GravityField> nodes_;  ///< by the number of nodes after the epoch
};

}  // namespace vbar::truth
