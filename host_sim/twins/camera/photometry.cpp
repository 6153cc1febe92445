#include "host_sim/twins/camera/photometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace vbar::twins::camera {
namespace {

template <std::size_t N>
double linear(const std::array<double, N>& x, const std::array<double, N>& y, double at) {  // ends are extended
  std::size_t i = 0;
  while (i + 2 < N && at > x[i + 1]) ++i;
  return y[i] + (y[i + 1] - y[i]) * (at - x[i]) / (x[i + 1] - x[i]);
}

constexpr std::array<double, 4> kBandNm{438.0, 545.0, 641.0, 798.0};                  // B, V, R, I
constexpr std::array<double, 4> kZeroFlux{632e-11, 363.1e-11, 217.7e-11, 112.6e-11};  // erg/(cm^2 s A)

constexpr std::array<double, 11> kResponseNm{400, 450, 500, 550, 600, 650, 700, 750, 800, 850, 900};
constexpr std::array<double, 11> kResponse{0.71, 0.94, 1.00, 0.99, 0.91, 0.81, 0.68, 0.53, 0.39, 0.27, 0.17};

constexpr std::array<double, 7> kColour{-0.30, 0.0, 0.30, 0.65, 1.00, 1.50, 1.70};  // B-V
constexpr std::array<double, 7> kVMinusR{-0.12, 0.0, 0.18, 0.35, 0.52, 0.83, 1.00};
constexpr std::array<double, 7> kVMinusI{-0.30, 0.0, 0.35, 0.70, 0.98, 1.62, 2.10};

/// Photons/(m^2 s) in the band of V = 0 and the colour, weighted by the response.
double band_photons(double b_v) {
  constexpr double kPlanckTimesLight = 1.98644586e-25;  // J m
  constexpr double kMagnitude = 0.921034037197618;      // ln(10) * 0.4
  const std::array<double, 4> colour{b_v, 0.0, -linear(kColour, kVMinusR, b_v), -linear(kColour, kVMinusI, b_v)};
  std::array<double, 4> log_density;  // photons/(m^2 s nm)
  for (std::size_t band = 0; band < 4; ++band) {
    const double watts = kZeroFlux[band] * 1e-7 * 1e4 * 10.0;  // per m^2 and nm
    log_density[band] = std::log(watts * kBandNm[band] * 1e-9 / kPlanckTimesLight) - kMagnitude * colour[band];
  }
  double sum = 0.0;
  for (double nm = 400.5; nm < 900.0; nm += 1.0)
    sum += std::exp(linear(kBandNm, log_density, nm)) * linear(kResponseNm, kResponse, nm);
  return sum;
}

constexpr double kFirstColour = -0.30, kColourStep = 0.05;
constexpr std::size_t kColours = 41;

std::array<double, kColours> tabulate_colour_factor() {
  std::array<double, kColours> factor;
  for (std::size_t i = 0; i < kColours; ++i)
    factor[i] = band_photons(kFirstColour + kColourStep * static_cast<double>(i)) / band_photons(0.0);
  return factor;
}

}  // namespace

double zero_magnitude_photons_from_spectrum() {
  return band_photons(0.0);
}

double colour_factor(double b_v) {
  static const std::array<double, kColours> table = tabulate_colour_factor();
  const double place = std::clamp((b_v - kFirstColour) / kColourStep, 0.0, static_cast<double>(kColours - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(place), kColours - 2);
  return table[i] + (table[i + 1] - table[i]) * (place - static_cast<double>(i));
}

double star_photons(double zero_magnitude_photons, double v, double b_v) {
  return zero_magnitude_photons * std::pow(10.0, -0.4 * v) * colour_factor(b_v);
}

double sun_photons(double zero_magnitude_photons, double distance_m) {
  const double at_1_au = star_photons(zero_magnitude_photons, kSunMagnitude, kSunColour);
  return at_1_au * (kAstronomicalUnit / distance_m) * (kAstronomicalUnit / distance_m);
}

}  // namespace vbar::twins::camera
