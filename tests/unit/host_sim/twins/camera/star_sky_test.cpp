// The sky's stars against places known from elsewhere, and against ERFA.

#include "host_sim/twins/camera/star_sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <erfa.h>
#include <gtest/gtest.h>

#include "tests/support/camera_scene.h"
#include "tests/support/figures.h"

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

constexpr double kArcsecond = M_PI / 648000.0;

// ICRS, J2000.0, as SIMBAD gives them; proper motions mas/yr, that in right ascension with cos(dec).
struct Named {
  const char* name;
  int ra_h, ra_m;
  double ra_s;
  int dec_sign, dec_d, dec_m;
  double dec_s, pm_ra, pm_dec, v;
};
constexpr std::array<Named, 20> kNamed{{
    {"Sirius", 6, 45, 8.9173, -1, 16, 42, 58.017, -546.01, -1223.07, -1.46},
    {"Canopus", 6, 23, 57.1099, -1, 52, 41, 44.381, 19.93, 23.24, -0.74},
    {"Arcturus", 14, 15, 39.6721, +1, 19, 10, 56.673, -1093.39, -2000.06, -0.05},
    {"Vega", 18, 36, 56.3364, +1, 38, 47, 1.280, 200.94, 286.23, 0.03},
    {"Capella", 5, 16, 41.3587, +1, 45, 59, 52.769, 75.25, -426.89, 0.08},
    {"Rigel", 5, 14, 32.2721, -1, 8, 12, 5.898, 1.31, 0.50, 0.13},
    {"Procyon", 7, 39, 18.1195, +1, 5, 13, 29.955, -714.59, -1036.80, 0.37},
    {"Achernar", 1, 37, 42.8455, -1, 57, 14, 12.310, 87.00, -38.24, 0.46},
    {"Betelgeuse", 5, 55, 10.3054, +1, 7, 24, 25.430, 27.54, 11.30, 0.42},
    {"Altair", 19, 50, 46.9986, +1, 8, 52, 5.956, 536.23, 385.29, 0.76},
    {"Aldebaran", 4, 35, 55.2391, +1, 16, 30, 33.489, 63.45, -188.94, 0.86},
    {"Spica", 13, 25, 11.5794, -1, 11, 9, 40.750, -42.35, -30.67, 0.97},
    {"Antares", 16, 29, 24.4597, -1, 26, 25, 55.209, -12.11, -23.30, 0.91},
    {"Pollux", 7, 45, 18.9499, +1, 28, 1, 34.316, -626.55, -45.80, 1.14},
    {"Fomalhaut", 22, 57, 39.0463, -1, 29, 37, 20.053, 328.95, -164.67, 1.16},
    {"Deneb", 20, 41, 25.9151, +1, 45, 16, 49.220, 2.01, 1.85, 1.25},
    {"Regulus", 10, 8, 22.3110, +1, 11, 58, 1.952, -248.73, 5.59, 1.40},
    {"Bellatrix", 5, 25, 7.8633, +1, 6, 20, 58.932, -8.11, -12.88, 1.64},
    {"Castor", 7, 34, 35.8732, +1, 31, 53, 17.816, -191.45, -145.19, 1.58},
    {"Polaris", 2, 31, 49.0946, +1, 89, 15, 50.792, 44.48, -11.85, 1.98},
}};

const camera::StarSky& sky() {
  static const camera::StarSky loaded =
      camera::StarSky::load(vbar::test::camera_data() / "stars/hipparcos_v8.csv", 3.1e10);
  return loaded;
}

// As a barycentric observer with this velocity sees it, `years` after J2000.0: ERFA's proper motion and aberration. The
// Sun's field is put so far away that it does nothing.
Vector3 seen_by_erfa(double ra, double dec, double pm_ra_mas, double pm_dec_mas, double years,
                     const Vector3& velocity) {
  const double mas = kArcsecond / 1000.0;
  double ra_now, dec_now, pm_ra_now, pm_dec_now, parallax, radial;
  eraPmsafe(ra, dec, pm_ra_mas * mas / std::cos(dec), pm_dec_mas * mas, 0.0, 0.0, 2451545.0, 0.0, 2451545.0,
            years * 365.25, &ra_now, &dec_now, &pm_ra_now, &pm_dec_now, &parallax, &radial);
  double natural[3], seen[3], beta[3];
  eraS2c(ra_now, dec_now, natural);
  for (int i = 0; i < 3; ++i) beta[i] = velocity[i] / 299792458.0;
  eraAb(natural, beta, 1e9, std::sqrt(1.0 - velocity.squaredNorm() / std::pow(299792458.0, 2)), seen);
  return {seen[0], seen[1], seen[2]};
}

TEST(StarSky, twenty_named_stars_are_where_erfa_puts_them) {
  const double years = 11.55;
  const Vector3 velocity(-12000.0, -25000.0, -11000.0 + 7500.0);
  for (const Named& named : kNamed) {
    const double ra = (named.ra_h + (named.ra_m + named.ra_s / 60.0) / 60.0) * M_PI / 12.0;
    const double dec = named.dec_sign * (named.dec_d + (named.dec_m + named.dec_s / 60.0) / 60.0) * M_PI / 180.0;
    const Vector3 expected = seen_by_erfa(ra, dec, named.pm_ra, named.pm_dec, years, velocity);
    std::vector<camera::ApparentStar> found;
    sky().find(expected, 0.001, years, velocity, found);
    double nearest = 1.0, v = 99.0;
    for (const auto& star : found)
      if (star.star->v < 3.0 && star.direction_eci.cross(expected).norm() < nearest) {
        nearest = star.direction_eci.cross(expected).norm();
        v = star.star->v;
      }
    EXPECT_LT(nearest / kArcsecond, 0.5) << named.name;  // 0.01 px; Castor is a double star
    EXPECT_NEAR(v, named.v, 0.2) << named.name;          // several vary, as Betelgeuse and Antares
  }
}

// The file read a second time, and every 40th star through ERFA.
TEST(StarSky, proper_motion_and_aberration_agree_with_erfa) {
  std::ifstream in(vbar::test::camera_data() / "stars/hipparcos_v8.csv");
  std::string line;
  const Vector3 velocity(20000.0, -22000.0, -6000.0);
  int number = 0, compared = 0;
  while (std::getline(in, line)) {
    if (line[0] == '#' || line[0] == 'h' || ++number % 40 != 1) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    double row[5];
    char* at = line.data();
    for (double& value : row) value = std::strtod(at, &at);
    const Vector3 expected = seen_by_erfa(row[1] * M_PI / 180.0, row[2] * M_PI / 180.0, row[3], row[4], -9.0, velocity);
    std::vector<camera::ApparentStar> found;
    sky().find(expected, 1e-5, -9.0, velocity, found);
    vbar::accuracy::Smallest nearest{1.0};
    for (const auto& star : found) nearest.add((star.direction_eci - expected).norm());
    ASSERT_LT(nearest / kArcsecond, 0.001) << line;  // 3e-5 px
    ++compared;
  }
  EXPECT_EQ(compared, 41560 / 40);
}

TEST(StarSky, aberration_of_the_earth_s_way_is_twenty_and_a_half_arcseconds) {
  // Mean orbital speed 29.785 km/s across the line of sight; constant of aberration 20.4955 arcsec.
  const Vector3 star = Vector3::UnitX();
  const Vector3 seen = camera::apparent_direction(star, Vector3(0.0, 29788.5, 0.0));
  EXPECT_NEAR(std::atan2(seen.y(), seen.x()) / kArcsecond, 20.4955, 0.001);
  EXPECT_NEAR((camera::apparent_direction(star, Vector3(29788.5, 0.0, 0.0)) - star).norm(), 0.0, 1e-15);
}

TEST(StarSky, a_cone_holds_all_its_stars_anywhere_on_the_sky) {
  const Vector3 still = Vector3::Zero();
  for (const Vector3& towards : {Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(1, 2, 0.5), Vector3(-3, 1, -8)}) {
    const Vector3 axis = towards.normalized();
    std::vector<camera::ApparentStar> found;
    sky().find(axis, 0.17, 0.0, still, found);
    std::set<const camera::SkyStar*> names;
    for (const auto& star : found) {
      EXPECT_LT(std::acos(star.direction_eci.dot(axis)), 0.172);
      names.insert(star.star);
    }
    EXPECT_EQ(names.size(), found.size());
    for (const auto& star : sky().stars())
      if (std::acos(star.direction_j2000.dot(axis)) < 0.17) {
        EXPECT_TRUE(names.contains(&star));
      }
  }
  std::vector<camera::ApparentStar> all;
  sky().find(Vector3::UnitX(), M_PI, 0.0, still, all);
  EXPECT_EQ(all.size(), sky().stars().size());
}

}  // namespace
