// Do two builds of the flight mathematics give the same bits? Prints one digest a line; the lines of two targets can be
// compared by diff. Those of the elementary functions are also compared here with what Debian's ARM build of newlib
// (libnewlib-arm-none-eabi 3.3.0, libm.a as shipped, under qemu-arm) gives over the same arguments: exit status 1 where
// not.

#include <cinttypes>
#include <cstdio>

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/safety/collision_probability.h"
#include "fsw/safety/passive_safety.h"
#include "tests/unit/fsw/same_bits/ambiguity_digest.h"
#include "tests/unit/fsw/same_bits/gnss_digest.h"
#include "tests/unit/fsw/same_bits/imaging_digest.h"
#include "tests/unit/fsw/same_bits/libm_sweeps.h"
#include "tests/unit/fsw/same_bits/network_digest.h"
#include "tests/unit/fsw/same_bits/solver_digest.h"
#include "tests/unit/fsw/same_bits/stars_digest.h"

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
