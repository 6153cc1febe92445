// Files of stars: what is accepted, what is refused, and the main catalogue of Hipparcos against the project's table.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/twins/camera/star_sky.h"
#include "tests/support/camera_scene.h"
#include "tests/support/figures.h"

namespace vbar::twins::camera {
namespace {

using testing::HasSubstr;

constexpr double kDegree = M_PI / 180.0;
constexpr double kMilliarcsecond = kDegree / 3.6e6;

/// The first row of hip_main.dat as CDS publishes it.
constexpr const char* kFirst =
    "H|           1| |00 00 00.22|+01 05 20.4| 9.10| |H|000.00091185|+01.08901332| |   3.54|   -5.20|   -1.88|  1.32|  "
    "0.74|  1.39|  1.36|  0.81| 0.32|-0.07|-0.11|-0.24| 0.09|-0.01| 0.10|-0.01| 0.01| 0.34|  0| 0.74|     1| "
    "9.643|0.020"
    "| 9.130|0.019| | 0.482|0.025|T|0.55|0.03|L| | 9.2043|0.0020|0.017| 87| | 9.17| 9.24|       | | | |          | |  "
    "| 1"
    "| | | |  |   |       |     |     |    |S| | |224700|B+00 5077 |          |          |0.66|F5          |S ";

/// Fields of a row that are read, in its own widths; the others are blank.
struct Entry {
  int hip = 1;
  std::string v = " 9.10", ra = "000.00091185", dec = "+01.08901332", pm_ra = "   -5.20", pm_dec = "   -1.88",
              b_v = " 0.482";
};

std::string row_of(const Entry& entry) {
  std::string row = fmt::format("H|{:12}| |           |           |{}| |H|{}|{}| |       |{}|{}", entry.hip, entry.v,
                                entry.ra, entry.dec, entry.pm_ra, entry.pm_dec);
  for (int field = 14; field < 78; ++field) row += field == 37 ? "|" + entry.b_v : "| ";
  return row + "\n";
}

class StarCatalogueTest : public testing::Test {
 protected:
  ~StarCatalogueTest() override { std::filesystem::remove(file_); }

  std::vector<CatalogueStar> stars_of(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_star_catalogue(file_);
  }
  std::string complaint_about(const std::string& text) const {
    std::ofstream(file_) << text;
    return complaint();
  }
  std::string complaint() const {
    try {
      static_cast<void>(read_star_catalogue(file_));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("vbar_star_catalogue_" + std::to_string(getpid()) + ".dat");
};

TEST_F(StarCatalogueTest, ADamagedTableIsRefusedWithFileAndLine) {
  EXPECT_THAT(complaint(), HasSubstr(".dat: cannot open"));
  const std::string head =
      "# ESA\nhip,ra_deg,dec_deg,pm_ra_mas,pm_dec_mas,v,b_v\n32349,101.2,-16.7,-546.01,-1223.07,-1.44,0.01\n";
  EXPECT_EQ(complaint_about(head + "7,1.0,2.0,3,4,8.00,0.5\n"), "none");
  EXPECT_THAT(complaint_about(head), HasSubstr(".dat:3: the star catalogue ends at magnitude -1.44"));
  EXPECT_THAT(complaint_about(head + "30438,95.98,-52."), HasSubstr(".dat:4: found \"30438,95.98,-52.\""));
  EXPECT_THAT(complaint_about(head + "7,1.0,2.0,3,4,8.00,0.5"), HasSubstr("cut short"));  // 0.55, perhaps
  EXPECT_THAT(complaint_about(head + "7,1.0,2.0,3,4,8.00\n"), HasSubstr(":4: "));
  EXPECT_THAT(complaint_about(head + "7,1.0,x,3,4,8.00,0.5\n"), HasSubstr(":4: "));
  EXPECT_THAT(complaint_about(head + "7,1.0,91.0,3,4,8.00,0.5\n"), HasSubstr(":4: "));
  EXPECT_THAT(complaint_about(head + "1e300,1.0,2.0,3,4,8.00,0.5\n"), HasSubstr(":4: "));
  EXPECT_THAT(complaint_about(head + "7,1.0,2.0,3,4,-1.6,0.5\n"), HasSubstr("brightest first"));
  EXPECT_THAT(complaint_about("hip,ra\n"), HasSubstr(":1: found \"hip,ra\", accepted: the columns hip,ra_deg"));
  EXPECT_THAT(complaint_about("hip\x1b[2J,ra\n"), HasSubstr(":1: found \"hip?[2J,ra\""));
  EXPECT_THAT(complaint_about(std::string("\x7f"
                                          "ELF\0\1",
                                          6)),
              HasSubstr(".dat: found a byte 0 at position 5"));
  EXPECT_THAT(complaint_about(""), HasSubstr("cut short"));
}

TEST_F(StarCatalogueTest, ADamagedMainCatalogueIsRefusedWithFileAndLine) {
  const std::string good = row_of({});
  EXPECT_THAT(complaint_about(good), HasSubstr(".dat:1: the star catalogue has 0 stars to magnitude 8"));
  EXPECT_THAT(complaint_about(good + good.substr(0, 60)), HasSubstr(":2: found"));
  EXPECT_THAT(complaint_about(good + good.substr(0, 60) + "\n"), HasSubstr("78 fields separated by \"|\""));
  EXPECT_THAT(complaint_about(good + "T" + good.substr(1)), HasSubstr(":2: "));
  EXPECT_THAT(complaint_about(good + row_of({.v = "bright"})), HasSubstr(":2: "));
  EXPECT_THAT(complaint_about(good + row_of({.hip = 0})), HasSubstr(":2: "));
  EXPECT_THAT(complaint_about(good + row_of({.dec = "+91.00000000"})), HasSubstr("in the units of hip_main.dat"));
  EXPECT_THAT(complaint_about(good + row_of({.pm_ra = "1e999"})), HasSubstr(":2: "));
}

/// The project's table with places of J1991.25, moved back by ERFA, in the form of the main catalogue.
std::string as_main_catalogue(const std::vector<CatalogueStar>& stars) {
  std::string text;
  for (const CatalogueStar& star : stars) {
    const double ra = star.ra_deg * kDegree, dec = star.dec_deg * kDegree;
    double ra_then, dec_then, pm_ra_then, pm_dec_then, parallax, radial;
    eraPmsafe(ra, dec, star.pm_ra_mas * kMilliarcsecond / std::cos(dec), star.pm_dec_mas * kMilliarcsecond, 0.0, 0.0,
              ERFA_DJ00, 0.0, ERFA_DJ00, -8.75 * 365.25, &ra_then, &dec_then, &pm_ra_then, &pm_dec_then, &parallax,
              &radial);
    text += row_of({.hip = std::max(star.hip, 1),
                    .v = fmt::format("{:5.2f}", star.v),
                    .ra = fmt::format("{:012.8f}", eraAnp(ra_then) / kDegree),
                    .dec = fmt::format("{:+012.8f}", dec_then / kDegree),
                    .pm_ra = fmt::format("{:8.2f}", pm_ra_then * std::cos(dec_then) / kMilliarcsecond),
                    .pm_dec = fmt::format("{:8.2f}", pm_dec_then / kMilliarcsecond),
                    .b_v = fmt::format("{:6.3f}", star.b_v)});
  }
  return text;
}

// All 41,560 stars there and back: what remains is the rounding of the two files (0.04 mas in place, 0.01 mas a year),
// over nine years.
TEST_F(StarCatalogueTest, TheMainCatalogueHasTheStarsOfTheTable) {
  const auto table = read_star_catalogue(test::camera_data() / "stars/hipparcos_v8.csv");
  const auto main = stars_of(as_main_catalogue(table));
  ASSERT_EQ(main.size(), table.size());
  accuracy::Largest apart_mas;
  for (std::size_t k = 0; k < table.size(); ++k) {
    const double apart = eraSeps(table[k].ra_deg * kDegree, table[k].dec_deg * kDegree, main[k].ra_deg * kDegree,
                                 main[k].dec_deg * kDegree);
    apart_mas.add(apart / kMilliarcsecond);
    ASSERT_NEAR(main[k].v, table[k].v, 0.0051) << table[k].hip;
    ASSERT_NEAR(main[k].b_v, table[k].b_v, 0.00051) << table[k].hip;
  }
  EXPECT_LT(apart_mas, 0.2);
}

// Published places of J1991.25 (ESA SP-1200) against those of J2000.0 in the table.
TEST_F(StarCatalogueTest, PublishedPlacesAreMovedToJ2000) {
  const auto table = read_star_catalogue(test::camera_data() / "stars/hipparcos_v8.csv");
  const Entry sirius{32349, "-1.44", "101.28854105", "-16.71314306", " -546.01", "-1223.08", " 0.009"};
  const Entry vega{91262, " 0.03", "279.23410832", "+38.78299311", "  201.02", "  287.46", "-0.001"};
  const auto stars =
      stars_of(as_main_catalogue(table) + row_of(sirius) + row_of(vega) + kFirst + "\n" +
               row_of({.hip = 2, .ra = "            ", .dec = "            "}) + row_of({.hip = 3, .b_v = "      "}));
  ASSERT_EQ(stars.size(), table.size() + 4) << "an entry without a place is left out";
  for (const std::size_t k : {table.size(), table.size() + 1}) {
    const auto known = std::ranges::find(table, stars[k].hip, &CatalogueStar::hip);
    ASSERT_NE(known, table.end());
    EXPECT_LT(eraSeps(known->ra_deg * kDegree, known->dec_deg * kDegree, stars[k].ra_deg * kDegree,
                      stars[k].dec_deg * kDegree) /
                  kMilliarcsecond,
              50.0)
        << stars[k].hip;
    EXPECT_NEAR(stars[k].v, known->v, 0.02);
  }
  const CatalogueStar& first = stars[table.size() + 2];
  EXPECT_EQ(first.hip, 1);
  EXPECT_EQ(first.v, 9.10);
  EXPECT_EQ(first.b_v, 0.482);
  EXPECT_EQ(first.pm_ra_mas, -5.20);
  EXPECT_NEAR(first.ra_deg, 0.00091185 - 8.75 * 5.20 / 3.6e6 / std::cos(1.08901332 * kDegree), 1e-9);
  EXPECT_NEAR(first.dec_deg, 1.08901332 - 8.75 * 1.88 / 3.6e6, 1e-9);
  EXPECT_EQ(stars.back().b_v, 0.6) << "without a colour, that of the Sun";
}

}  // namespace
}  // namespace vbar::twins::camera
