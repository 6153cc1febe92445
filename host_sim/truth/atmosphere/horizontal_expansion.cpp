#include "host_sim/truth/atmosphere/horizontal_expansion.h"

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

namespace {

constexpr double kMeanFlux = 150.0;

/// An annual wave (`per_year` cycles) with its maximum on day `peak`.
double season(int day_of_year, int per_year, double peak) {
  return std::cos(per_year * kModelDay * (day_of_year - peak));
}

/// Annual and semiannual waves: the same in both hemispheres, and opposite.
struct Seasons {
  double annual, semiannual, annual_opposite, semiannual_opposite;
};

template <class Coefficients>
Seasons seasons(const Coefficients& p, int day) {
  return {season(day, 1, p[31]), season(day, 2, p[17]), season(day, 1, p[13]), season(day, 2, p[38])};
}

/// Adds the tides: waves of local time with periods of a day, half a day and a third of a day.
template <class Coefficients>
void add_tides(HorizontalSeries& series, const Coefficients& p, double factor, double annual_opposite) {
  const auto add = [&](int group, int index, double cosine, double sine) {
    series[group + 2 * index] += factor * cosine;
    series[group + 2 * index + 1] += factor * sine;
  };
  add(kDiurnal, 0, p[3], p[6]);
  add(kDiurnal, 1, p[11] * annual_opposite, p[12] * annual_opposite);
  add(kDiurnal, 2, p[4], p[7]);
  add(kSemidiurnal, 0, p[5], p[8]);
  add(kSemidiurnal, 1, p[23] * annual_opposite, p[33] * annual_opposite);
  add(kSemidiurnal, 2, p[41], p[42]);
  add(kSemidiurnal, 3, p[35] * annual_opposite, p[36] * annual_opposite);
  add(kTerdiurnal, 0, p[40], p[39]);
}

/// Places of the coefficients of the response to geomagnetic activity: there is one set for daily and one for
/// three-hourly indices. Each number is the first of a run of three where there are three Legendre functions.
struct MagneticPlaces {
  int zonal[3];
  int opposite;
  int local_time, local_time_peak_h;
  int longitude[3], longitude_odd, longitude_peak_deg;
  int seasonal_longitude, seasonal_longitude_peak_deg;
  int universal_time, universal_time_peak_s;
};

constexpr MagneticPlaces kDailyPlaces{{32, 45, 34}, 100, 121, 124, {60, 61, 62}, 120, 63, 115, 118, 83, 75};
constexpr MagneticPlaces kHistoryPlaces{{50, 96, 54}, 125, 128, 131, {52, 98, 67}, 132, 97, 133, 136, 55, 58};

HorizontalSeries magnetic_response(const Nrlmsise00Tables::Upper& p, const MagneticPlaces& at, double annual_opposite) {
  HorizontalSeries series{};
  const double local_time = kModelHour * p[at.local_time_peak_h];
  const double longitude = kModelDegree * p[at.longitude_peak_deg];
  const double seasonal_longitude = kModelDegree * p[at.seasonal_longitude_peak_deg];
  const double universal_time = kModelSecond * p[at.universal_time_peak_s];
  constexpr int kDiurnalPlaces[3] = {0, 2, 3};  // places of P_11, P_13, P_15
  for (int i = 0; i < 3; ++i) {
    series[kZonal + 2 * i] += p[at.zonal[i]];
    series[kZonal + 2 * i + 1] += p[at.opposite + i] * annual_opposite;
    add_wave(series, kDiurnal, kDiurnalPlaces[i], p[at.local_time + i], std::cos(local_time), std::sin(local_time));
    const double amplitude = p[at.longitude[i]];
    add_wave(series, kLongitude, 2 * i + 1, amplitude, std::cos(longitude), std::sin(longitude));
    add_wave(series, kLongitudeOdd, 2 * i + 1, amplitude * p[at.longitude_odd], std::cos(longitude),
             std::sin(longitude));
    add_wave(series, kLongitude, 2 * i, p[at.seasonal_longitude + i] * annual_opposite, std::cos(seasonal_longitude),
             std::sin(seasonal_longitude));
    add_wave(series, kUniversalTime, i, p[at.universal_time + i], std::cos(universal_time), std::sin(universal_time));
  }
  return series;
}

}  // namespace

ExpansionOfDay upper_expansion(const Nrlmsise00Tables::Upper& p, int day_of_year, const SolarIndices& indices) {
  const Seasons s = seasons(p, day_of_year);
  const double df = indices.f107 - indices.f107_average;
  const double dfa = indices.f107_average - kMeanFlux;
  const double flux = p[19] * df + p[20] * df * df;
  const double seasonal_factor = 1.0 + p[47] * dfa + flux;
  const double tidal_factor = 1.0 + p[49] * dfa + flux;

  ExpansionOfDay expansion;
  HorizontalSeries& quiet = expansion.quiet;
  quiet[kZonal] = p[30] + p[19] * df * (1.0 + p[59] * dfa) + p[20] * df * df + p[21] * dfa + p[29] * dfa * dfa +
                  p[18] * s.annual + p[15] * s.semiannual;
  quiet[kZonal + 1] = p[26] + seasonal_factor * p[9] * s.annual_opposite + p[37] * s.semiannual_opposite;
  quiet[kZonal + 2] = p[1] + p[14] * dfa + p[16] * s.semiannual;
  quiet[kZonal + 3] = seasonal_factor * p[10] * s.annual_opposite;
  quiet[kZonal + 4] = p[2];
  quiet[kZonal + 6] = p[22];

  add_tides(quiet, p, tidal_factor, s.annual_opposite);
  quiet[kDiurnal + 6] += tidal_factor * p[27];  // P_15
  quiet[kDiurnal + 7] += tidal_factor * p[28];
  quiet[kTerdiurnal + 2] += tidal_factor * p[94] * s.annual_opposite;  // P_34
  quiet[kTerdiurnal + 3] += tidal_factor * p[93] * s.annual_opposite;
  quiet[kTerdiurnal + 4] += tidal_factor * p[48] * s.annual_opposite;  // P_36
  quiet[kTerdiurnal + 5] += tidal_factor * p[46] * s.annual_opposite;

  const double longitude_factor = 1.0 + p[80] * dfa;
  for (int i = 0; i < 3; ++i) {  // P_11, P_13, P_15 vary with the season, P_12, P_14, P_16 do not
    add_wave(quiet, kLongitude, 2 * i, longitude_factor, p[103 + i] + p[109 + i] * s.annual_opposite,
             p[106 + i] + p[112 + i] * s.annual_opposite);
    add_wave(quiet, kLongitude, 2 * i + 1, longitude_factor, p[64 + i], p[90 + i]);
  }

  // (1 + a P_10) (1 + b P_10) (P_10, P_30, P_50)
  const double a = p[95], b = p[119] * s.annual_opposite;
  const double of_power[3] = {1.0, a + b, a * b};
  const double ut_factor = 1.0 + p[81] * dfa;
  const double ut_peak = kModelSecond * p[71];
  for (int power = 0; power < 3; ++power) {
    for (int i = 0; i < 3; ++i) {
      add_wave(quiet, kUniversalTime, 3 * power + i, ut_factor * of_power[power] * p[68 + i], std::cos(ut_peak),
               std::sin(ut_peak));
    }
  }
  const double longitude_time_factor = 1.0 + p[137] * dfa;
  const double longitude_time_peak = kModelSecond * p[79];
  for (int i = 0; i < 3; ++i) {
    add_wave(quiet, kLongitudeTime, i, longitude_time_factor * p[76 + i], std::cos(longitude_time_peak),
             std::sin(longitude_time_peak));
  }

  const bool daily = indices.geomagnetic_index == GeomagneticIndex::kDaily;
  expansion.magnetic = magnetic_response(p, daily ? kDailyPlaces : kHistoryPlaces, s.annual_opposite);
  return expansion;
}

ExpansionOfDay lower_expansion(const Nrlmsise00Tables::Lower& p, int day_of_year, const SolarIndices& indices) {
  const Seasons s = seasons(p, day_of_year);
  ExpansionOfDay expansion;
  HorizontalSeries& quiet = expansion.quiet;
  quiet[kZonal] = p[21] * (indices.f107_average - kMeanFlux) + p[18] * s.annual + p[15] * s.semiannual;
  quiet[kZonal + 1] = p[26] + p[9] * s.annual_opposite + p[37] * s.semiannual_opposite;
  quiet[kZonal + 2] = p[1] + p[47] * s.annual + p[16] * s.semiannual;
  quiet[kZonal + 3] = p[14] + p[10] * s.annual_opposite;
  quiet[kZonal + 4] = p[2] + p[29] * s.annual + p[30] * s.semiannual;
  quiet[kZonal + 5] = p[59] + p[20] * s.annual_opposite;
  quiet[kZonal + 6] = p[22];

  add_tides(quiet, p, 1.0, s.annual_opposite);

  const double even = 1.0 + p[83] * season(day_of_year, 1, p[84]) + p[87] * season(day_of_year, 2, p[88]);
  const double odd = p[80] * season(day_of_year, 1, p[81]) + p[85] * season(day_of_year, 2, p[86]);
  for (int i = 0; i < 3; ++i) {
    add_wave(quiet, kLongitude, 2 * i, even, p[74 + i], p[77 + i]);
    add_wave(quiet, kLongitude, 2 * i + 1, even, p[64 + i], p[90 + i]);
    add_wave(quiet, kLongitudeOdd, 2 * i, odd, p[74 + i], p[77 + i]);
    add_wave(quiet, kLongitudeOdd, 2 * i + 1, odd, p[64 + i], p[90 + i]);
  }

  const bool daily = indices.geomagnetic_index == GeomagneticIndex::kDaily;
  expansion.magnetic[kZonal] = daily ? p[32] : p[50];
  expansion.magnetic[kZonal + 2] = daily ? p[45] : p[96];
  return expansion;
}

}  // namespace vbar::truth
