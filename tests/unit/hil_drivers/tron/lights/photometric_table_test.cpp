// Photometric tables: power laws exactly, other curves between their points, and tables that are refused.

#include "hil_drivers/tron/lights/photometric_table.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::tron {
namespace {

using ::testing::HasSubstr;

const std::vector<double> kLevels{0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0};

LightTable table(const std::string& source, double (*light)(double)) {
  LightTable table{source, kLevels, {}};
  for (const double level : kLevels) table.light.push_back(light(level));
  return table;
}

std::string refusal_of(const LightTable& bad) {
  try {
    (void)LightResponse(bad);
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(LightResponse, IsAsDesignedWithoutATable) {
  const LightResponse response;
  for (const double level : {0.0, 1e-6, 0.3, 1.0}) {
    EXPECT_NEAR(response.light(level), level, 1e-15);
    EXPECT_NEAR(response.level(level), level, 1e-15);
  }
}

TEST(LightResponse, MeetsAPowerLawExactlyBelowItsLowestLevelToo) {
  const LightResponse response(table("lamp", [](double level) { return 0.97 * std::pow(level, 2.2); }));
  EXPECT_NEAR(response.full_light(), 0.97, 1e-14);
  for (const double level : {1e-4, 0.01, 0.07, 0.33, 0.99, 1.0}) {
    EXPECT_NEAR(response.light(level), 0.97 * std::pow(level, 2.2), 1e-13);
    EXPECT_NEAR(response.level(0.97 * std::pow(level, 2.2)), level, 1e-13);
  }
  EXPECT_EQ(response.level(0.98), 1.0);  // more than it can give
  EXPECT_EQ(response.level(0.0), 0.0);
  EXPECT_EQ(response.level(-0.1), 0.0);
  EXPECT_EQ(response.light(0.0), 0.0);
}

TEST(LightResponse, RisesAndIsInvertedBetweenAnyPoints) {
  const LightResponse response(table("lamp", [](double level) { return 0.1 * level + 0.9 * std::pow(level, 3); }));
  double before = 0.0;
  for (double level = 0.001; level <= 1.0; level += 0.001) {
    const double light = response.light(level);
    EXPECT_GT(light, before);
    EXPECT_NEAR(response.level(light), level, 1e-12);
    before = light;
  }
}

TEST(LightResponse, LeavesLevelsOfZeroOut) {
  const LightResponse response(LightTable{"lamp", {0.0, 0.5, 1.0}, {-1e-4, 0.25, 1.0}});
  EXPECT_NEAR(response.light(0.1), 0.01, 1e-14);
}

TEST(LightResponse, NamesTheSourceOfATableThatIsRefused) {
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.3, 0.3}}), HasSubstr("'box 3': the light does not rise"));
  EXPECT_THAT(refusal_of({"box 3", {1.0, 0.5}, {0.2, 0.3}}), HasSubstr("'box 3': the levels do not rise"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.1}, {0.2, 0.3}}), HasSubstr("not in 0 to 1"));
  EXPECT_THAT(refusal_of({"box 3", {std::nan(""), 1.0}, {0.2, 0.3}}), HasSubstr("not in 0 to 1"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {std::nan(""), 0.3}}), HasSubstr("not positive"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.0, 0.3}}), HasSubstr("not positive"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.3}}), HasSubstr("differ in number"));
  EXPECT_THAT(refusal_of({"box 3", {0.0, 1.0}, {0.0, 1.0}}), HasSubstr("fewer than two"));
}

TEST(PhotometricTable, HasEverySourceOnce) {
  std::vector<LightTable> tables;
  for (std::size_t k = 0; k < kLightSources; ++k)
    tables.push_back(table(light_source_name(k), [](double level) { return level * level; }));
  EXPECT_NEAR(PhotometricTable(tables).box(9).light(0.5), 0.25, 1e-14);
  EXPECT_NEAR(PhotometricTable(tables).lamp().light(0.5), 0.25, 1e-14);
  auto missing = tables;
  missing.erase(missing.begin() + 4);
  auto twice = tables;
  twice.push_back(tables[2]);
  auto unknown = tables;
  unknown[0].source = "moon";
  EXPECT_THROW(PhotometricTable{missing}, std::invalid_argument);
  EXPECT_THROW(PhotometricTable{twice}, std::invalid_argument);
  EXPECT_THROW(PhotometricTable{unknown}, std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron
