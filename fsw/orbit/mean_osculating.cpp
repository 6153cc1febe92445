#include "fsw/orbit/mean_osculating.h"

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/roe.h"

// Brouwer's first-order formulas are written with e, w and M, which are not defined on a circular orbit. The quantities
// that they change, the eccentricity vector and the mean argument of latitude, are. So the corrections are applied as
// changes of those:
//   (ex + i ey)' = exp(i du) [ex + i ey + (de - i e dM) exp(i w)],
// which is the usual recombination of e, M and w through (e + de, e dM), with the mean anomaly eliminated. At e = 0 the
// direction of perigee is then any direction.

namespace vbar::fsw::orbit {
namespace {

constexpr double kMaxTheoryEccentricity = 0.9;
constexpr double kMinInclinationDistance = 1e-4;  ///< rad, from 0 and from pi
constexpr double kCriticalBand = 0.02;            ///< width in |1 - 5 cos^2 i|: long-period terms are resonant
constexpr double kTolerance = 1e-12;
constexpr int kMaxIterations = 30;

enum class Direction { kMeanToOsculating, kOsculatingToMean };

/// Sine and cosine of half the inclination carry it without loss near 0 and pi.
struct Inclination {
  double sin_half, cos_half, sin, cos;
};

/// First-order changes. e-vector and longitude before the common rotation by du.
struct Corrections {
  double da_over_a = 0.0;
  double dex = 0.0;
  double dey = 0.0;
  double di = 0.0;
  double draan = 0.0;
  double dlongitude = 0.0;  ///< change of w + M + raan
};

Inclination inclination(double i) {
  const double s = math::sin(0.5 * i);
  const double c = math::cos(0.5 * i);
  return {.sin_half = s, .cos_half = c, .sin = 2.0 * s * c, .cos = (c - s) * (c + s)};
}

/// Terms in 2w. Every one carries e^2, or e in the eccentricity vector, and so is regular at e = 0.
Corrections long_period(const QnsElements& q, const Inclination& incl, double eta, double g2p) {
  Corrections d;
  const double c2 = incl.cos * incl.cos;
  const double divisor = 1.0 - 5.0 * c2;
  if (math::abs(divisor) < kCriticalBand) return d;
  const double e2_cos_2w = q.ex * q.ex - q.ey * q.ey;
  const double e2_sin_2w = 2.0 * q.ex * q.ey;
  const double c4 = c2 * c2;
  const double l = 1.0 - 11.0 * c2 - 40.0 * c4 / divisor;
  const double m = 1.0 - 33.0 * c2 - 200.0 * c4 / divisor - 400.0 * c4 * c2 / (divisor * divisor);
  const double eta2 = eta * eta;

  // de = g2'/8 l eta^2 e cos 2w and e dM = g2'/8 l eta^3 e sin 2w, along and across the e-vector.
  const double e2 = q.ex * q.ex + q.ey * q.ey;
  if (e2 > 0.0) {
    const double de_over_e = g2p / 8.0 * l * eta2 * e2_cos_2w / e2;
    const double dm = g2p / 8.0 * l * eta2 * eta * e2_sin_2w / e2;
    d.dex = de_over_e * q.ex + dm * q.ey;
    d.dey = de_over_e * q.ey - dm * q.ex;
  }
  d.di = -g2p / 8.0 * l * e2_cos_2w * incl.cos / incl.sin;
  d.draan = -g2p / 8.0 * e2_sin_2w * incl.cos * (11.0 + 80.0 * c2 / divisor + 200.0 * c4 / (divisor * divisor));
  // g2'/8 eta^3 l - g2'/16 (2 l + e^2 m), with 1 - eta^3 = e^2 (1 + eta + eta^2) / (1 + eta).
  d.dlongitude = d.draan - g2p / 8.0 * e2_sin_2w * ((1.0 + eta + eta2) / (1.0 + eta) * l + 0.5 * m);
  return d;
}

/// Terms in the true anomaly.
Corrections short_period(const QnsElements& q, const Inclination& incl, const InPlane& point, double g2, double g2p) {
  const double e = math::hypot(q.ex, q.ey);
  const double cos_w = e > 0.0 ? q.ex / e : 1.0;
  const double sin_w = e > 0.0 ? q.ey / e : 0.0;
  const double cos_th = point.cos_theta;
  const double sin_th = point.sin_theta;
  const double cos_f = cos_th * cos_w + sin_th * sin_w;
  const double sin_f = sin_th * cos_w - cos_th * sin_w;
  const double cos_2th = (cos_th - sin_th) * (cos_th + sin_th);
  const double sin_2th = 2.0 * sin_th * cos_th;
  const double cos_2w_f = cos_th * cos_w - sin_th * sin_w;
  const double sin_2w_f = sin_th * cos_w + cos_th * sin_w;
  const double cos_2w_3f = cos_2th * cos_f - sin_2th * sin_f;
  const double sin_2w_3f = sin_2th * cos_f + cos_2th * sin_f;

  const double eta = point.eta;
  const double eta2 = eta * eta;
  const double a_over_r = 1.0 / point.radius_over_a;
  const double c2 = incl.cos * incl.cos;
  const double s2 = incl.sin * incl.sin;
  const double zonal = 3.0 * c2 - 1.0;
  const double a_over_r3 = a_over_r * a_over_r * a_over_r;

  // Equation of the centre: theta - u is f - M.
  const double cos_u = math::cos(q.u);
  const double sin_u = math::sin(q.u);
  const double centre = math::atan2(sin_th * cos_u - cos_th * sin_u, cos_th * cos_u + sin_th * sin_u) + e * sin_f;
  const double sine_sum = 3.0 * sin_2th + 3.0 * e * sin_2w_f + e * sin_2w_3f;

  const double cubic = 3.0 * cos_f + 3.0 * e * cos_f * cos_f + e * e * cos_f * cos_f * cos_f;
  const double de = 0.5 * g2p *
                    (zonal * (e * eta + e / (1.0 + eta) + cubic) + 3.0 * s2 * (e + cubic) * cos_2th -
                     eta2 * s2 * (3.0 * cos_2w_f + cos_2w_3f));
  const double y = a_over_r * a_over_r * eta2 + a_over_r;
  const double bracket =
      2.0 * zonal * (y + 1.0) * sin_f + 3.0 * s2 * ((1.0 - y) * sin_2w_f + (y + 1.0 / 3.0) * sin_2w_3f);
  const double e_dm = -0.25 * g2p * eta2 * eta * bracket;

  Corrections d;
  d.da_over_a = g2 * (zonal * (a_over_r3 - 1.0 / (eta2 * eta)) + 3.0 * s2 * a_over_r3 * cos_2th);
  d.dex = de * cos_w + e_dm * sin_w;
  d.dey = de * sin_w - e_dm * cos_w;
  d.di = 0.5 * g2p * incl.cos * incl.sin * (3.0 * cos_2th + 3.0 * e * cos_2w_f + e * cos_2w_3f);
  d.draan = -0.5 * g2p * incl.cos * (6.0 * centre - sine_sum);
  d.dlongitude = d.draan + 0.25 * g2p * (-6.0 * (1.0 - 5.0 * c2) * centre + (3.0 - 5.0 * c2) * sine_sum) +
                 0.25 * g2p * e * eta2 / (1.0 + eta) * bracket;  // the term that Schaub & Junkins (F.11) lacks
  return d;
}

/// Node and inclination change through (sin(i/2) exp(i raan)), regular at i = 0; then the common rotation of the
/// e-vector.
QnsElements apply(const QnsElements& q, const Inclination& incl, const Corrections& d) {
  const double along = incl.sin_half + 0.5 * incl.cos_half * d.di;
  const double across = incl.sin_half * d.draan;
  const double draan = math::atan2(across, along);
  // sin^2(i'/2) = sin^2(i/2) + growth, from which i' - i follows without cancellation.
  const double growth =
      incl.sin_half * incl.cos_half * d.di + 0.25 * incl.cos_half * incl.cos_half * d.di * d.di + across * across;
  const double sin_half = math::sqrt(incl.sin_half * incl.sin_half + growth);
  const double cos_half = math::sqrt(incl.cos_half * incl.cos_half - growth);
  const double di = 2.0 * math::asin(growth / (sin_half * incl.cos_half + cos_half * incl.sin_half));

  const double du = d.dlongitude - draan;
  const double cos_du = math::cos(du);
  const double sin_du = math::sin(du);
  const double ex = q.ex + d.dex;
  const double ey = q.ey + d.dey;
  return {.a = q.a * (1.0 + d.da_over_a),
          .ex = ex * cos_du - ey * sin_du,
          .ey = ex * sin_du + ey * cos_du,
          .i = q.i + di,
          .raan = q.raan + draan,
          .u = q.u + du};
}

Result<QnsElements> brouwer(const QnsElements& q, Direction direction) {
  if (!math::is_finite(q.a) || !math::is_finite(q.i) || !math::is_finite(q.raan)) return Status::kNotFinite;
  const Result<InPlane> point = in_plane(q);
  if (!point.ok()) return point.status();
  if (q.a <= 0.0 || q.ex * q.ex + q.ey * q.ey >= kMaxTheoryEccentricity * kMaxTheoryEccentricity ||
      q.i < kMinInclinationDistance || q.i > math::kPi - kMinInclinationDistance) {
    return Status::kOutOfRange;
  }

  const double radii = kEarthRadius / q.a;
  const double sign = direction == Direction::kMeanToOsculating ? 1.0 : -1.0;
  const double g2 = sign * 0.5 * kJ2 * radii * radii;
  const double eta = point.value().eta;
  const double g2p = g2 / (eta * eta * eta * eta);
  const Inclination incl = inclination(q.i);
  const Corrections slow = long_period(q, incl, eta, g2p);
  Corrections d = short_period(q, incl, point.value(), g2, g2p);
  d.dex += slow.dex;
  d.dey += slow.dey;
  d.di += slow.di;
  d.draan += slow.draan;
  d.dlongitude += slow.dlongitude;
  const QnsElements image = apply(q, incl, d);
  // Far below the Earth's surface the first order is no longer small, and its result is not a valid orbit.
  if (!(image.a > 0.0) || !math::is_finite(image.i) || !math::is_finite(image.u)) return Status::kOutOfRange;
  return image;
}

}  // namespace

Result<QnsElements> osculating_from_mean(const QnsElements& mean) {
  return brouwer(mean, Direction::kMeanToOsculating);
}

Result<QnsElements> mean_from_osculating(const QnsElements& osculating) {
  // Angles near zero, so that 1e-12 rad can be resolved however many revolutions u has counted.
  QnsElements goal = osculating;
  goal.raan = math::wrap_to_pi(osculating.raan);
  goal.u = math::wrap_to_pi(osculating.u);

  const Result<QnsElements> first = brouwer(goal, Direction::kOsculatingToMean);
  if (!first.ok()) return first.status();
  QnsElements mean = first.value();
  for (int k = 0; k < kMaxIterations; ++k) {
    const Result<QnsElements> mapped = brouwer(mean, Direction::kMeanToOsculating);
    if (!mapped.ok()) return Status::kDidNotConverge;
    const QnsElements& image = mapped.value();
    const double da = (goal.a - image.a) / goal.a;
    const double dex = goal.ex - image.ex;
    const double dey = goal.ey - image.ey;
    const double di = goal.i - image.i;
    const double draan = goal.raan - image.raan;
    const double du = goal.u - image.u;
    mean.a += da * goal.a;
    mean.ex += dex;
    mean.ey += dey;
    mean.i += di;
    mean.raan += draan;
    mean.u += du;
    if (math::abs(da) < kTolerance && math::abs(dex) < kTolerance && math::abs(dey) < kTolerance &&
        math::abs(di) < kTolerance && math::abs(draan) < kTolerance && math::abs(du) < kTolerance) {
      mean.raan += osculating.raan - goal.raan;
      mean.u += osculating.u - goal.u;
      return mean;
    }
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::orbit
