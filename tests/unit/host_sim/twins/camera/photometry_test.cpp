// Light of stars and of the Sun, against figures typed from the literature and against a black body.

#include "host_sim/twins/camera/photometry.h"

#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/camera_settings.h"

namespace {

namespace camera = vbar::twins::camera;

// The detector's response at 400, 500, ... 900 nm, by eye.
constexpr std::array<double, 6> kResponse{0.71, 1.00, 0.91, 0.68, 0.39, 0.17};

double response(double nm) {
  const double place = (nm - 400.0) / 100.0;
  const auto i = static_cast<std::size_t>(place < 4.999 ? place : 4.999);
  return kResponse[i] + (kResponse[i + 1] - kResponse[i]) * (place - static_cast<double>(i));
}

// By hand, trapezia of 50 nm from 400 nm. Photons/(cm^2 s A) of V = 0, B-V = 0 read off the straight lines on
// logarithmic paper through 1394 at 438 nm (B), 996 at 545 (V; the well-known 1000), 702 at 641 (R), 452 at 798 (I).
TEST(Photometry, magnitude_zero_is_what_the_bands_sum_to_by_hand) {
  constexpr std::array<double, 11> kPhotons{1571, 1342, 1147, 978, 815, 684, 595, 517, 450, 391, 340};
  constexpr std::array<double, 11> kSeen{0.71, 0.94, 1.00, 0.99, 0.91, 0.81, 0.68, 0.53, 0.39, 0.27, 0.17};
  double photons = 0.0;  // 1/(m^2 s)
  for (std::size_t i = 0; i + 1 < kSeen.size(); ++i)
    photons += 0.5 * (kPhotons[i] * kSeen[i] + kPhotons[i + 1] * kSeen[i + 1]) * 500.0 * 1e4;
  EXPECT_NEAR(camera::zero_magnitude_photons_from_spectrum() / photons, 1.0, 0.01);
}

TEST(Photometry, the_camera_settings_hold_it_rounded) {
  EXPECT_NEAR(camera::CameraSettings{}.zero_magnitude_photons / camera::zero_magnitude_photons_from_spectrum(), 1.0,
              0.01);
}

TEST(Photometry, the_sun_shines_like_a_black_body_of_5772_kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458.0, kBoltzmann = 1.380649e-23;
  double photons = 0.0;  // of a surface into the hemisphere, 1/(m^2 s)
  for (double nm = 400.5; nm < 900.0; nm += 1.0) {
    const double wave = nm * 1e-9;
    const double radiance =
        2.0 * kLight / std::pow(wave, 4) / std::expm1(kPlanck * kLight / (wave * kBoltzmann * 5772.0));
    photons += M_PI * radiance * 1e-9 * response(nm);
  }
  photons *= std::pow(6.957e8 / 1.495978707e11, 2);
  // The Sun is some per cent brighter than the black body in the visible and fainter in the violet.
  EXPECT_NEAR(camera::sun_photons(3.1e10, 1.495978707e11) / photons, 1.0, 0.06);
}

TEST(Photometry, sunlight_falls_with_the_square_of_the_distance) {
  EXPECT_NEAR(camera::sun_photons(1.0, 3.0e11) / camera::sun_photons(1.0, 1.5e11), 0.25, 1e-12);
}

TEST(Photometry, five_magnitudes_are_a_factor_of_a_hundred) {
  EXPECT_DOUBLE_EQ(camera::star_photons(3.1e10, 0.0, 0.0), 3.1e10);
  EXPECT_NEAR(camera::star_photons(3.1e10, 5.0, 0.0) / 3.1e8, 1.0, 1e-12);
}

TEST(Photometry, red_stars_give_more_electrons_than_white_ones_of_the_same_magnitude) {
  EXPECT_DOUBLE_EQ(camera::colour_factor(0.0), 1.0);
  EXPECT_GT(camera::colour_factor(1.5), 1.2);  // V-I of 1.6: four times the light at 800 nm
  EXPECT_LT(camera::colour_factor(1.5), 1.5);
  EXPECT_NEAR(camera::colour_factor(-0.3), 1.07, 0.05);
  EXPECT_EQ(camera::colour_factor(5.0), camera::colour_factor(1.7));
  EXPECT_EQ(camera::colour_factor(-5.0), camera::colour_factor(-0.3));
}

}  // namespace
