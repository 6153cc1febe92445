// ICGEM files: the bundled model after an independent writer has put it into that format, and what is refused.

#include "host_sim/truth/forces/gravity_formats/gravity_formats.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string header(const GravityCoefficients& model, std::string_view norm, std::string_view tide_system) {
  return fmt::format(
      "{} WRITTEN FOR A TEST\n=====\n\nproduct_type   gravity_field\nmodelname   {}\nearth_gravity_constant  {:.17e}\n"
      "radius  {:.17e}\nmax_degree  {}\nerrors  calibrated\nnorm  {}\ntide_system  {}\n\nkey  L  M  c  s  sigma_c  "
      "sigma_s\nend_of_head ====\n",
      model.model, model.model, model.gm, model.radius, model.degree, norm, tide_system);
}

/// By order, as some models are, where the table of data/gravity goes by degree.
std::string as_icgem(const GravityCoefficients& model) {
  std::string text = header(model, "fully_normalized", model.tide_system);
  for (int m = 0; m <= model.degree; ++m)
    for (int n = m; n <= model.degree; ++n)
      text += fmt::format("gfc {:4} {:4} {:.17e} {:.17e} 0.0 0.0\n", n, m, model.c_nm(n, m), model.s_nm(n, m));
  return text;
}

GravityCoefficients bundled(int degree) {
  return load_gravity_coefficients(test::kDataDirectory / "gravity/ggm05s_120.txt", degree);
}

const std::string& egm2008() {
  static const std::string text = text_of(vbar::tests::source_path("tests/data/formats/egm2008_8.gfc"));
  return text;
}

std::string error_of(std::string text, std::string_view what = "", std::string_view with = "", int degree = 8) {
  if (!what.empty()) text.replace(text.find(what), what.size(), with);
  try {
    static_cast<void>(read_gravity(text, "m.gfc", degree));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(GravityFormats, TheBundledModelAsIcgemFile) {
  const GravityCoefficients table = bundled(120);
  for (const int degree : {0, 1, 2, 60, 120}) {
    const GravityCoefficients read = read_gravity(as_icgem(table), "m.gfc", degree);
    const GravityCoefficients same = bundled(degree);
    EXPECT_EQ(read.model, same.model);
    EXPECT_EQ(read.gm, same.gm);
    EXPECT_EQ(read.radius, same.radius);
    EXPECT_EQ(read.tide_system, "zero_tide");
    EXPECT_EQ(read.degree, degree);
    EXPECT_EQ(read.c, same.c);
    EXPECT_EQ(read.s, same.s);
  }
}

TEST(GravityFormats, UnnormalisedCoefficientsAreNormalised) {
  // J2 to J4 and the sectorial of degree 2 of EGM2008: C_n0 / sqrt(2n + 1); C22 by sqrt(5/12).
  const GravityCoefficients model = read_gravity(egm2008(), "m.gfc", 2);
  std::string text = header(model, "unnormalized", "tide_free");
  text += fmt::format("gfc 2 0 {:.17e} 0\n", model.c_nm(2, 0) * std::sqrt(5.0));
  text += fmt::format("gfc 2 1 {:.17e} {:.17e}\n", model.c_nm(2, 1) * std::sqrt(5.0 / 3.0),
                      model.s_nm(2, 1) * std::sqrt(5.0 / 3.0));
  text += fmt::format("gfc 2 2 {:.17e} {:.17e}\n", model.c_nm(2, 2) * std::sqrt(5.0 / 12.0),
                      model.s_nm(2, 2) * std::sqrt(5.0 / 12.0));
  const GravityCoefficients read = read_gravity(text, "m.gfc", 2);
  for (std::size_t k = 0; k < read.c.size(); ++k) {
    EXPECT_NEAR(read.c[k], model.c[k], 1e-15 * std::abs(model.c[k]));
    EXPECT_NEAR(read.s[k], model.s[k], 1e-15 * std::abs(model.s[k]));
  }
}

TEST(GravityFormats, InvalidFilesAreRefusedWithALine) {
  EXPECT_EQ(error_of(egm2008()), "");
  const std::string& text = egm2008();
  EXPECT_THAT(error_of(text.substr(0, text.find("gfc     7    7"))),
              AllOf(HasSubstr("m.gfc:46: found the end of the file"), HasSubstr("coefficients of degree 7, order 7")));
  // Truncated behind the degrees that are used.
  EXPECT_THAT(error_of(text.substr(0, text.find("gfc     8")), "", "", 4), HasSubstr("coefficients of degree 8"));
  EXPECT_THAT(error_of(text, "gfc     5    0", "gfct    5    0"),
              AllOf(HasSubstr("m.gfc:27: found the term \"gfct\""), HasSubstr("a static model")));
  EXPECT_THAT(error_of(text, "gfc     5    1", "gfc     5    0"), HasSubstr("degree 5, order 0 a second time"));
  EXPECT_THAT(error_of(text, "gfc     5    1", "gfc     5    6"), HasSubstr("order up to the degree"));
  EXPECT_THAT(error_of(text, "0.3986004415E+15", "0.3986004415E+06"), HasSubstr("in m^3/s^2 and m"));
  EXPECT_THAT(error_of(text, "tide_free", "mean_tide"), HasSubstr("expected tide_system zero_tide or tide_free"));
  EXPECT_THAT(error_of(text, "fully_normalized", "half_normalized"), HasSubstr("found norm half_normalized"));
  EXPECT_THAT(error_of(text, "-0.484165143790815D-03", "-0.484165143790815X-03"), HasSubstr("m.gfc:15: found"));
  EXPECT_THAT(error_of(text, "max_degree", "degree"), HasSubstr("found a header without max_degree"));
  EXPECT_THAT(error_of(text, "", "", 9), HasSubstr("gravity degree 9 asked of m.gfc; it has degrees 0 to 8"));
  EXPECT_THAT(error_of("x"), HasSubstr("ICGEM gravity field (.gfc)"));
}

// 1.5e-1 of 1.5e-10 is a number too.
TEST(GravityFormats, ACoefficientThatIsCutShortIsRefused) {
  const std::string text = header(read_gravity(egm2008(), "m.gfc", 2), "fully_normalized", "tide_free") +
                           "gfc 2 0 -4.8e-4 0\ngfc 2 1 -2e-10 1e-9\ngfc 2 2 2.4e-6 -1.4e-6\n";
  EXPECT_EQ(read_gravity(text, "m.gfc", 2).s_nm(2, 2), -1.4e-6);
  EXPECT_THAT(error_of(text.substr(0, text.size() - 1), "", "", 2), HasSubstr("found a last row without a line feed"));
}

}  // namespace
}  // namespace vbar::truth
