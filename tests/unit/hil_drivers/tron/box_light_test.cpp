// Boxes as the Earth: irradiances, powers, misfit.

#include "hil_drivers/tron/lights/box_light.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "hil_drivers/tron/lights/photometry.h"
#include "host_sim/twins/camera/earth_disc.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

using fsw::Vector3;

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

TEST(SphereNormals, Are162EvenlySpread) {
  const auto& normals = sphere_normals();
  ASSERT_EQ(normals.size(), 162U);
  Vector3 sum = Vector3::Zero();
  fsw::Matrix3 squares = fsw::Matrix3::Zero();
  accuracy::Smallest closest;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    EXPECT_NEAR(normals[k].norm(), 1.0, 1e-15);
    sum += normals[k];
    squares += normals[k] * normals[k].transpose();
    for (std::size_t j = 0; j < k; ++j) closest.add((normals[k] - normals[j]).norm());
  }
  EXPECT_LT(sum.norm(), 1e-12);  // both are zero and 1/3 by the icosahedron's symmetry
  EXPECT_LT((squares - 54.0 * fsw::Matrix3::Identity()).norm(), 1e-10);
  EXPECT_GT(closest, 0.2);
}

// Integral of the cosine over a cap of the sphere: for an area that faces a disc of half angle a it is pi sin^2 a; here
// by rings and sectors of 1/400.
TEST(EarthLight, IsTheIntegralOverTheDisc) {
  const double half_angle = 1.1, sine = std::sin(half_angle);
  for (const double tilt : {0.0, 0.4, 0.9, 1.3, 1.6, 2.0, 2.5, 3.0}) {
    const Vector3 normal(std::sin(tilt), 0, std::cos(tilt));
    constexpr int kRings = 400, kAround = 800;
    double sum = 0.0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double cosine = 1.0 - (1.0 - std::cos(half_angle)) * (ring + 0.5) / kRings;
      const double radius = std::sqrt(1.0 - cosine * cosine);
      for (int k = 0; k < kAround; ++k) {
        const double turn = 2.0 * std::numbers::pi * (k + 0.5) / kAround;
        sum += std::max(0.0, normal.dot(Vector3(radius * std::cos(turn), radius * std::sin(turn), cosine)));
      }
    }
    const double solid_angle = 2.0 * std::numbers::pi * (1.0 - std::cos(half_angle)) / (kRings * kAround);
    const double expected = sum * solid_angle / (std::numbers::pi * sine * sine);
    EXPECT_NEAR(twins::camera::earth_light_factor(std::cos(tilt), sine), expected, 1e-4) << tilt;
  }
}

TEST(BoxLight, ReachesTheTargetFromTheSideOfTheBoxes) {
  const BoxLight light(bench());
  const auto irradiances = light.irradiances(Vector3(6.5, 0, 1.4));
  ASSERT_EQ(irradiances.rows(), 162);
  ASSERT_EQ(irradiances.cols(), 10);
  EXPECT_TRUE((irradiances.array() >= 0.0).all());
  const auto& normals = sphere_normals();
  for (Eigen::Index box = 0; box < 10; ++box) {
    Eigen::Index brightest = 0;
    for (Eigen::Index k = 1; k < irradiances.rows(); ++k)
      if (irradiances(k, box) > irradiances(brightest, box)) brightest = k;
    const Vector3 way = bench().boxes.boxes[static_cast<std::size_t>(box)].centre_m - Vector3(6.5, 0, 1.4);
    EXPECT_GT(normals[static_cast<std::size_t>(brightest)].dot(way.normalized()), 0.9);
    // A small source far off: exitance x area x cosine at the box / (pi distance^2); the sphere's point is 0.15 m
    // nearer, the box 0.6 m wide.
    const double cosine = -bench().boxes.boxes[static_cast<std::size_t>(box)].normal.dot(way.normalized());
    const double expected = 2.5 * 0.36 * cosine / (std::numbers::pi * way.squaredNorm());
    EXPECT_NEAR(irradiances(brightest, box) / expected, 1.1, 0.2) << box;
  }
}

TEST(BoxLight, OfNoEarthIsOff) {
  const BoxPowers powers = BoxLight(bench()).powers(Vector3(6.5, 0, 1.4), {});
  for (const double power : powers.power) EXPECT_EQ(power, 0.0);
  EXPECT_EQ(powers.misfit, 0.0);
}

// Twice the Earth's light is twice the power, until a box is at its limit; all powers are in 0 to 1.
TEST(BoxLight, PowersAreInProportionToTheEarth) {
  const BoxLight light(bench());
  for (const Vector3& direction : {Vector3(0, 1, 0), Vector3(1, 0.3, 0.2), Vector3(-1, 0, 0), Vector3(0, 0, 1)}) {
    EarthLight earth{direction.normalized(), 1.1, 1e-3};
    const BoxPowers weak = light.powers(Vector3(6.5, 0, 1.4), earth);
    earth.ratio = 2e-3;
    const BoxPowers strong = light.powers(Vector3(6.5, 0, 1.4), earth);
    for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(strong.power[k], 2.0 * weak.power[k], 1e-12);
    EXPECT_NEAR(strong.misfit, weak.misfit, 1e-12);
    earth.ratio = 50.0;
    const BoxPowers most = light.powers(Vector3(6.5, 0, 1.4), earth);
    for (const double power : most.power) {
      EXPECT_GE(power, 0.0);
      EXPECT_LE(power, 1.0);
    }
    EXPECT_GT(most.misfit, weak.misfit);
  }
}

// From a side with boxes the Earth is met better than from where the room has none.
TEST(BoxLight, MisfitTellsWhereBoxesAreMissing) {
  const BoxLight light(bench());
  const Vector3 target(6.5, 0, 1.4);
  const double wall = light.powers(target, {Vector3(0, 1, 0), 1.1, 0.2}).misfit;
  const double open = light.powers(target, {Vector3(-1, 0, 0), 1.1, 0.2}).misfit;
  EXPECT_LT(wall, 0.1);
  EXPECT_GT(open, wall);
  EXPECT_LE(open, 1.0);
}

// A box that gives half its light at full power gets no power beyond that.
TEST(BoxLight, KnowsWhatABoxCanGive) {
  std::array<double, kBoxes> half{};
  half.fill(0.5);
  const Vector3 target(6.5, 0, 1.4);
  const EarthLight weak{Vector3(0, 1, 0), 1.1, 1e-3}, strong{Vector3(0, 1, 0), 1.1, 50.0};
  const auto full_powers = BoxLight(bench()).powers(target, weak).power;
  const auto half_powers = BoxLight(bench(), half).powers(target, weak).power;
  for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(half_powers[k], full_powers[k], 1e-12);
  for (const double power : BoxLight(bench(), half).powers(target, strong).power) EXPECT_LE(power, 0.5);
}

TEST(BoxLight, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)BoxLight(bench()).powers(Vector3(6.5, 0, 1.4), {Vector3(0, nan, 1), 1.1, 0.2}),
               std::invalid_argument);
  EXPECT_THROW((void)BoxLight(bench()).powers(Vector3(6.5, nan, 1.4), {Vector3(0, 0, 1), 1.1, 0.2}),
               std::invalid_argument);
}

}  // namespace

// Form factors of a rectangle against Gauss-Legendre quadrature and against a closed form of another kind.

namespace {

/// Rectangle in the plane z = 0 with its bright side up.
std::array<Vector3, 4> rectangle(double half_x, double half_y) {
  return {Vector3(-half_x, -half_y, 0), Vector3(half_x, -half_y, 0), Vector3(half_x, half_y, 0),
          Vector3(-half_x, half_y, 0)};
}

/// Ten points of Gauss and Legendre (Abramowitz and Stegun, table 25.4) in each of `parts` intervals of -h to h.
template <class Function>
double integrated(double h, int parts, Function function) {
  constexpr std::array<double, 5> kAt{0.148874338981631211, 0.433395394129247191, 0.679409568299024406,
                                      0.865063366688984511, 0.973906528517171720};
  constexpr std::array<double, 5> kWeight{0.295524224714752870, 0.269266719309996355, 0.219086362515982044,
                                          0.149451349150580593, 0.066671344308688138};
  double sum = 0.0;
  const double half = h / parts;
  for (int part = 0; part < parts; ++part) {
    const double middle = -h + (2 * part + 1) * half;
    for (std::size_t k = 0; k < kAt.size(); ++k)
      sum += kWeight[k] * half * (function(middle + half * kAt[k]) + function(middle - half * kAt[k]));
  }
  return sum;
}

double by_quadrature(const Vector3& point, const Vector3& normal, double half_x, double half_y) {
  return integrated(half_x, 16, [&](double x) {
    return integrated(half_y, 16, [&](double y) {
      const Vector3 way = Vector3(x, y, 0) - point;
      const double distance2 = way.squaredNorm();
      return std::max(0.0, normal.dot(way)) * -way.z() / (std::numbers::pi * distance2 * distance2);
    });
  });
}

TEST(FormFactor, AgreesWithQuadratureAboveTheHorizon) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> place(-2.0, 2.0), height(0.4, 3.0);
  std::normal_distribution<double> normal;
  int compared = 0;
  while (compared < 200) {
    const Vector3 point(place(random), place(random), height(random));
    const Vector3 facing = Vector3(normal(random), normal(random), normal(random)).normalized();
    const auto corners = rectangle(0.3, 0.2);
    bool is_above = true;
    for (const Vector3& corner : corners) is_above = is_above && facing.dot(corner - point) > 0.0;
    if (!is_above) continue;
    ++compared;
    EXPECT_NEAR(form_factor(point, facing, corners), by_quadrature(point, facing, 0.3, 0.2), 1e-12);
  }
}

// The horizon cuts the rectangle along a line of x: quadrature over the part above it, to the line.
TEST(FormFactor, CountsThePartAboveTheHorizonOnly) {
  const Vector3 point(0.1, 0.05, 0.5);
  for (const double cut : {-0.2, -0.05, 0.0, 0.15, 0.29}) {
    // Horizon through the point and the line x = cut of the rectangle.
    const Vector3 along = Vector3(cut, 0, 0) - Vector3(point.x(), 0, point.z());
    Vector3 facing = Vector3::UnitY().cross(along).normalized();
    if (facing.x() < 0) facing = -facing;
    const double half = 0.5 * (0.3 - cut);
    const Vector3 shifted = point - Vector3(cut + half, 0, 0);
    EXPECT_NEAR(form_factor(point, facing, rectangle(0.3, 0.2)), by_quadrature(shifted, facing, half, 0.2), 1e-12)
        << cut;
    EXPECT_NEAR(form_factor(point, facing, rectangle(0.3, 0.2)) + form_factor(point, -facing, rectangle(0.3, 0.2)),
                by_quadrature(point, facing, 0.3, 0.2) + by_quadrature(point, -facing, 0.3, 0.2), 1e-3);
  }
}

// Howell, catalogue of configuration factors, B-3 (rectangle parallel to the element, a corner above it): four of a
// quarter each.
TEST(FormFactor, OfAParallelRectangleIsThatOfTheCatalogue) {
  const double a = 0.3, b = 0.2, c = 0.7;
  const double X = a / c, Y = b / c;
  const double quarter = (X / std::sqrt(1 + X * X) * std::atan(Y / std::sqrt(1 + X * X)) +
                          Y / std::sqrt(1 + Y * Y) * std::atan(X / std::sqrt(1 + Y * Y))) /
                         (2 * std::numbers::pi);
  EXPECT_NEAR(form_factor({0, 0, c}, -Vector3::UnitZ(), rectangle(a, b)), 4 * quarter, 1e-15);
}

TEST(FormFactor, OfAnEndlessPlaneIsOne) {
  EXPECT_NEAR(form_factor({0, 0, 1}, -Vector3::UnitZ(), rectangle(1e6, 1e6)), 1.0, 1e-9);
  EXPECT_NEAR(form_factor({0, 0, 1}, Vector3::UnitX(), rectangle(1e6, 1e6)), 0.5, 1e-6);
}

TEST(FormFactor, IsZeroBehindBelowAndInThePlane) {
  const auto corners = rectangle(0.3, 0.2);
  EXPECT_EQ(form_factor({0, 0, -1}, Vector3::UnitZ(), corners), 0.0);  // its back
  EXPECT_EQ(form_factor({0, 0, 1}, Vector3::UnitZ(), corners), 0.0);   // turned away
  EXPECT_EQ(form_factor({1, 0, 0}, -Vector3::UnitX(), corners), 0.0);  // in its plane
  EXPECT_EQ(form_factor({0, 0, 1}, -Vector3::UnitZ(), {}), 0.0);
}

}  // namespace

// Bounded least squares against the conditions of a minimum (Karush, Kuhn, Tucker), which for a convex problem are
// sufficient, and against the best of all sets of bounds.

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd A;
  VectorXd b;
};

Problem random_problem(std::mt19937& random, Index rows, Index columns) {
  std::normal_distribution<double> normal;
  Problem problem{MatrixXd(rows, columns), VectorXd(rows)};
  for (double& entry : problem.A.reshaped()) entry = std::abs(normal(random));
  VectorXd x(columns);
  for (double& entry : x) entry = 0.5 + normal(random);
  for (double& entry : problem.b) entry = 0.3 * normal(random);
  problem.b += problem.A * x;
  return problem;
}

/// Largest violation of the conditions of a minimum, relative.
double violation(const Problem& problem, const VectorXd& x) {
  const VectorXd descent = problem.A.transpose() * (problem.b - problem.A * x);
  accuracy::Largest worst;
  for (Index k = 0; k < x.size(); ++k) {
    if (!(x[k] >= 0.0 && x[k] <= 1.0)) return std::numeric_limits<double>::infinity();
    const double scale = problem.A.col(k).norm() * (problem.b.norm() + problem.A.norm());
    double excess = std::abs(descent[k]);
    if (x[k] == 0.0) excess = std::max(0.0, descent[k]);
    if (x[k] == 1.0) excess = std::max(0.0, -descent[k]);
    if (scale > 0.0) worst.add(excess / scale);
  }
  return worst;
}

TEST(BoundedLeastSquares, MeetsTheConditionsOfAMinimum) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto problem = random_problem(random, trial % 2 == 0 ? 162 : 12, 1 + trial % 12);
    const BoundedSolution solution = bounded_least_squares(problem.A, problem.b);
    ASSERT_TRUE(solution.has_converged) << trial;
    ASSERT_LT(violation(problem, solution.x), 1e-11) << trial;
    ASSERT_NEAR(solution.residual_norm, (problem.A * solution.x - problem.b).norm(), 1e-12);
  }
}

/// The smallest residual over all 3^n choices of which variable is at which bound or free.
double best_of_all_sets(const Problem& problem) {
  const Index n = problem.A.cols();
  accuracy::Smallest best;
  for (int code = 0; code < static_cast<int>(std::lround(std::pow(3, n))); ++code) {
    VectorXd x = VectorXd::Zero(n);
    std::vector<Index> free;
    for (Index k = 0, rest = code; k < n; ++k, rest /= 3) {
      if (rest % 3 == 1) x[k] = 1.0;
      if (rest % 3 == 2) free.push_back(k);
    }
    if (!free.empty()) {
      const VectorXd part = problem.A(Eigen::all, free).colPivHouseholderQr().solve(problem.b - problem.A * x);
      x(free) = part;
    }
    if (!((x.array() >= 0.0).all() && (x.array() <= 1.0).all())) continue;
    best.add((problem.A * x - problem.b).norm());
  }
  return best;
}

TEST(BoundedLeastSquares, FindsTheBestOfAllSetsOfBounds) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const auto problem = random_problem(random, 9, 5);
    EXPECT_NEAR(bounded_least_squares(problem.A, problem.b).residual_norm, best_of_all_sets(problem), 1e-11);
  }
}

// Two equal columns, and one that is zero: the minimum is reached, although x is not unique.
TEST(BoundedLeastSquares, ReachesTheMinimumWithDependentColumns) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    auto problem = random_problem(random, 20, 6);
    problem.A.col(3) = problem.A.col(1);
    problem.A.col(4).setZero();
    const BoundedSolution solution = bounded_least_squares(problem.A, problem.b);
    ASSERT_TRUE(solution.has_converged);
    ASSERT_LT(violation(problem, solution.x), 1e-11) << trial;
    EXPECT_EQ(solution.x[4], 0.0);
  }
}

TEST(BoundedLeastSquares, OfZeroIsZero) {
  const BoundedSolution solution = bounded_least_squares(MatrixXd::Ones(3, 2), VectorXd::Zero(3));
  EXPECT_TRUE(solution.x.isZero());
}

TEST(BoundedLeastSquares, RefusesWhatIsNotFinite) {
  MatrixXd A = MatrixXd::Ones(3, 2);
  VectorXd b = VectorXd::Ones(3);
  b[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)bounded_least_squares(A, b), std::invalid_argument);
  EXPECT_THROW((void)bounded_least_squares(A, VectorXd::Ones(2)), std::invalid_argument);
  EXPECT_THROW((void)bounded_least_squares(MatrixXd::Ones(1, 2), VectorXd::Ones(1)), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::tron
