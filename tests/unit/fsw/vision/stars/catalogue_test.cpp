#include "fsw/vision/stars/catalogue.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <erfa.h>
#include <erfam.h>
#include <gtest/gtest.h>

#include "fsw/vision/stars/star_lookup.h"
#include "tests/support/accuracy.h"
#include "tests/support/paths.h"
#include "tests/support/star_sky.h"

namespace vbar::fsw::stars {
namespace {

const std::vector<sky::TrueStar>& the_sky() {
  static const auto stars = sky::read_sky(vbar::tests::source_path("data/stars/hipparcos_v8.csv"), 2011.55);
  return stars;
}

/// As catalogues print them: J2000, hours, minutes, seconds; degrees, minutes, seconds; mas a year (the first with the
/// cosine of the declination); V.
struct NamedStar {
  const char* name;
  int hipparcos;
  double ra_h, ra_m, ra_s;
  char sign;
  double dec_d, dec_m, dec_s;
  double pm_ra, pm_dec;
  double v;
};

// van Leeuwen (2007), Hipparcos, the New Reduction; V of the Bright Star Catalogue.
constexpr std::array kNamedStars{
    NamedStar{"Sirius", 32349, 6, 45, 8.91728, '-', 16, 42, 58.0171, -546.01, -1223.07, -1.46},
    NamedStar{"Canopus", 30438, 6, 23, 57.10988, '-', 52, 41, 44.3810, 19.93, 23.24, -0.72},
    NamedStar{"Arcturus", 69673, 14, 15, 39.67207, '+', 19, 10, 56.6730, -1093.39, -2000.06, -0.04},
    NamedStar{"Vega", 91262, 18, 36, 56.33635, '+', 38, 47, 1.2802, 200.94, 286.23, 0.03},
    NamedStar{"Capella", 24608, 5, 16, 41.35871, '+', 45, 59, 52.7693, 75.25, -426.89, 0.08},
    NamedStar{"Rigel", 24436, 5, 14, 32.27210, '-', 8, 12, 5.8981, 1.31, 0.50, 0.12},
    NamedStar{"Procyon", 37279, 7, 39, 18.11950, '+', 5, 13, 29.9552, -714.59, -1036.80, 0.38},
    NamedStar{"Betelgeuse", 27989, 5, 55, 10.30536, '+', 7, 24, 25.4304, 27.54, 11.30, 0.50},
    NamedStar{"Achernar", 7588, 1, 37, 42.84548, '-', 57, 14, 12.3101, 87.00, -38.24, 0.46},
    NamedStar{"Altair", 97649, 19, 50, 46.99855, '+', 8, 52, 5.9563, 536.23, 385.29, 0.77},
    NamedStar{"Aldebaran", 21421, 4, 35, 55.23907, '+', 16, 30, 33.4885, 63.45, -188.94, 0.85},
    NamedStar{"Spica", 65474, 13, 25, 11.57937, '-', 11, 9, 40.7501, -42.35, -30.67, 0.98},
    NamedStar{"Antares", 80763, 16, 29, 24.45970, '-', 26, 25, 55.2094, -12.11, -23.30, 0.96},
    NamedStar{"Pollux", 37826, 7, 45, 18.94987, '+', 28, 1, 34.3160, -626.55, -45.80, 1.14},
    NamedStar{"Fomalhaut", 113368, 22, 57, 39.04625, '-', 29, 37, 20.0533, 328.95, -164.67, 1.16},
    NamedStar{"Deneb", 102098, 20, 41, 25.91514, '+', 45, 16, 49.2197, 2.01, 1.85, 1.25},
    NamedStar{"Regulus", 49669, 10, 8, 22.31099, '+', 11, 58, 1.9516, -248.73, 5.59, 1.35},
    NamedStar{"Bellatrix", 25336, 5, 25, 7.86325, '+', 6, 20, 58.9318, -8.11, -12.88, 1.64},
    NamedStar{"Alnilam", 26311, 5, 36, 12.81335, '-', 1, 12, 6.9089, 1.44, -0.78, 1.70},
    NamedStar{"Polaris", 11767, 2, 31, 49.09456, '+', 89, 15, 50.7923, 44.48, -11.85, 2.02},
};

Vector3 direction_at_epoch(const NamedStar& star) {
  double ra = 0, dec = 0, ra2 = 0, dec2 = 0, pmr2 = 0, pmd2 = 0, px2 = 0, rv2 = 0, c[3];
  eraTf2a('+', static_cast<int>(star.ra_h), static_cast<int>(star.ra_m), star.ra_s, &ra);
  eraAf2a(star.sign, static_cast<int>(star.dec_d), static_cast<int>(star.dec_m), star.dec_s, &dec);
  const double mas = ERFA_DAS2R / 1000.0;
  eraPmsafe(ra, dec, star.pm_ra * mas / std::cos(dec), star.pm_dec * mas, 0.0, 0.0, ERFA_DJ00, 0.0, ERFA_DJ00,
            11.55 * 365.25, &ra2, &dec2, &pmr2, &pmd2, &px2, &rv2);
  eraS2c(ra2, dec2, c);
  return {c[0], c[1], c[2]};
}

TEST(StarCatalogue, HasBrightStarsWhereTheyAre) {
  ASSERT_EQ(catalogue_epoch(), 2011.55);
  accuracy::Largest largest;
  for (const NamedStar& named : kNamedStars) {
    const Vector3 expected = direction_at_epoch(named);
    int nearest = 0;
    for (int star = 1; star < catalogue_size(); ++star) {
      if ((star_direction_eci(star) - expected).norm() < (star_direction_eci(nearest) - expected).norm())
        nearest = star;
    }
    EXPECT_EQ(star_hipparcos(nearest), named.hipparcos) << named.name;
    EXPECT_NEAR(star_magnitude(nearest), named.v, 0.15) << named.name;  // variable stars among them
    largest.add((star_direction_eci(nearest) - expected).norm() / ERFA_DAS2R);
  }
  // The star file rounds some positions to 0.1 arcsec.
  accuracy::expect_below("star catalogue on board at 2011.55", "20 bright stars, Hipparcos new reduction through ERFA",
                         largest, 0.2, "arcsec");
}

TEST(StarCatalogue, HasEveryStarOfTheFile) {
  ASSERT_EQ(catalogue_size(), static_cast<int>(the_sky().size()));
  for (const sky::TrueStar& star : the_sky()) {
    const Neighbour found = nearest_star(star.direction, 1.0 * ERFA_DAS2R, star.magnitude, {0.0, 0.001});
    ASSERT_GE(found.star, 0) << "HIP " << star.hipparcos[0];
    // Straight motion against ERFA's: 0.1 arcsec in eleven years for the fastest.
    EXPECT_LT(std::sqrt(found.squared_distance), 0.1 * ERFA_DAS2R) << "HIP " << star.hipparcos[0];
  }
}

TEST(StarCatalogue, ConesHoldTheStarsThatAreInThem) {
  sky::Random random(3);
  std::vector<int> found(4096);
  for (int k = 0; k < 300; ++k) {
    const Vector3 axis = sky::random_rotation(random).row(0);
    const double radius = k % 10 == 0 ? 0.0 : sky::uniform(random, 0.0, 0.2);
    const Result<int> count = stars_in_cone(axis, radius, found);
    ASSERT_TRUE(count.ok());
    int expected = 0;
    for (const sky::TrueStar& star : the_sky()) {
      const double margin = std::acos(std::min(1.0, star.direction.dot(axis))) - radius;
      if (std::abs(margin) < 1e-6) continue;
      if (margin < 0) ++expected;
    }
    // Stars on the rim, of 1e-6 rad, may count or not: hardly ever one.
    EXPECT_NEAR(count.value(), expected, 1);
    for (int m = 0; m < count.value(); ++m) {
      EXPECT_LE(std::acos(std::min(1.0, star_direction_eci(found[static_cast<std::size_t>(m)]).dot(axis))),
                radius + 1e-8);
    }
  }
}

TEST(StarCatalogue, NearestStarIsTheNearestOfAll) {
  // Directions near stars, where cells meet too: each star displaced by up to the largest tolerance.
  sky::Random random(4);
  const MagnitudeGate any{0.0, 100.0};
  for (int k = 0; k < 2000; ++k) {
    const sky::TrueStar& near = the_sky()[random() % the_sky().size()];
    const double off = kCellMargin / std::sqrt(3.0);
    const Vector3 place = (near.direction + Vector3(sky::uniform(random, -off, off), sky::uniform(random, -off, off),
                                                    sky::uniform(random, -off, off)))
                              .normalized();
    accuracy::Smallest nearest{1.0};
    for (const sky::TrueStar& star : the_sky()) nearest.add((star.direction - place).norm());
    const Neighbour found = nearest_star(place, kCellMargin, 5.0, any);
    ASSERT_GE(found.star, 0);
    EXPECT_NEAR(std::sqrt(found.squared_distance), nearest, 0.1 * ERFA_DAS2R);
  }
}

TEST(StarCatalogue, CellsMeetAtTheEdgesOfTheCube) {
  // Every cell holds its own middle, and every direction has a cell, also those on edges and corners.
  for (const int edge : {kCoarseEdge, kFineEdge, kOccupancyEdge}) {
    for (int cell = 0; cell < 6 * edge * edge; ++cell) {
      const CellMiddle m = middle_of_cell(cell, edge);
      ASSERT_EQ(cell_of(m.x, m.y, m.z, edge), cell);
    }
    for (const double x : {-1.0, 0.0, 1.0})
      for (const double y : {-1.0, 0.0, 1.0})
        for (const double z : {-1.0, 0.0, 1.0}) {
          if (x == 0 && y == 0 && z == 0) continue;
          EXPECT_GE(cell_of(x, y, z, edge), 0);
          EXPECT_LT(cell_of(x, y, z, edge), 6 * edge * edge);
        }
  }
}

TEST(StarCatalogue, NoPointOfACoarseCellIsFartherFromItsMiddleThanTheRadius) {
  sky::Random random(9);
  for (int k = 0; k < 100000; ++k) {
    const Vector3 d = sky::random_rotation(random).row(0);
    const CellMiddle m = middle_of_cell(cell_of(d.x(), d.y(), d.z(), kCoarseEdge), kCoarseEdge);
    EXPECT_LE(std::acos(std::min(1.0, d.dot(Vector3(m.x, m.y, m.z).normalized()))), kCoarseRadius);
  }
}

TEST(StarCatalogue, RefusesConesThatAreNone) {
  std::array<int, 4> found{};
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stars_in_cone(Vector3::UnitX(), 0.6, found).status(), Status::kOutOfRange);
  EXPECT_EQ(stars_in_cone(Vector3::UnitX(), -0.1, found).status(), Status::kOutOfRange);
  EXPECT_EQ(stars_in_cone(Vector3::UnitX(), kNan, found).status(), Status::kNotFinite);
  EXPECT_EQ(stars_in_cone(Vector3(kNan, 0, 0), 0.1, found).status(), Status::kNotFinite);
  EXPECT_EQ(stars_in_cone(Vector3::UnitX(), 0.2, found).value(), 4);  // no more than there is room for
}

TEST(StarAberration, IsThatOfRelativity) {
  sky::Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const Vector3 star = sky::random_rotation(random).row(0);
    const Vector3 velocity = 1.25e-4 * sky::random_rotation(random).row(0).transpose();
    double natural[3] = {star.x(), star.y(), star.z()};
    double v[3] = {velocity.x(), velocity.y(), velocity.z()};
    double apparent[3];
    eraAb(natural, v, 1e9, std::sqrt(1.0 - velocity.squaredNorm()), apparent);
    const Vector3 expected(apparent[0], apparent[1], apparent[2]);
    const Vector3 seen = with_aberration(star, velocity);
    // Squares of the velocity are left out: 1.6e-8.
    EXPECT_LT((seen - expected).norm(), 3e-8);
    EXPECT_LT((without_aberration(expected, velocity) - star).norm(), 3e-8);
  }
  // At right angles to the Earth's motion of 29.79 km/s: the constant of aberration, 20.5 arcsec.
  const Vector3 seen = with_aberration(Vector3::UnitX(), Vector3(0, 29'790.0 / 299'792'458.0, 0));
  EXPECT_NEAR(std::atan2(seen.y(), seen.x()) / ERFA_DAS2R, 20.496, 0.001);
}

}  // namespace
}  // namespace vbar::fsw::stars
