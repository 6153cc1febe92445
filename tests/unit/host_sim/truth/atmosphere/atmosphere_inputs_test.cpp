#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/atmosphere/day_expansions.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/temperature_profile.h"
#include "tests/support/paths.h"

namespace vbar::truth {

namespace {

/// Coefficients that bend nothing: the effective ap is linear in the history.
Nrlmsise00Tables::Upper linear_coefficients(double fading_per_s) {
  Nrlmsise00Tables::Upper p{};
  p[24] = p[43] = 0.08;
  p[25] = p[44] = 1.0;
  p[51] = fading_per_s;
  return p;
}

SolarIndices quiet_history() {
  SolarIndices indices;
  indices.geomagnetic_index = GeomagneticIndex::kThreeHourly;
  indices.ap_history.fill(4.0);
  return indices;
}

TEST(EffectiveAp, ForgetsGeometricallyByThreeHours) {
  // Hedin (1987), eq. A24: sum of e^k ap_k over the 20 intervals of the last 57 hours, over 1 + sqrt(e) (sum of e^k, 19
  // of them); here term by term, where a mean of eight stands for each of its eight intervals.
  const double fading_per_s = 3.0e-5;
  const double e = std::exp(-10800.0 * fading_per_s);
  for (std::size_t pulse = 0; pulse < 6; ++pulse) {
    SolarIndices indices = quiet_history();
    indices.ap_history[pulse] = 104.0;
    double sum = 0.0, norm = 1.0;
    for (int k = 0; k < 20; ++k) {
      const std::size_t entry = k < 4 ? static_cast<std::size_t>(k) : (k < 12 ? 4 : 5);
      sum += std::pow(e, k) * (indices.ap_history[entry] - 4.0);
      if (k < 19) norm += std::sqrt(e) * std::pow(e, k);
    }
    const EffectiveAp ap(linear_coefficients(fading_per_s), indices);
    EXPECT_NEAR(ap.at(45.0), sum / norm, 1e-12 * sum);  // rounding of twenty terms
  }
}

TEST(EffectiveAp, QuietIsZero) {
  const EffectiveAp remembered(linear_coefficients(3e-5), quiet_history());
  EXPECT_EQ(remembered.at(10.0), 0.0);
  SolarIndices daily;
  daily.ap_daily = 4.0;
  EXPECT_EQ(EffectiveAp(linear_coefficients(3e-5), daily).at(10.0), 0.0);
}

TEST(EffectiveAp, MemoryIsShorterTowardsThePoleIfTheCoefficientSaysSo) {
  Nrlmsise00Tables::Upper p = linear_coefficients(3e-5);
  p[138] = 3e-3;
  SolarIndices indices = quiet_history();
  indices.ap_history[3] = 104.0;
  const EffectiveAp ap(p, indices);
  const double at_45 = EffectiveAp(linear_coefficients(3e-5), indices).at(45.0);
  EXPECT_NEAR(ap.at(45.0), at_45, 1e-12 * at_45);
  EXPECT_LT(ap.at(80.0), ap.at(45.0));
  EXPECT_EQ(ap.at(-80.0), ap.at(80.0));
}

TEST(EffectiveAp, SaturatesFromSlopeOneToItsLimit) {
  // ap' - 4 = x + (b - 1)(x + (exp(-a x) - 1)/a): slope 1 at x = 0, b far above (Hedin 1987, eq. A24b).
  Nrlmsise00Tables::Upper p{};
  p[43] = 0.08;
  p[44] = 0.2;
  const auto effective = [&](double ap) {
    SolarIndices indices;
    indices.ap_daily = ap;
    return EffectiveAp(p, indices).at(0.0);
  };
  EXPECT_NEAR((effective(4.001) - effective(3.999)) / 0.002, 1.0, 1e-6);  // curvature over 0.001
  EXPECT_NEAR((effective(401.0) - effective(399.0)) / 2.0, 0.2, 1e-9);    // exp(-30)
  EXPECT_NEAR(effective(400.0), 396.0 + (0.2 - 1.0) * (396.0 - 1.0 / 0.08), 1e-9);
}

}  // namespace

namespace {

TEST(ClampedSpline, ReproducesACubicAndItsIntegral) {
  // A clamped cubic spline through points of a cubic, with its slopes at the ends, is that cubic.
  const auto f = [](double x) { return 2.0 + x * (-1.0 + x * (0.5 + 3.0 * x)); };
  const auto slope = [](double x) { return -1.0 + x * (1.0 + 9.0 * x); };
  const auto integral = [](double x) { return x * (2.0 + x * (-0.5 + x * (0.5 / 3.0 + 0.75 * x))); };
  const std::array<double, 5> x{0.0, 0.3, 0.4, 0.8, 1.0};
  std::array<double, 5> y{};
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = f(x[i]);
  const ClampedSpline<5> spline(x, y, slope(0.0), slope(1.0));
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.05 * i;
    EXPECT_NEAR(spline.value(t), f(t), 1e-14);  // rounding of numbers about 1
    EXPECT_NEAR(spline.integral(t), integral(t), 1e-14);
  }
}

}  // namespace

namespace {

using testing::HasSubstr;

class Nrlmsise00TablesFile : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream in(std::filesystem::path(vbar::tests::source_path("data/atmosphere/nrlmsise00.csv")));
    std::stringstream text;
    text << in.rdbuf();
    whole_ = text.str();
  }

  void TearDown() override { std::filesystem::remove(file_); }

  std::string message_for(const std::string& text) {
    std::ofstream(file_) << text;
    try {
      load_nrlmsise00_tables(file_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::string with(const std::string& what, const std::string& instead) const {
    std::string text = whole_;
    return text.replace(text.find(what), what.size(), instead);
  }

  std::string whole_;
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("vbar_nrlmsise00_" + std::to_string(getpid()) + ".csv");
};

TEST_F(Nrlmsise00TablesFile, IsReadWhenWhole) {
  EXPECT_EQ(message_for(whole_), "");
  const Nrlmsise00Tables tables = load_nrlmsise00_tables(file_);
  // First and last numbers of arrays, as published.
  EXPECT_EQ(tables.pt[0], 0.986573);
  EXPECT_EQ(tables.ptm[0], 1041.3);
  EXPECT_EQ(tables.pdm[7][9], 4000.0);
  EXPECT_EQ(tables.pdl[1][24], 0.949154);
  EXPECT_EQ(tables.pavgm[0], 261.0);
}

TEST_F(Nrlmsise00TablesFile, DamageIsNamedByLine) {
  EXPECT_THAT(message_for(whole_.substr(0, whole_.size() / 2)), HasSubstr("numbers of array"));
  EXPECT_THAT(message_for(with("\nend\n", "\n")), HasSubstr("the file ends here, expected end"));
  EXPECT_THAT(message_for(with("array,pd,9,150", "array,pd,8,150")),
              HasSubstr(":9: found \"array,pd,8,150\", expected array,pd,9,150"));
  EXPECT_THAT(message_for(with("0.986573,", "0.986573x,")), HasSubstr(":8: found \"0.986573x,"));
  EXPECT_THAT(message_for(with("0.986573,", "nan,")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THAT(message_for(with("0.986573,", "")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THAT(message_for(with("0.986573,", "0.986573,1,")), HasSubstr("expected 150 numbers of array pt"));
  EXPECT_THROW(load_nrlmsise00_tables("/nonexistent/nrlmsise00.csv"), std::runtime_error);
}

}  // namespace

}  // namespace vbar::truth
