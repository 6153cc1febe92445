// One, two or fifty spacecraft under all forces, on any number of threads, asked for at any times: the same bits.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/host_sim/truth/all_forces.h"

namespace vbar::truth {
namespace {

using fsw::orbit::CartesianState;

constexpr std::int64_t kFlight_s =
    5400;  // most of a revolution, with the shadow's edges and a three-hourly jump (3h UTC)

/// Spacecraft all around the orbit, each with its own mass.
std::vector<CartesianState> fly(int count, int threads, std::int64_t every_s) {
  TruthSettings settings = test::all_forces_settings();
  settings.epoch = gps_from_utc("2011-07-18T02:00:00Z");
  settings.gravity_degree = settings.gravity_order = 20;
  settings.tolerance = 1e-10;
  settings.threads = threads;
  TruthModel model(settings);
  for (int k = 0; k < count; ++k) {
    SpacecraftSettings spacecraft = test::mango("s" + std::to_string(k), 8e5 * k);
    spacecraft.surface.mass_kg += k;
    model.add_spacecraft(spacecraft);
  }
  for (std::int64_t t = every_s; t <= kFlight_s; t += every_s) {
    model.advance_to(settings.epoch + fsw::duration_of_seconds(t));
    static_cast<void>(model.accelerations(0));  // looking on changes nothing either
  }
  std::vector<CartesianState> states;
  for (std::size_t k = 0; k < model.spacecraft_count(); ++k) states.push_back(model.state(k));
  return states;
}

void expect_same(const std::vector<CartesianState>& a, const std::vector<CartesianState>& b, const std::string& what) {
  ASSERT_LE(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(test::same_bits(a[k], b[k])) << what << ", spacecraft " << k;
}

TEST(Threads, AllForcesGiveTheSameBits) {
  const std::vector<CartesianState> fifty = fly(50, 1, kFlight_s);
  for (int threads = 2; threads <= 8; ++threads) {
    expect_same(fly(50, threads, kFlight_s), fifty, std::to_string(threads) + " threads");
  }
  expect_same(fly(1, 1, kFlight_s), fifty, "alone");
  for (int threads : {1, 2, 8}) expect_same(fly(2, threads, kFlight_s), fifty, "two of them");
  expect_same(fly(50, 3, 300), fifty, "in pieces of five minutes");
  expect_same(fly(2, 2, 60), fifty, "two in minutes");
}

}  // namespace
}  // namespace vbar::truth
