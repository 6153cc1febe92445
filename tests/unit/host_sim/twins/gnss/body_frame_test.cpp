#include "host_sim/twins/gnss/body_frame.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace vbar::twins::gnss {
namespace {

constexpr int kDraws = 4000;

// Appendix A: centre of mass uniform in a ball of 3 mm (mean square 3/5 R^2), phase centre 5 mm in a direction drawn
// (mean square of a component L^2/3), antenna 30 and attitude 20 arcsec. Sample mean squares of 4000 are
// within 10 % (4 sigma and more).
TEST(BodyFrame, DrawsAreThoseOfTheTable) {
  const BodyFrameSettings settings;
  double com_square = 0.0, pco_z_square = 0.0, antenna_square = 0.0, attitude_square = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    const BodyFrameErrors errors = draw_body_frame(settings, seed, "servicer");
    EXPECT_LE(errors.com_m.norm(), 3e-3);
    EXPECT_NEAR(errors.pco_m.norm(), 5e-3, 1e-12);
    com_square += errors.com_m.squaredNorm();
    pco_z_square += errors.pco_m.z() * errors.pco_m.z();
    antenna_square += errors.antenna_rotation.squaredNorm();
    attitude_square += errors.attitude_rotation.squaredNorm();
  }
  EXPECT_NEAR(com_square / kDraws / (0.6 * 9e-6), 1.0, 0.1);
  EXPECT_NEAR(pco_z_square / kDraws / (25e-6 / 3.0), 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(antenna_square / kDraws / 3.0) / kArcsecond, 30.0, 1.5);
  EXPECT_NEAR(std::sqrt(attitude_square / kDraws / 3.0) / kArcsecond, 20.0, 1.0);
}

// The floor's formula against its own definition over 4000 pairs of draws. By hand: sqrt(2 (5^2 + 0.6 3^2)) = 7.80 mm;
// the 0.3 m arm under 20 arcsec adds 0.04 mm to each.
TEST(BodyFrame, StaticFloor) {
  const BodyFrameSettings settings;
  double square = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed)
    square += static_floor_m(settings, draw_body_frame(settings, seed, "servicer"), settings,
                             draw_body_frame(settings, seed, "target"))
                  .squaredNorm();
  EXPECT_NEAR(static_floor_rms_m(settings, settings) * 1e3, 7.80, 0.01);
  EXPECT_NEAR(std::sqrt(square / kDraws) / static_floor_rms_m(settings, settings), 1.0, 0.03);
}

// A small rotation of the body carries the antenna along: 0.3 m by 20 arcsec is 29 micrometres.
TEST(BodyFrame, AttitudeErrorMovesTheAntenna) {
  BodyFrameSettings settings;
  BodyFrameErrors errors;
  errors.attitude_rotation = fsw::Vector3(20.0 * kArcsecond, 0.0, 0.0);
  const fsw::Vector3 moved = antenna_from_com(settings, errors) - settings.antenna_in_body_m;
  EXPECT_NEAR(moved.y() * 1e6, -29.09, 0.01);
  EXPECT_NEAR(true_boresight(settings, errors).y(), -20.0 * kArcsecond, 1e-12);
}

}  // namespace
}  // namespace vbar::twins::gnss
