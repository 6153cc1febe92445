// Ocean tides against Orekit, and their force against its own field.

#include "host_sim/truth/forces/ocean_tides.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <erfa.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/files/text_lines.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

const std::filesystem::path kFile = test::kDataDirectory / "gravity/fes2004_8.txt";

TEST(OceanTides, CoefficientsOfAnotherProgram) {
  // Orekit (its test of the ocean tides' field): FES2004 to degree 4, five waves, on 2003-05-06T13:43:32.125 UTC;
  // UT1-UTC of the day, -0.35 s, to 0.01 s (7e-7 rad). Orekit's amplitudes and phases of the heights of the sea have
  // digits of 1e-4 cm, which is 3e-5 of the largest.
  constexpr double kC[3][5] = {
      {-4.812565797928061e-11, -4.1748378190052583e-11, 7.013273986245356e-11, 0.0, 0.0},
      {-2.5341227608443308e-11, 9.76515813742254e-11, -1.21931214469994e-10, 1.3179722429471184e-10, 0.0},
      {-2.7496974839179478e-11, 8.419627031293907e-11, 6.56546217101275e-11, -3.375298928713117e-11,
       -7.588006744166988e-11}};
  constexpr double kS[3][5] = {
      {0.0, 5.646187590518608e-12, 1.742233297668071e-10, 0.0, 0.0},
      {0.0, -8.032186864783105e-11, -3.118910148495339e-11, 1.0566857199592183e-10, 0.0},
      {0.0, 7.37884528812169e-11, -1.3085142873419844e-10, -1.5813709543115768e-10, 1.770903634801541e-10}};
  std::vector<OceanTideWave> waves = load_ocean_tides(kFile);
  std::erase_if(waves, [](const OceanTideWave& wave) {
    const std::vector<std::string> kept{"55.565", "56.554", "85.455", "135.655", "273.555"};
    return std::ranges::find(kept, wave.doodson) == kept.end();
  });
  ASSERT_EQ(waves.size(), 5U);
  const fsw::GpsTime date = gps_from_utc("2003-05-06T13:43:32.125Z");
  const JulianDate tt = tt_of(date), utc = utc_of(date);
  const double gmst = eraGmst06(utc.day, utc.fraction - 0.35 / 86400.0, tt.day, tt.fraction);
  const GravityCoefficients found = ocean_tide_coefficients(waves, tt, gmst);
  accuracy::Largest difference;
  for (int n = 2; n <= 4; ++n)
    for (int m = 0; m <= n; ++m)
      difference.add(std::abs(found.c_nm(n, m) - kC[n - 2][m]),
                     m == 0 ? 0.0 : std::abs(found.s_nm(n, m) - kS[n - 2][m]));
  accuracy::expect_below("ocean tides, coefficients of degrees 2 to 4, five waves",
                         "Orekit, 2003-05-06T13:43:32.125 UTC", difference, 2e-14, "of a normalised coefficient");
}

TEST(OceanTides, ForceIsTheGradientOfTheFieldOfItsInstant) {
  const auto waves = std::make_shared<const std::vector<OceanTideWave>>(load_ocean_tides(kFile));
  const auto orientation = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv"));
  OceanTidesForce force(test::kGm, test::kEarthRadius, test::mission_epoch(), waves, orientation);
  accuracy::Largest missed, size;
  for (double seconds = 100.0; seconds < 86400.0; seconds += 3333.3) {
    ForceInput input;
    input.seconds = seconds;
    input.position_itrf = fsw::Vector3(5.1e6, 3.0e6, 4.0e6);
    input.position_eci = input.position_itrf;
    const JulianDate tt = tt_of(test::mission_epoch(), seconds);
    const JulianDate ut1 =
        ut1_of(tai_of(test::mission_epoch(), seconds), orientation->at(test::mission_epoch(), seconds).ut1_minus_tai_s);
    GravityCoefficients field =
        ocean_tide_coefficients(*waves, tt, eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction));
    field.gm = test::kGm;
    field.radius = test::kEarthRadius;
    const fsw::Vector3 exact =
        GravityField(field, kOceanTideDegree, kOceanTideDegree).perturbation_itrf(input.position_itrf);
    missed.add((force.acceleration_eci(input) - exact).norm());
    size.add(exact.norm());
  }
  EXPECT_LT(missed, 1e-5 * size);  // of the interpolation between nodes
  EXPECT_GT(size, 1e-8);           // IERS Conventions 2010: a tenth of the solid Earth's tide of 3e-7 m/s^2
  EXPECT_LT(size, 2e-7);
}

TEST(OceanTides, RefuseDamagedTables) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_ocean_tides(text, "tides.txt"));
    } catch (const files::FormatError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message("255.555 M2 2 2 -1 0 0 0\nend\n"), "accepted");
  EXPECT_THAT(message("255.555 M2 2 2 -1 0 0 0\n"), testing::HasSubstr("the file is cut short"));
  EXPECT_THAT(message(""), testing::HasSubstr("the file is cut short"));
  EXPECT_THAT(message("255.555 M2 2 2 -1 0 0\nend\n"), testing::HasSubstr("tides.txt:1"));
  EXPECT_THAT(message("255.555 M2 9 2 -1 0 0 0\nend\n"), testing::HasSubstr("a degree from 2 to 8"));
  EXPECT_THAT(message("255.555 M2 2 3 -1 0 0 0\nend\n"), testing::HasSubstr("an order up to it"));
  EXPECT_THAT(message("2555555 M2 2 2 -1 0 0 0\nend\n"), testing::HasSubstr("a Doodson number as 255.555"));
  EXPECT_THAT(message("255.555 M2 2 2 nan 0 0 0\nend\n"), testing::HasSubstr("four coefficients"));
}

}  // namespace
}  // namespace vbar::truth
