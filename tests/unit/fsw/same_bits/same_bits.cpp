// Do two builds of the flight mathematics give the same bits? Prints one digest a line; the lines of two targets can be
// compared by diff. Those of the elementary functions are also compared here with what Debian's ARM build of newlib
// (libnewlib-arm-none-eabi 3.3.0, libm.a as shipped, under qemu-arm) gives over the same arguments: exit status 1 where
// not.

#include <array>
#include <bit>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"
#include "fsw/gnss/ambiguity_validation.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/ionosphere.h"
#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"
#include "fsw/safety/collision_probability.h"
#include "fsw/safety/passive_safety.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/object_detector.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "fsw/vision/stars/catalogue.h"
#include "fsw/vision/stars/star_identification.h"
#include "tests/unit/fsw/same_bits/digest.h"
#include "tests/unit/fsw/vision/pose/plain_network.h"

namespace vbar::same_bits {
namespace {

// Digests of the elementary functions over 20,000 arguments each. The functions come in as a table, so that the same
// sweeps can be run over another library.

using Unary = double (*)(double);
using Binary = double (*)(double, double);

constexpr int kSweep = 20000;

/// Over arguments of any magnitude from 2^low to 2^high.
std::uint64_t sweep_magnitudes(Unary f, int low, int high) {
  Arguments arguments(1);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) digest.add(f(arguments.magnitude(low, high)));
  return digest.value();
}

std::uint64_t sweep_interval(Unary f, double low, double high) {
  Arguments arguments(2);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) digest.add(f(arguments.between(low, high)));
  return digest.value();
}

std::uint64_t sweep_box(Binary f, double x_low, double x_high, double y_low, double y_high) {
  Arguments arguments(3);
  Digest digest;
  for (int k = 0; k < kSweep; ++k) {
    const double x = arguments.between(x_low, x_high);
    digest.add(f(x, arguments.between(y_low, y_high)));
  }
  return digest.value();
}

// Digest of the optimising control solvers' plans over random problems.

void add(Digest& digest, const fsw::Result<fsw::control::Plan>& plan) {
  digest.add(static_cast<double>(plan.status()));
  for (std::size_t k = 0; k < plan.value().count; ++k) {
    const fsw::control::Burn& burn = plan.value().burns[k];
    digest.add(static_cast<double>(burn.time.ns));
    for (int axis = 0; axis < 3; ++axis) digest.add(burn.dv_rtn(axis));
  }
}

/// Horizons of 0.2 to 3 orbits, changes of up to kilometres, every kind of thruster.
std::uint64_t solver_digest() {
  namespace control = fsw::control;
  Arguments arguments(6);
  Digest digest;
  const auto workspace = std::make_unique<control::KoenigDamicoWorkspace>();
  constexpr control::ThrustCost kCosts[] = {control::ThrustCost::kSteerable, control::ThrustCost::kOrthogonalPairs,
                                            control::ThrustCost::kRadialAndPlane};
  for (int k = 0; k < 60; ++k) {
    control::ControlProblem problem;
    problem.arrival = problem.start + fsw::nearest_duration(arguments.between(1200.0, 18000.0));
    problem.servicer_mean = {.a = arguments.between(6.9e6, 7.6e6),
                             .ex = arguments.between(-0.01, 0.01),
                             .ey = arguments.between(-0.01, 0.01),
                             .i = arguments.between(0.5, 2.5),
                             .raan = 0.0,
                             .u = arguments.between(-3.0, 3.0)};
    for (int j = 0; j < 6; ++j) problem.pseudo_state(j) = arguments.magnitude(-23, -14);
    control::KoenigDamicoSettings settings;
    settings.cost = kCosts[k % 3];
    add(digest, control::solve_koenig_damico(problem, settings, *workspace));
    add(digest, control::solve_least_squares(problem));
  }
  return digest.value();
}

// A digest of satellite states and ionospheric delays over random elements of every kind that is accepted.

fsw::gnss::Ephemeris random_ephemeris(Arguments& arguments, int k) {
  using fsw::gnss::Constellation;
  constexpr std::int64_t kToe = 345'600;
  fsw::gnss::Ephemeris e;
  e.satellite.constellation = static_cast<Constellation>(k % 3);
  e.satellite.prn = static_cast<std::uint8_t>(1 + k / 3 % 32);  // geostationary ones of BeiDou among them
  const std::int64_t ahead = e.satellite.constellation == Constellation::kBeidou ? 14 : 0;
  e.toe = fsw::GpsTime{} + fsw::duration_of_seconds(1658LL * 604'800 + kToe + ahead);
  e.toc = e.toe;
  e.toe_of_week_s = static_cast<double>(kToe);
  e.sqrt_a = arguments.between(5100.0, 6500.0);
  e.e = arguments.between(0.0, 0.03);
  for (double* angle : {&e.m0, &e.omega0, &e.i0, &e.omega}) *angle = arguments.between(-3.1, 3.1);
  for (double* rate : {&e.delta_n, &e.omega_dot, &e.i_dot}) *rate = arguments.between(-1e-9, 1e-9);
  for (double* harmonic : {&e.cuc, &e.cus, &e.cic, &e.cis}) *harmonic = arguments.between(-6e-5, 6e-5);
  for (double* harmonic : {&e.crc, &e.crs}) *harmonic = arguments.between(-1000.0, 1000.0);
  e.af0 = arguments.between(-1e-3, 1e-3);
  e.af1 = arguments.between(-1e-9, 1e-9);
  e.af2 = arguments.between(-1e-15, 1e-15);
  return e;
}

std::uint64_t gnss_digest() {
  Arguments arguments(6);
  Digest digest;
  for (int k = 0; k < 2000; ++k) {
    const fsw::gnss::Ephemeris e = random_ephemeris(arguments, k);
    const fsw::GpsTime time = e.toe + fsw::nearest_duration(arguments.between(-14'400.0, 14'400.0));
    const fsw::gnss::SatelliteState state = fsw::gnss::satellite_state(e, time).value();
    for (int axis = 0; axis < 3; ++axis) {
      digest.add(state.position_ecef(axis));
      digest.add(state.velocity_ecef(axis));
    }
    digest.add(state.clock_s);
    digest.add(state.clock_drift);
    const fsw::gnss::KlobucharCoefficients coefficients{.alpha = {2.5e-8, -7.5e-9, -1.2e-7, 1.2e-7},
                                                        .beta = {1.3e5, -1.6e4, -2.0e5, -6.5e4}};
    const fsw::gnss::LineOfSight sight{.latitude = arguments.between(-1.5, 1.5),
                                       .longitude = arguments.between(-3.1, 3.1),
                                       .azimuth = arguments.between(-3.1, 3.1),
                                       .elevation = arguments.between(0.0, 1.5)};
    digest.add(fsw::gnss::klobuchar_delay_l1_m(coefficients, sight, time).value());
  }
  return digest.value();
}

// Digest of decisions on float ambiguities over random problems: factorisation, reduction, search and validation.

/// Double differences of one epoch: directions in space times an uncertain baseline, and a noise with one satellite in
/// common. From four to 48 ambiguities, strong to hopeless.
std::uint64_t ambiguity_digest() {
  namespace gnss = fsw::gnss;
  Arguments arguments(7);
  Digest digest;
  const auto workspace = std::make_unique<gnss::ValidationWorkspace>();
  constexpr std::size_t kMax = 48;
  std::array<double, kMax> floats{};
  std::array<double, kMax * kMax> covariance{};
  std::array<std::array<double, 3>, kMax> direction{};
  for (std::size_t k = 0; k < 90; ++k) {
    const std::size_t n = 4 + k / 2;
    const double baseline_cycles2 = arguments.between(0.05, 9.0);
    const double noise_cycles2 = arguments.between(1e-5, 1e-3);
    for (std::size_t i = 0; i < n; ++i) {
      for (double& component : direction[i]) component = arguments.between(-1.0, 1.0);
      floats[i] = arguments.between(-1e5, 1e5);
    }
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        double along = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) along += direction[i][axis] * direction[j][axis];
        covariance[i + j * n] = baseline_cycles2 * along + noise_cycles2 * (i == j ? 2.0 : 1.0);
      }
    }
    // Near integers for half of them: along a baseline error, with noise.
    if (k % 2 == 0) {
      std::array<double, 3> error{};
      for (double& component : error) component = arguments.between(-0.3, 0.3);
      for (std::size_t i = 0; i < n; ++i) {
        floats[i] = static_cast<double>(i * i) + arguments.between(-0.01, 0.01);
        for (std::size_t axis = 0; axis < 3; ++axis) floats[i] += direction[i][axis] * error[axis];
      }
    }
    const fsw::Result<gnss::AmbiguityDecision> result =
        gnss::decide_ambiguities(std::span(floats).first(n), std::span(covariance).first(n * n), {}, *workspace);
    const gnss::AmbiguityDecision& decision = result.value();
    digest.add(static_cast<double>(result.status()));
    digest.add(static_cast<double>(decision.rejection_reason));
    digest.add(static_cast<double>(decision.tried));
    for (std::size_t i = 0; i < decision.count; ++i) {
      digest.add(static_cast<double>(decision.position[i]));
      digest.add(decision.whole[i]);
    }
    for (const double number : {decision.success_rate, decision.ratio, decision.residual}) digest.add(number);
  }
  return digest.value();
}

// A digest of what is found in images of whole numbers: stars, a saturated disc, a gradient, a gap.

std::vector<std::uint16_t> arbitrary_image(Arguments& arguments, int width, int height) {
  std::vector<std::uint16_t> pixels;
  for (int k = 0; k < width * height; ++k) {
    const double noise = arguments.between(0.0, 3.0) + arguments.between(0.0, 3.0);
    pixels.push_back(static_cast<std::uint16_t>(60.0 + 0.05 * (k % width) + noise));
  }
  const auto brighten = [&](int x, int y, int by) {
    std::uint16_t& pixel = pixels[static_cast<std::size_t>(y * width + x)];
    pixel = static_cast<std::uint16_t>(pixel + by < 4095 ? pixel + by : 4095);
  };
  for (int star = 0; star < 60; ++star) {
    const int x = static_cast<int>(arguments.between(3.0, width - 4.0));
    const int y = static_cast<int>(arguments.between(3.0, height - 4.0));
    const int light = static_cast<int>(arguments.between(30.0, 3000.0));
    constexpr std::array<int, 3> kShare{1, 2, 1};
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        brighten(x + i - 1, y + j - 1,
                 light * kShare[static_cast<std::size_t>(i)] * kShare[static_cast<std::size_t>(j)] / 4);
      }
    }
  }
  for (int j = -9; j <= 9; ++j) {
    for (int i = -9; i <= 9; ++i) {
      if (i * i + j * j < 90) brighten(width / 3 + i, height / 2 + j, 9000);
    }
  }
  for (int k = 0; k < 868; ++k) pixels[static_cast<std::size_t>(width * height / 4 + k)] = fsw::imaging::kMissingPixel;
  return pixels;
}

std::uint64_t imaging_digest() {
  Arguments arguments(7);
  Digest digest;
  const auto detector = std::make_unique<fsw::imaging::ObjectDetector>();
  const fsw::imaging::CameraModel camera{.focal_length_px = {5972.7, 5970.1},
                                         .principal_point_px = {150.3, 120.1},
                                         .distortion = {-0.1, 0.3, 0.001, -0.002, 0.1}};
  for (int image = 0; image < 5; ++image) {
    const std::vector<std::uint16_t> pixels = arbitrary_image(arguments, 300, 250);
    const fsw::imaging::DetectionReport report =
        detector->detect({{.width = 300, .height = 250}, pixels}, {.detection_sigmas = 4.0});
    digest.add(report.background_dn);
    digest.add(report.noise_dn);
    digest.add(static_cast<double>(report.components));
    for (const fsw::imaging::DetectedObject& object : detector->objects()) {
      for (const double x : {object.centroid_px.x(), object.centroid_px.y(), object.sigma_px, object.flux_dn,
                             object.radius_px, static_cast<double>(object.pixels)}) {
        digest.add(x);
      }
      const fsw::Vector3 direction = fsw::imaging::direction_of(camera, object.centroid_px).value();
      for (int axis = 0; axis < 3; ++axis) digest.add(direction(axis));
    }
  }
  return digest.value();
}

// A digest of attitudes from stars: images drawn from the catalogue itself, with noise and objects that are no stars,
// lost in space and tracked. The catalogue's own bytes are in it by what is found.

fsw::Matrix3 random_camera(Arguments& arguments) {
  // Braces: drawn from left to right, which parentheses leave to the compiler.
  const auto draw = [&arguments] {
    return fsw::Vector3{arguments.between(-1.0, 1.0), arguments.between(-1.0, 1.0), arguments.between(-1.0, 1.0)};
  };
  const fsw::Vector3 z = draw().normalized();
  const fsw::Vector3 x = z.cross(draw()).normalized();
  fsw::Matrix3 R_camera_eci;
  R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_camera_eci;
}

void add_fix(Digest& digest, fsw::Status status, const fsw::stars::AttitudeFix& fix) {
  digest.add(static_cast<double>(status));
  if (status != fsw::Status::kOk) return;
  for (int k = 0; k < 9; ++k) digest.add(fix.R_camera_eci(k / 3, k % 3));
  digest.add(fix.sigma_rad);
  digest.add(fix.chi_square);
  digest.add(fix.log_chance);
  digest.add(fix.matches);
}

std::uint64_t stars_digest() {
  static fsw::stars::StarIdentifier identifier;
  static std::array<int, 512> in_cone;
  static std::array<fsw::stars::ObservedStar, 128> objects;
  constexpr double kSigma = 1.7e-5;
  const fsw::stars::Field field{fsw::Vector3::UnitZ(), 0.07};
  Arguments arguments(8);
  Digest digest;
  for (int image = 0; image < 60; ++image) {
    const fsw::Matrix3 R_camera_eci = random_camera(arguments);
    const fsw::GpsTime time{fsw::duration_of_seconds(1'000'000'000 + image * 100'000LL).ns};
    const fsw::Vector3 velocity = fsw::orbit::earth_velocity_over_c_gcrf(time);
    for (int axis = 0; axis < 3; ++axis) digest.add(fsw::orbit::sun_position_gcrf(time)(axis));
    const int near = fsw::stars::stars_in_cone(R_camera_eci.row(2), field.radius_rad, in_cone).value();
    std::size_t count = 0;
    const auto place = [&](const fsw::Vector3& direction, double magnitude) {
      const fsw::Vector3 noise{arguments.between(-kSigma, kSigma), arguments.between(-kSigma, kSigma), 0.0};
      if (count < objects.size()) objects[count++] = {(direction + noise).normalized(), kSigma, magnitude};
    };
    for (int k = 0; k < near; ++k) {
      const int star = in_cone[static_cast<std::size_t>(k)];
      place(R_camera_eci * (fsw::stars::star_direction_eci(star) + velocity), fsw::stars::star_magnitude(star));
    }
    for (int k = 0; k < 8; ++k) {
      const fsw::Vector3 direction{arguments.between(-0.05, 0.05), arguments.between(-0.05, 0.05), 1.0};
      place(direction, arguments.between(2.0, 8.0));
    }
    const std::span<const fsw::stars::ObservedStar> seen(objects.data(), count);
    add_fix(digest, identifier.lost_in_space(seen, field, velocity), identifier.fix());
    fsw::Matrix3 turned = R_camera_eci;
    turned.row(0) += 1e-3 * R_camera_eci.row(1);
    turned.row(1) -= 1e-3 * R_camera_eci.row(0);
    add_fix(digest, identifier.track(seen, field, turned, 1.5e-3, velocity), identifier.fix());
  }
  return digest.value();
}

// A digest of the keypoint network's maps, of the weights on board and of weights and samples so small that a processor
// which flushes denormal numbers would show it.

void add_maps(Digest& digest, std::span<const std::byte> weights, const test::Crop& crop) {
  const auto network = std::make_unique<fsw::pose::KeypointNetwork>();
  digest.add(static_cast<double>(network->load(weights)));
  digest.add(static_cast<double>(network->run(crop)));
  for (int k = 0; k < fsw::pose::kKeypoints; ++k) {
    for (const float logit : network->logits(k)) digest.add(static_cast<double>(logit));
  }
}

std::uint64_t network_digest() {
  Digest digest;
  add_maps(digest, fsw::pose::weights_on_board(), test::structured_crop());
  add_maps(digest, test::tiny_file(8), test::tiny_crop(8));
  return digest.value();
}

}  // namespace
}  // namespace vbar::same_bits

namespace {

using namespace vbar::same_bits;
namespace math = vbar::fsw::math;
namespace orbit = vbar::fsw::orbit;

struct Line {
  const char* name;
  std::uint64_t digest;
  std::uint64_t arm_newlib;
};

const Line kElementary[] = {
    {"sin", sweep_magnitudes(math::sin, -30, 200), 0x7A5E73AB198EA01A},
    {"cos", sweep_magnitudes(math::cos, -30, 200), 0x985F8995F0CC0CF0},
    {"tan", sweep_magnitudes(math::tan, -30, 200), 0x72D477A7C753F2A2},
    {"asin", sweep_interval(math::asin, -1.0, 1.0), 0xA902762ECE448C5E},
    {"acos", sweep_interval(math::acos, -1.0, 1.0), 0x2A7F38DB387D29FC},
    {"atan", sweep_magnitudes(math::atan, -30, 70), 0x64B6CBFED1F8C86F},
    {"exp", sweep_interval(math::exp, -740.0, 709.0), 0xFA3FFD4EF723702D},
    {"log", sweep_interval(math::log, 1e-3, 1e3), 0x8D1DF8ED61D91686},
    {"erf", sweep_magnitudes(math::erf, -30, 3), 0x11BB034F26512EAD},
    {"erfc", sweep_interval(math::erfc, -7.0, 27.0), 0x0A85391352BF8BFC},
    {"atan2", sweep_box(math::atan2, -2.0, 2.0, -2.0, 2.0), 0x9780D41C24562BD8},
    {"pow", sweep_box(math::pow, 0.0, 3.0, -500.0, 500.0), 0xF2CAEEEAB1F8BFAE},
    {"fmod", sweep_box(math::fmod, -1e5, 1e5, 1e-3, 10.0), 0xFAE5BFA7CA9CCDC3},
};

template <class Matrix>
void add(Digest& digest, const Matrix& m) {
  for (int column = 0; column < m.cols(); ++column) {
    for (int row = 0; row < m.rows(); ++row) digest.add(m(row, column));
  }
}

void add(Digest& digest, const orbit::QnsElements& q) {
  for (double x : {q.a, q.ex, q.ey, q.i, q.raan, q.u}) digest.add(x);
}

/// Every function of the orbit library over orbits of any shape it accepts, in low orbit where Brouwer's theory holds.
std::uint64_t orbit_digest() {
  Arguments arguments(4);
  Digest digest;
  for (int k = 0; k < 2000; ++k) {
    const orbit::QnsElements mean{.a = arguments.between(7.0e6, 8.0e6),
                                  .ex = arguments.between(-0.07, 0.07),
                                  .ey = arguments.between(-0.07, 0.07),
                                  .i = arguments.between(0.1, 3.0),
                                  .raan = arguments.between(-3.0, 3.0),
                                  .u = arguments.between(-10.0, 300.0)};
    vbar::fsw::Vector6 roe;
    for (int j = 0; j < 6; ++j) roe(j) = arguments.between(-1e-3, 1e-3);
    const orbit::QnsElements osculating = orbit::osculating_from_mean(mean).value();
    add(digest, osculating);
    add(digest, orbit::mean_from_osculating(osculating).value());
    const orbit::CartesianState state = orbit::cartesian_from_qns(osculating).value();
    add(digest, orbit::qns_from_cartesian(state).value());
    const orbit::CartesianState later = orbit::propagate_j2(state, 95.0).value();
    add(digest, later.position_eci);
    add(digest, later.velocity_eci);
    const orbit::RelativeState relative = orbit::relative_state_from_mean_roe(mean, roe).value();
    add(digest, relative.position_rtn);
    add(digest, relative.velocity_rtn);
    add(digest, orbit::roe_transition_j2(mean, 20000.0));
    add(digest, orbit::roe_control_matrix(mean));
    add(digest, orbit::roe_from_rtn_linear(mean, orbit::rtn_from_roe_linear(mean, roe)));
    add(digest, orbit::roe_from_qns(mean, orbit::propagate_secular(mean, 5000.0)));
  }
  return digest.value();
}

/// Drifts and probabilities of random relative orbits within a kilometre.
std::uint64_t safety_digest() {
  namespace safety = vbar::fsw::safety;
  Arguments arguments(5);
  Digest digest;
  for (int k = 0; k < 100; ++k) {
    const orbit::QnsElements servicer{
        .a = 7.1e6, .ex = 1e-3, .ey = -2e-4, .i = 1.7, .raan = 0.3, .u = arguments.between(-3.0, 3.0)};
    vbar::fsw::Vector6 roe;
    for (int j = 0; j < 6; ++j) roe(j) = arguments.between(-1e-4, 1e-4);
    const safety::DriftSafety drift = safety::assess_drift(servicer, roe, 9000.0, {.radial_normal = 1.0}).value();
    for (const safety::Closest& c : {drift.spatial, drift.radial_normal}) {
      digest.add(c.distance);
      digest.add(c.time);
    }
    vbar::fsw::Matrix3 root;
    for (int j = 0; j < 9; ++j) root(j / 3, j % 3) = arguments.between(-5.0, 5.0);
    vbar::fsw::Vector3 mean;
    for (int j = 0; j < 3; ++j) mean(j) = arguments.between(-9.0, 9.0);
    const vbar::fsw::Matrix3 covariance = root * root.transpose() + vbar::fsw::Matrix3::Identity();
    digest.add(safety::collision_probability(mean, covariance, 3.0).value());
  }
  return digest.value();
}

}  // namespace

int main() {
  bool same = true;
  for (const Line& line : kElementary) {
    std::printf("%-6s %016" PRIx64 "\n", line.name, line.digest);
    if (line.digest != line.arm_newlib) {
      std::fprintf(stderr, "%s: not the bits of newlib's ARM library, %016" PRIx64 "\n", line.name, line.arm_newlib);
      same = false;
    }
  }
  std::printf("%-6s %016" PRIx64 "\n", "orbit", orbit_digest());
  std::printf("%-6s %016" PRIx64 "\n", "safety", safety_digest());
  std::printf("%-6s %016" PRIx64 "\n", "solver", solver_digest());
  std::printf("%-6s %016" PRIx64 "\n", "gnss", gnss_digest());
  std::printf("%-6s %016" PRIx64 "\n", "lambda", ambiguity_digest());
  std::printf("%-6s %016" PRIx64 "\n", "stars", stars_digest());
  std::printf("%-6s %016" PRIx64 "\n", "imaging", imaging_digest());
  std::printf("%-6s %016" PRIx64 "\n", "network", network_digest());
  return same ? 0 : 1;
}
