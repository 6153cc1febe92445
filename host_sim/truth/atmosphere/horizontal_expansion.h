#pragma once
// Horizontal variation of NRLMSISE-00: associated Legendre functions of latitude times waves of local time, longitude
// and universal time (Hedin 1987, J. Geophys. Res. 92, appendix, and the later terms of the published coefficients).
// Every quantity of the model is a series in these functions, whose coefficients depend on the day and the solar
// indices alone; so the functions are computed once for an instant and place, and a quantity is one dot product.

#include <array>
#include <cstring>

#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/earth/space_weather.h"

namespace vbar::truth {

/// The model's own roundings of pi/180 rad/deg, 2 pi/24 rad/h, 2 pi/86400 rad/s and 2 pi/365 rad/day.
inline constexpr double kModelDegree = 1.74533e-2;
inline constexpr double kModelHour = 0.2618;
inline constexpr double kModelSecond = 7.2722e-5;
inline constexpr double kModelDay = 1.72142e-2;

/// Place at which each group of functions begins. P_nm is unnormalised, without the Condon-Shortley phase. In a group
/// of waves each Legendre function takes two places: times the cosine, times the sine.
enum HorizontalGroup : int {
  kZonal = 0,                               ///< P_00 ... P_60
  kDiurnal = kZonal + 7,                    ///< P_11, P_12, P_13, P_15 x local time
  kSemidiurnal = kDiurnal + 2 * 4,          ///< P_22, P_23, P_24, P_25 x twice the local time
  kTerdiurnal = kSemidiurnal + 2 * 4,       ///< P_33, P_34, P_36 x three times the local time
  kLongitude = kTerdiurnal + 2 * 3,         ///< P_11 ... P_16 x longitude
  kLongitudeOdd = kLongitude + 2 * 6,       ///< the same times P_10
  kLowerSize = kLongitudeOdd + 2 * 6,       ///< the functions for the atmosphere below 120 km end here
  kUniversalTime = kLowerSize,              ///< P_10, P_30, P_50 x universal time; again times P_10; times P_10^2
  kLongitudeTime = kUniversalTime + 2 * 9,  ///< P_23, P_25, P_27 x (universal time + twice the longitude)
  kHorizontalSize = kLongitudeTime + 2 * 3,
};

/// Values of all functions, or the coefficients of a series in them.
using HorizontalSeries = std::array<double, kHorizontalSize>;

struct HorizontalPlace {
  double latitude_deg = 0.0;  ///< geodetic
  double longitude_deg = 0.0;
  double local_solar_time_h = 0.0;
  double ut_s = 0.0;  ///< seconds of the UTC day
};

HorizontalSeries horizontal_functions(const HorizontalPlace& place);

/// Adds amplitude cos(wave - phase) times Legendre function `index` of the group to a series.
inline void add_wave(HorizontalSeries& series, int group, int index, double amplitude, double cos_phase,
                     double sin_phase) {
  series[group + 2 * index] += amplitude * cos_phase;
  series[group + 2 * index + 1] += amplitude * sin_phase;
}

// Several series in the horizontal functions, summed side by side: four lanes of a row share each function's value.

/// Table of `kCount` series in the first `kFunctions` functions.
template <int kCount, int kFunctions>
class SeriesTable {
 public:
  void set(int index, const HorizontalSeries& series) {
    for (int k = 0; k < kFunctions; ++k) blocks_[index / kLanes][k].lanes[index % kLanes] = series[k];
  }

  std::array<double, kCount> sums(const HorizontalSeries& functions) const {
    std::array<std::array<double, kLanes>, kBlocks> all{};
    for (int block = 0; block < kBlocks; ++block) sum_block(blocks_[block], functions, all[block].data());
    std::array<double, kCount> result{};
    std::memcpy(result.data(), all.data(), sizeof result);
    return result;
  }

 private:
  using TwoLanes = double __attribute__((vector_size(16)));
  static constexpr int kLanes = 4;
  static constexpr int kBlocks = (kCount + kLanes - 1) / kLanes;

  struct alignas(16) Row {
    double lanes[kLanes];
  };
  using Block = std::array<Row, kFunctions>;

  static void sum_block(const Block& block, const HorizontalSeries& functions, double* sums) {
    TwoLanes low{}, high{}, low_odd{}, high_odd{};  // even and odd functions apart: shorter chains of additions
    const auto add = [&](int k, TwoLanes& a, TwoLanes& b) {
      TwoLanes rows[2];
      std::memcpy(rows, block[k].lanes, sizeof rows);
      a += rows[0] * functions[k];
      b += rows[1] * functions[k];
    };
    int k = 0;
    for (; k + 1 < kFunctions; k += 2) {
      add(k, low, high);
      add(k + 1, low_odd, high_odd);
    }
    if (k < kFunctions) add(k, low, high);
    const TwoLanes both[2] = {low + low_odd, high + high_odd};
    std::memcpy(sums, both, sizeof both);
  }

  std::array<Block, kBlocks> blocks_{};
};

// The coefficients of NRLMSISE-00's series in the horizontal functions on one day at one level of solar activity: the
// published expansion evaluated for season and flux, so that only place and time of day remain.

/// Series of a quantity, which is quiet + (effective ap) magnetic.
struct ExpansionOfDay {
  HorizontalSeries quiet{};
  HorizontalSeries magnetic{};
};

/// Expands a quantity of the thermosphere (Hedin 1987, eq. A22 ff.; "globe" expansion).
ExpansionOfDay upper_expansion(const Nrlmsise00Tables::Upper& p, int day_of_year, const SolarIndices& indices);

/// Expands a quantity below 120 km (Hedin 1991, J. Geophys. Res. 96): fewer terms, no universal time.
ExpansionOfDay lower_expansion(const Nrlmsise00Tables::Lower& p, int day_of_year, const SolarIndices& indices);

}  // namespace vbar::truth
