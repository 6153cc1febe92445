#include "host_sim/truth/forces/solid_tides.h"

#include <array>
#include <cmath>
#include <complex>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <erfa.h>
#include <erfam.h>

#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/solid_tide_tables.h"

namespace vbar::truth {

namespace {

constexpr int kTop = LowDegreeCoefficients::kDegree + 1;  // the gradient reaches one degree higher

/// Unnormalised solid harmonics V_nm + i W_nm = (R/r)^(n+1) P_nm(sin latitude) e^(i m longitude).
struct SolidHarmonics {
  double v[kTop + 1][kTop + 1] = {};
  double w[kTop + 1][kTop + 1] = {};
};

/// Recursions of Cunningham 1970; Montenbruck and Gill 2000, eq. 3.29 to 3.31.
SolidHarmonics solid_harmonics(double radius, const fsw::Vector3& position) {
  const double r2 = position.squaredNorm();
  const double q = radius * radius / r2;
  const fsw::Vector3 p = radius / r2 * position;
  SolidHarmonics h;
  h.v[0][0] = std::sqrt(q);
  for (int m = 0; m <= kTop; ++m) {
    if (m > 0) {
      h.v[m][m] = (2 * m - 1) * (p.x() * h.v[m - 1][m - 1] - p.y() * h.w[m - 1][m - 1]);
      h.w[m][m] = (2 * m - 1) * (p.x() * h.w[m - 1][m - 1] + p.y() * h.v[m - 1][m - 1]);
    }
    for (int n = m + 1; n <= kTop; ++n) {
      const double before_last_v = n > m + 1 ? h.v[n - 2][m] : 0.0;
      const double before_last_w = n > m + 1 ? h.w[n - 2][m] : 0.0;
      h.v[n][m] = ((2 * n - 1) * p.z() * h.v[n - 1][m] - (n + m - 1) * q * before_last_v) / (n - m);
      h.w[n][m] = ((2 * n - 1) * p.z() * h.w[n - 1][m] - (n + m - 1) * q * before_last_w) / (n - m);
    }
  }
  return h;
}

/// sqrt((2 - delta_0m) (2n + 1) (n - m)! / (n + m)!): normalised over unnormalised Legendre function.
using Normalisation =
    std::array<std::array<double, LowDegreeCoefficients::kDegree + 1>, LowDegreeCoefficients::kDegree + 1>;

Normalisation make_normalisation() {
  Normalisation factor{};
  for (int n = 0; n <= LowDegreeCoefficients::kDegree; ++n) {
    double square = 2.0 * n + 1.0;
    for (int m = 0; m <= n; ++m) {
      if (m == 1) square *= 2.0;
      if (m > 0) square /= static_cast<double>(n + m) * (n - m + 1);
      factor[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)] = std::sqrt(square);
    }
  }
  return factor;
}

}  // namespace

fsw::Vector3 acceleration_itrf(const LowDegreeCoefficients& coefficients, double gm, double radius,
                               const fsw::Vector3& position_itrf) {
  static const Normalisation normalisation = make_normalisation();
  const SolidHarmonics h = solid_harmonics(radius, position_itrf);
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (int n = 2; n <= LowDegreeCoefficients::kDegree; ++n) {
    for (int m = 0; m <= n; ++m) {
      const double factor = normalisation[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)];
      const double c = factor * coefficients.c[n][m], s = factor * coefficients.s[n][m];
      // Montenbruck and Gill 2000, eq. 3.33.
      if (m == 0) {
        sum.x() -= c * h.v[n + 1][1];
        sum.y() -= c * h.w[n + 1][1];
      } else {
        const double down = (n - m + 1.0) * (n - m + 2.0);
        sum.x() += 0.5 * (-c * h.v[n + 1][m + 1] - s * h.w[n + 1][m + 1] +
                          down * (c * h.v[n + 1][m - 1] + s * h.w[n + 1][m - 1]));
        sum.y() += 0.5 * (-c * h.w[n + 1][m + 1] + s * h.v[n + 1][m + 1] +
                          down * (-c * h.w[n + 1][m - 1] + s * h.v[n + 1][m - 1]));
      }
      sum.z() += (n - m + 1) * (-c * h.v[n + 1][m] - s * h.w[n + 1][m]);
    }
  }
  return gm / (radius * radius) * sum;
}

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kArcsec = kPi / 180.0 / 3600.0;

/// IERS Conventions 2010, table 6.3, anelastic Earth. k_30 to k_32 are 0.093, k_33 is 0.094, all real.
struct LoveNumber {
  double real, imaginary;
  double plus;  ///< response of degree 4, raised by the tide of degree 2
};
constexpr LoveNumber kLove2[3] = {
    {0.30190, 0.0, -0.00089}, {0.29830, -0.00144, -0.00080}, {0.30102, -0.00130, -0.00057}};
constexpr double kLove3[4] = {0.093, 0.093, 0.093, 0.094};

/// Normalised associated Legendre functions of degrees 2 and 3 over cos^m(latitude), at z = sin(latitude). From their
/// definition: the ratio to the unnormalised one is sqrt((2 - delta_0m) (2n + 1) (n - m)! / (n + m)!).
struct LegendreOverCosine {
  double p2[3];
  double p3[4];
};

LegendreOverCosine legendre_over_cosine(double z) {
  const double z2 = z * z;
  return {{std::sqrt(5.0) * 0.5 * (3.0 * z2 - 1.0), std::sqrt(15.0) * z, std::sqrt(15.0) / 2.0},
          {std::sqrt(7.0) * 0.5 * z * (5.0 * z2 - 3.0), std::sqrt(42.0) / 4.0 * (5.0 * z2 - 1.0),
           std::sqrt(105.0) / 2.0 * z, std::sqrt(70.0) / 4.0}};
}

/// Sum over a table's lines of (in phase + i out of phase) e^(-i sum n_j F_j).
std::complex<double> slow_sum(std::span<const TidalLine> lines, const double (&delaunay)[5]) {
  std::complex<double> sum = 0.0;
  for (const TidalLine& line : lines) {
    double argument = 0.0;
    for (int i = 0; i < 5; ++i) argument -= line.n[i] * delaunay[i];
    sum += 1e-12 * std::complex<double>(line.in_phase, line.out_of_phase) * std::polar(1.0, argument);
  }
  return sum;
}

}  // namespace

TideSystem tide_system_named(std::string_view name) {
  if (name == "zero_tide") return TideSystem::kZeroTide;
  if (name == "tide_free") return TideSystem::kTideFree;
  throw std::invalid_argument(R"(tide system ")" + std::string(name) +
                              R"("; accepted are "zero_tide" and "tide_free")");
}

void add_love_number_response(const TidalBody& body, double radius, LowDegreeCoefficients& change) {
  const double distance = body.position_itrf.norm();
  const fsw::Vector3 direction = body.position_itrf / distance;
  const LegendreOverCosine p = legendre_over_cosine(direction.z());
  const double nearness = radius / distance;
  const double strength2 = body.gm_per_earth_gm * nearness * nearness * nearness / 5.0;
  const double strength3 = body.gm_per_earth_gm * nearness * nearness * nearness * nearness / 7.0;

  // cos^m(latitude) e^(-i m longitude)
  const std::complex<double> turn(direction.x(), -direction.y());
  std::complex<double> turn_m = 1.0;
  for (int m = 0; m <= 3; ++m, turn_m *= turn) {
    if (m <= 2) {
      const std::complex<double> tide = strength2 * p.p2[m] * turn_m;
      const std::complex<double> answer = std::complex<double>(kLove2[m].real, kLove2[m].imaginary) * tide;
      change.c[2][m] += answer.real();
      change.s[2][m] -= answer.imag();
      change.c[4][m] += kLove2[m].plus * tide.real();
      change.s[4][m] -= kLove2[m].plus * tide.imag();
    }
    const std::complex<double> answer = kLove3[m] * strength3 * p.p3[m] * turn_m;
    change.c[3][m] += answer.real();
    change.s[3][m] -= answer.imag();
  }
}

double permanent_tide_c20() {
  constexpr double kA0 = 4.4228e-8;   // 1/m
  constexpr double kH0 = -0.31460;    // m, Cartwright-Tayler amplitude of the permanent tide
  return kA0 * kH0 * kLove2[0].real;  // eq. 6.14
}

FrequencyDependentTides::Sums FrequencyDependentTides::sums_at(JulianDate tt) {
  const double centuries = ((tt.day - ERFA_DJ00) + tt.fraction) / ERFA_DJC;
  const double delaunay[5] = {eraFal03(centuries), eraFalp03(centuries), eraFaf03(centuries), eraFad03(centuries),
                              eraFaom03(centuries)};
  const std::complex<double> zonal = slow_sum(kZonalTides, delaunay);
  const std::complex<double> diurnal = slow_sum(kDiurnalTides, delaunay);
  const std::complex<double> semidiurnal = slow_sum(kSemidiurnalTides, delaunay);
  Sums sums;
  sums << zonal.real(), diurnal.real(), diurnal.imag(), semidiurnal.real(), semidiurnal.imag();
  return sums;
}

void FrequencyDependentTides::add(JulianDate tt, double gmst, LowDegreeCoefficients& change) {
  const double hours = ((tt.day - ERFA_DJ00) + tt.fraction) * 24.0;
  const double hour = std::floor(hours);
  if (!ready_ || hour != hour_) {
    for (int i = 0; i < kNodes; ++i) nodes_[i] = sums_at({ERFA_DJ00, (hour + i - 1.0) / 24.0});
    hour_ = hour;
    ready_ = true;
  }
  const double u = hours - hour;  // Lagrange's cubic through the nodes -1, 0, 1, 2
  const Sums sums = -u * (u - 1.0) * (u - 2.0) / 6.0 * nodes_[0] + (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * nodes_[1] -
                    (u + 1.0) * u * (u - 2.0) / 2.0 * nodes_[2] + (u + 1.0) * u * (u - 1.0) / 6.0 * nodes_[3];

  // Eq. 6.8: C_2m - i S_2m = eta_m sum, with eta_1 = -i, eta_2 = 1.
  const std::complex<double> day = std::polar(1.0, gmst + kPi);
  const std::complex<double> diurnal = std::complex<double>(0.0, -1.0) * std::complex<double>(sums[1], sums[2]) * day;
  const std::complex<double> semidiurnal = std::complex<double>(sums[3], sums[4]) * day * day;
  change.c[2][0] += sums[0];
  change.c[2][1] += diurnal.real();
  change.s[2][1] -= diurnal.imag();
  change.c[2][2] += semidiurnal.real();
  change.s[2][2] -= semidiurnal.imag();
}

void add_pole_tides(double pole_x, double pole_y, JulianDate tt, LowDegreeCoefficients& change) {
  // Secular pole, arcsec: IERS Conventions 2010, section 7.1.4 as updated on 2018-02-01, eq. 21.
  const double years = ((tt.day - ERFA_DJ00) + tt.fraction) / ERFA_DJY;
  const double secular_x = 0.0550 + 0.001677 * years;
  const double secular_y = 0.3205 + 0.003460 * years;
  const double m1 = pole_x / kArcsec - secular_x;
  const double m2 = -(pole_y / kArcsec - secular_y);
  // Solid Earth, section 6.4; oceans, eq. 6.24.
  change.c[2][1] += -1.333e-9 * (m1 + 0.0115 * m2) - 2.1778e-10 * (m1 - 0.01724 * m2);
  change.s[2][1] += -1.333e-9 * (m2 - 0.0115 * m1) - 1.7232e-10 * (m2 - 0.03365 * m1);
}

SolidTidesForce::SolidTidesForce(double gm, double radius, TideSystem tide_system, fsw::GpsTime epoch,
                                 std::shared_ptr<const EarthOrientationSeries> orientation)
    : gm_(gm), radius_(radius), tide_system_(tide_system), epoch_(epoch), orientation_(std::move(orientation)) {
  if (!orientation_) throw std::invalid_argument("the solid tides need Earth orientation data");
}

LowDegreeCoefficients SolidTidesForce::coefficients(const ForceInput& input) {
  const EarthOrientation orientation = orientation_->at(epoch_, input.seconds);
  const JulianDate tt = tt_of(epoch_, input.seconds);
  const JulianDate ut1 = ut1_of(tai_of(epoch_, input.seconds), orientation.ut1_minus_tai_s);

  LowDegreeCoefficients change;
  add_love_number_response({kMoonGm / gm_, input.R_itrf_gcrf * input.moon_eci}, radius_, change);
  add_love_number_response({kSunGm / gm_, input.R_itrf_gcrf * input.sun_eci}, radius_, change);
  frequency_dependent_.add(tt, eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction), change);
  add_pole_tides(orientation.pole_x, orientation.pole_y, tt, change);
  if (tide_system_ == TideSystem::kZeroTide) change.c[2][0] -= permanent_tide_c20();
  return change;
}

fsw::Vector3 SolidTidesForce::acceleration_eci(const ForceInput& input) {
  return input.R_itrf_gcrf.transpose() * acceleration_itrf(coefficients(input), gm_, radius_, input.position_itrf);
}

}  // namespace vbar::truth
