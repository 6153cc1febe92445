#include "host_sim/truth/atmosphere/horizontal_basis.h"

#include <cmath>

namespace vbar::truth {
namespace {

struct Wave {
  double cos, sin;
};

Wave wave(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// The wave of the sum of two angles.
Wave operator+(const Wave& a, const Wave& b) {
  return {a.cos * b.cos - a.sin * b.sin, a.sin * b.cos + a.cos * b.sin};
}

/// Fills the places of a series from `at` on.
class Filler {
 public:
  explicit Filler(HorizontalSeries& series) : at_(series.data()) {}

  void put(double value) { *at_++ = value; }

  template <class... Legendre>
  void put_waves(const Wave& wave, Legendre... legendre) {
    ((put(legendre * wave.cos), put(legendre * wave.sin)), ...);
  }

 private:
  double* at_;
};

}  // namespace

HorizontalSeries horizontal_functions(const HorizontalPlace& place) {
  const double x = std::sin(kModelDegree * place.latitude_deg);  // the argument of the Legendre functions
  const double c = std::cos(kModelDegree * place.latitude_deg);
  const double xx = x * x, c2 = c * c, c3 = c2 * c;

  const double p20 = 1.5 * xx - 0.5;
  const double p30 = x * (2.5 * xx - 1.5);
  const double p40 = (4.375 * xx - 3.75) * xx + 0.375;
  const double p50 = x * ((7.875 * xx - 8.75) * xx + 1.875);
  const double p60 = ((14.4375 * xx - 19.6875) * xx + 6.5625) * xx - 0.3125;
  const double p12 = 3.0 * x * c;
  const double p13 = c * (7.5 * xx - 1.5);
  const double p14 = c * x * (17.5 * xx - 7.5);
  const double p15 = c * ((39.375 * xx - 26.25) * xx + 1.875);
  const double p16 = c * x * ((86.625 * xx - 78.75) * xx + 13.125);
  const double p22 = 3.0 * c2;
  const double p23 = 15.0 * c2 * x;
  const double p24 = c2 * (52.5 * xx - 7.5);
  const double p25 = c2 * x * (157.5 * xx - 52.5);
  const double p27 = c2 * x * ((1126.125 * xx - 866.25) * xx + 118.125);
  const double p33 = 15.0 * c3;
  const double p34 = 105.0 * c3 * x;
  const double p36 = c3 * x * (1732.5 * xx - 472.5);

  const Wave local_time = wave(kModelHour * place.local_solar_time_h);
  const Wave twice_local_time = local_time + local_time;
  const Wave longitude = wave(kModelDegree * place.longitude_deg);
  const Wave universal_time = wave(kModelSecond * place.ut_s);

  HorizontalSeries values;
  Filler filler(values);
  for (const double zonal : {1.0, x, p20, p30, p40, p50, p60}) filler.put(zonal);
  filler.put_waves(local_time, c, p12, p13, p15);
  filler.put_waves(twice_local_time, p22, p23, p24, p25);
  filler.put_waves(twice_local_time + local_time, p33, p34, p36);
  filler.put_waves(longitude, c, p12, p13, p14, p15, p16);
  filler.put_waves(longitude, x * c, x * p12, x * p13, x * p14, x * p15, x * p16);
  filler.put_waves(universal_time, x, p30, p50, xx, x * p30, x * p50, xx * x, xx * p30, xx * p50);
  filler.put_waves(universal_time + longitude + longitude, p23, p25, p27);
  return values;
}

}  // namespace vbar::truth
