#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <GeographicLib/SphericalHarmonic.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/solid_tides.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {

namespace {

using fsw::Vector3;

const std::filesystem::path kFile = test::kDataDirectory / "gravity/ggm05s_120.txt";

/// Karney's GeographicLib, an independent implementation (Clenshaw summation).
class Peer {
 public:
  Peer(const GravityCoefficients& model, int degree, int order) : gm_(model.gm), radius_(model.radius) {
    for (int m = 0; m <= order; ++m) {
      for (int n = m; n <= degree; ++n) {
        c_.push_back(model.c_nm(n, m));
        if (m > 0) s_.push_back(model.s_nm(n, m));
      }
    }
    harmonic_ = GeographicLib::SphericalHarmonic(c_, s_, degree, degree, order, radius_);
  }

  Vector3 acceleration(const Vector3& r) const {
    Vector3 gradient;
    harmonic_(r.x(), r.y(), r.z(), gradient.x(), gradient.y(), gradient.z());
    return gm_ / radius_ * gradient;
  }

 private:
  double gm_, radius_;
  std::vector<double> c_, s_;
  GeographicLib::SphericalHarmonic harmonic_;
};

/// Directions all over the sphere, distances from 200 km height to geostationary.
std::vector<Vector3> points(int count) {
  std::mt19937_64 random(60);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> log_distance(std::log(6578136.3), std::log(42164000.0));
  std::vector<Vector3> result;
  for (int i = 0; i < count; ++i) {
    const Vector3 d(direction(random), direction(random), direction(random));
    result.push_back(d.normalized() * std::exp(log_distance(random)));
  }
  return result;
}

/// Largest relative difference from the peer's acceleration.
double difference_from_peer(int degree, int order, const std::vector<Vector3>& where) {
  const GravityCoefficients model = load_gravity_coefficients(kFile, degree);
  const GravityField field(model, degree, order);
  const Peer peer(model, degree, order);
  accuracy::Largest largest;
  for (const Vector3& r : where) {
    const Vector3 expected = peer.acceleration(r);
    largest.add((field.acceleration_itrf(r) - expected).norm() / expected.norm());
  }
  return largest;
}

constexpr double kRounding = 1e-13;  // of two sums of up to 7000 terms; found: 1e-15

TEST(Gravity, AgreesWithGeographicLibTo60) {
  accuracy::expect_below("gravity 60x60, 200 km to geostationary", "GeographicLib SphericalHarmonic, 10,000 points",
                         difference_from_peer(60, 60, points(10000)), kRounding, "relative");
}

TEST(Gravity, AgreesWithGeographicLibTo120) {
  accuracy::expect_below("gravity 120x120, 200 km to geostationary", "GeographicLib SphericalHarmonic, 10,000 points",
                         difference_from_peer(120, 120, points(10000)), kRounding, "relative");
}

// EGM2008 as ICGEM distributes it, cut at degree 8.
TEST(Gravity, AnotherModelAgreesWithGeographicLib) {
  const GravityCoefficients model =
      load_gravity_coefficients(vbar::tests::source_path("tests/data/formats/egm2008_8.gfc"), 8);
  EXPECT_EQ(model.model, "EGM2008");
  EXPECT_EQ(model.tide_system, "tide_free");
  EXPECT_EQ(model.c_nm(3, 1), 0.203046201047864e-05);
  EXPECT_EQ(model.s_nm(8, 8), 0.120551889384997e-06);
  const GravityField field(model, 8, 8);
  const Peer peer(model, 8, 8);
  accuracy::Largest largest;
  for (const Vector3& r : points(2000)) {
    const Vector3 expected = peer.acceleration(r);
    largest.add((field.acceleration_itrf(r) - expected).norm() / expected.norm());
  }
  EXPECT_LT(static_cast<double>(largest), kRounding);
}

TEST(Gravity, AgreesWithGeographicLibForOddSizes) {
  for (const auto& [degree, order] : {std::pair{2, 0}, {2, 2}, {3, 1}, {5, 5}, {17, 6}, {31, 30}, {70, 1}}) {
    EXPECT_LT(difference_from_peer(degree, order, points(200)), kRounding) << degree << "x" << order;
  }
}

TEST(Gravity, HasNoSingularityAtThePoles) {
  std::vector<Vector3> near_poles;
  for (double z : {-7.0e6, 7.0e6}) {
    for (double offset : {0.0, 1e-300, 1e-9, 1.0, 1e3}) {
      near_poles.emplace_back(offset, 0.0, z);
      near_poles.emplace_back(0.0, -offset, z);
    }
  }
  accuracy::expect_below("gravity 60x60 at the poles and beside them", "GeographicLib SphericalHarmonic, 20 points",
                         difference_from_peer(60, 60, near_poles), kRounding, "relative");
  accuracy::expect_below("gravity 120x120 at the poles and beside them", "GeographicLib SphericalHarmonic, 20 points",
                         difference_from_peer(120, 120, near_poles), kRounding, "relative");
}

TEST(Gravity, EveryBuildOfTheInnerLoopGivesTheSameBits) {
  const GravityCoefficients model = load_gravity_coefficients(kFile, 120);
  for (int degree : {2, 7, 60, 119}) {
    const GravityField portable(model, degree, degree, sum_harmonics_portable);
    const GravityField fastest(model, degree, degree, fastest_harmonic_summation());
    for (const Vector3& r : points(200)) EXPECT_EQ(portable.perturbation_itrf(r), fastest.perturbation_itrf(r));
  }
}

TEST(Gravity, Degree2IsTheFormulaOfJ2) {
  // e.g. Montenbruck and Gill 2000, eq. 3.30 with the degree-2 zonal alone; J2 = -sqrt(5) C20.
  const GravityCoefficients model = load_gravity_coefficients(kFile, 2);
  const GravityField field(model, 2, 0);
  const double j2 = -std::sqrt(5.0) * model.c_nm(2, 0);
  EXPECT_NEAR(j2, 1.0826358191967e-3, 1e-16);
  for (const Vector3& r : points(500)) {
    const double d = r.norm(), z2 = 5.0 * r.z() * r.z() / (d * d);
    const double scale = -1.5 * j2 * model.gm * model.radius * model.radius / std::pow(d, 5);
    const Vector3 expected = scale * Vector3(r.x() * (1.0 - z2), r.y() * (1.0 - z2), r.z() * (3.0 - z2));
    EXPECT_LT((field.perturbation_itrf(r) - expected).norm(),
              1e-14 * expected.norm());  // rounding of a dozen operations
  }
}

TEST(Gravity, Degree0IsThePointMass) {
  const GravityField field(load_gravity_coefficients(kFile, 0), 0, 0);
  const Vector3 r(3e6, -4e6, 12e6);
  EXPECT_EQ(field.perturbation_itrf(r), Vector3::Zero().eval());
  const Vector3 expected = -test::kGm / (13e6 * 13e6) * r / 13e6;
  EXPECT_LT((field.acceleration_itrf(r) - expected).norm(), 1e-15 * expected.norm());
}

TEST(Gravity, RefusesDegreesItDoesNotHave) {
  EXPECT_THROW(load_gravity_coefficients(kFile, 121), std::invalid_argument);
  EXPECT_THROW(load_gravity_coefficients(kFile, -1), std::invalid_argument);
  const GravityCoefficients model = load_gravity_coefficients(kFile, 10);
  EXPECT_THROW(GravityField(model, 11, 0), std::invalid_argument);
  EXPECT_THROW(GravityField(model, -1, 0), std::invalid_argument);
  EXPECT_THROW(GravityField(model, 10, 11), std::invalid_argument);
  EXPECT_THROW(GravityField(model, 10, -1), std::invalid_argument);
}

std::string error_for(const std::string& text, int degree = 1) {
  const auto path = std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + "_vbar_gravity_test.txt");
  std::ofstream(path) << text;
  try {
    static_cast<void>(load_gravity_coefficients(path, degree));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(GravityFile, ErrorsNameFileAndLine) {
  using testing::HasSubstr;
  const std::string head = "# test\nmodel M\ngm_m3ps2 4e14\nradius_m 6378000\nmax_degree 1\ntide_system zero_tide\n";
  const std::string body = "coefficients\n0 0 1 0\n1 0 0 0\n1 1 0 0\n";
  EXPECT_EQ(error_for(head + body + "end\n"), "");
  EXPECT_THAT(error_for(""),
              HasSubstr("vbar_gravity_test.txt:1: found \"\", expected a gravity model in one of the formats"));
  EXPECT_THAT(error_for(head + body), HasSubstr(":10: found the end of the file, expected \"end\""));
  EXPECT_THAT(error_for(head + "coefficients\n0 0 1 0\n1 0 0 0\n"),
              HasSubstr("found the end of the file, expected the coefficients C and S of degree 1, order 1"));
  EXPECT_THAT(error_for(head + "coefficients\n0 0 1 0\n1 1 0 0\n"), HasSubstr(":9: found \"1 1 0 0\", expected the"));
  EXPECT_THAT(error_for(head + "coefficients\n0 0 nan 0\n"), HasSubstr("found \"0 0 nan 0\""));
  EXPECT_THAT(error_for(head + "coefficients\n0 0 1\n"), HasSubstr("found \"0 0 1\""));
  EXPECT_THAT(error_for(head + body + "end\n", 2), HasSubstr("gravity degree 2 asked of"));
  EXPECT_THAT(error_for("model M\ngm_m3ps2 -4e14\n"), HasSubstr(":2: found \"gm_m3ps2 -4e14\""));
  EXPECT_THAT(error_for("model M\nradius_m 1\n"), HasSubstr("expected \"gm_m3ps2 VALUE\""));
  EXPECT_THROW(load_gravity_coefficients("/nonexistent/gravity.txt", 2), std::runtime_error);
}

TEST(GravityFile, TheShippedFileCutShortAnywhereIsRefused) {
  std::stringstream whole;
  whole << std::ifstream(kFile).rdbuf();
  const std::string text = whole.str();
  for (double part : {0.0, 0.1, 0.5, 0.9, 0.9999}) {
    const auto length = static_cast<std::size_t>(part * static_cast<double>(text.size()));
    // Degree 2 is complete in most of these: a truncated file is refused whatever is asked of it.
    EXPECT_NE(error_for(text.substr(0, length), 2), "") << part;
  }
}

}  // namespace

// ICGEM files: the bundled model after an independent writer has put it into that format, and what is refused.

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

namespace {

TEST(LowDegreeField, IsTheGravityFieldOfTheSameCoefficients) {
  // gravity_field.h, which agrees with an independent program, sums other recursions of the same series.
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    LowDegreeCoefficients low;
    GravityCoefficients field;
    field.gm = 3.986004415e14;
    field.radius = 6378136.3;
    field.degree = 4;
    field.c.assign(GravityCoefficients::index(5, 0), 0.0);
    field.s = field.c;
    for (int n = 2; n <= 4; ++n) {
      for (int m = 0; m <= n; ++m) {
        field.c[GravityCoefficients::index(n, m)] = low.c[n][m] = 1e-9 * normal(random);
        if (m > 0) field.s[GravityCoefficients::index(n, m)] = low.s[n][m] = 1e-9 * normal(random);
      }
    }
    const GravityField reference(field, 4, 4);
    const fsw::Vector3 r = 6.9e6 * fsw::Vector3(normal(random), normal(random), normal(random)).normalized();
    const fsw::Vector3 expected = reference.perturbation_itrf(r);
    // Rounding of some thirty terms.
    EXPECT_LT((acceleration_itrf(low, field.gm, field.radius, r) - expected).norm(), 1e-14 * expected.norm());
  }
}

TEST(LowDegreeField, HasNoSingularityAtThePoles) {
  LowDegreeCoefficients field;
  field.c[2][1] = 1e-9;
  field.s[3][1] = -2e-9;
  const fsw::Vector3 at_pole = acceleration_itrf(field, 4e14, 6.4e6, {0.0, 0.0, 7e6});
  const fsw::Vector3 beside = acceleration_itrf(field, 4e14, 6.4e6, {1e-3, 0.0, 7e6});
  EXPECT_GT(at_pole.norm(), 1e-9);
  EXPECT_LT((at_pole - beside).norm(), 1e-9 * at_pole.norm());  // a millimetre of 7000 km, times the degree
}

}  // namespace

}  // namespace vbar::truth
