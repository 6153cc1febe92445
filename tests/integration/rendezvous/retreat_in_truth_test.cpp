// The retreat from every third minute between waypoints 7 and 10, in the truth model: at once, and after 10 and 35
// minutes without a burn, with a semi-major axis in error by 5 cm and differential drag of 1e-9 m/s^2, of which the
// retreat allows for both signs.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/safety/retreat.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/simulation/initial_state.h"
#include "host_sim/truth/truth_model.h"
#include "tests/integration/rendezvous/run_mission.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;

constexpr const char* kMission = "ideal_navigation.toml";
constexpr double kFrom_s = 36.0 * 3600.0;  // waypoint 7
constexpr double kApart_s = 180.0;
constexpr std::size_t kInstants = 106;
constexpr std::array kDelays_s{0.0, 600.0, 2100.0};
constexpr std::array kSigns{-1.0, 1.0};
constexpr double kHorizon_s = 86400.0;
constexpr double kDragImpulsesApart_s = 300.0;
constexpr double kStep_s = 60.0;
constexpr double kLargestRetreat = 5e-3;  // m/s
const fsw::safety::RetreatSettings kSettings;

struct Outcome {
  accuracy::Smallest distance;  ///< m, of all instants, signs and times
  accuracy::Largest dv;         ///< m/s
};

Vector3 vector(const report::Triple& triple) {
  return {triple[0], triple[1], triple[2]};
}

QnsElements mean_elements(const CartesianState& state) {
  return fsw::orbit::mean_from_osculating(fsw::orbit::qns_from_cartesian(state).value()).value();
}

/// Least distance between the states now and the next ones, a step later, for a relative motion that is linear.
double distance_between(const Vector3& now, const Vector3& next) {
  const Vector3 moved = next - now;
  const double length2 = moved.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp(-now.dot(moved) / length2, 0.0, 1.0) : 0.0;
  return (now + share * moved).norm();
}

/// All retreats from one instant of the mission: one target, a servicer as estimated, and one for each delay and sign.
class Instant {
 public:
  Instant(truth::TruthSettings settings, fsw::GpsTime time, const report::TruthRow& row)
      : settings_(begun_at(std::move(settings), time)), truth_(settings_) {
    target_ = truth_.add_spacecraft("target", {vector(row.target_position_eci), vector(row.target_velocity_eci)});
    const CartesianState servicer{vector(row.servicer_position_eci), vector(row.servicer_velocity_eci)};
    estimated_ = truth_.add_spacecraft("estimated", servicer);
    mean_motion_ = fsw::orbit::mean_motion(mean_elements(servicer).a);
    for (const double delay_s : kDelays_s) {
      for (const double sign : kSigns) {
        const std::string name = "retreats" + std::to_string(flights_.size());
        flights_.push_back({truth_.add_spacecraft(name, servicer), delay_s, sign});
      }
    }
    for (const Flight& flight : flights_) {
      // A velocity along track of n/2 da is a semi-major axis of da.
      const double dv = 0.5 * mean_motion_ * kSettings.a_da_error_m * flight.sign;
      truth_.apply_impulse_rtn(flight.servicer, {0.0, dv, 0.0});
    }
  }

  /// One outcome for each delay, added to these.
  void fly(std::array<Outcome, kDelays_s.size()>& outcomes) {
    const double end_s = kDelays_s.back() + kHorizon_s;
    for (double at_s = 0.0; at_s < end_s; at_s += kStep_s) {
      retreat_at(at_s, outcomes);
      if (std::fmod(at_s, kDragImpulsesApart_s) == 0.0) apply_drag();
      std::vector<Vector3> before;
      for (const Flight& flight : flights_) before.push_back(relative(flight));
      truth_.advance_to(settings_.epoch + fsw::nearest_duration(at_s + kStep_s));
      for (std::size_t k = 0; k < flights_.size(); ++k) {
        if (at_s >= flights_[k].delay_s + kHorizon_s) continue;
        outcomes[k / kSigns.size()].distance.add(distance_between(before[k], relative(flights_[k])));
      }
    }
  }

 private:
  struct Flight {
    std::size_t servicer = 0;
    double delay_s = 0.0;
    double sign = 0.0;
  };

  static truth::TruthSettings begun_at(truth::TruthSettings settings, fsw::GpsTime time) {
    settings.epoch = time;
    settings.end = time + fsw::nearest_duration(kDelays_s.back() + kHorizon_s + kStep_s);
    return settings;
  }

  Vector3 relative(const Flight& flight) const {
    return truth_.state(target_).position_eci - truth_.state(flight.servicer).position_eci;
  }

  /// The burn is chosen from what is estimated, without the errors.
  void retreat_at(double at_s, std::array<Outcome, kDelays_s.size()>& outcomes) {
    if (std::ranges::find(kDelays_s, at_s) == kDelays_s.end()) return;
    const QnsElements servicer = mean_elements(truth_.state(estimated_));
    const fsw::Vector6 a_roe_m = servicer.a * fsw::orbit::roe_from_qns(servicer, mean_elements(truth_.state(target_)));
    fsw::safety::RetreatSettings settings = kSettings;
    settings.unmeasured = at_s;
    const auto burn = fsw::safety::find_retreat(servicer, a_roe_m, settings);
    ASSERT_TRUE(burn.ok());
    for (std::size_t k = 0; k < flights_.size(); ++k) {
      if (flights_[k].delay_s != at_s) continue;
      truth_.apply_impulse_rtn(flights_[k].servicer, burn.value().dv_rtn);
      outcomes[k / kSigns.size()].dv.add(burn.value().dv_rtn.norm());
    }
  }

  /// Along track, with the sign of the error of its semi-major axis.
  void apply_drag() {
    for (const Flight& flight : flights_) {
      const double dv = kSettings.differential_drag * kDragImpulsesApart_s * flight.sign;
      truth_.apply_impulse_rtn(flight.servicer, {0.0, dv, 0.0});
    }
  }

  truth::TruthSettings settings_;
  truth::TruthModel truth_;
  std::size_t target_ = 0, estimated_ = 0;
  double mean_motion_ = 0.0;
  std::vector<Flight> flights_;
};

TEST(RetreatInTruth, KeepsItsDistanceForADay) {
  const FlownMission flown = fly(kMission);
  ASSERT_TRUE(flown.complete);
  const std::string root = vbar::tests::source_path();
  const mission::Mission mission = sensors::load_mission(root + "/missions/" + kMission, {});
  const truth::TruthSettings settings = app::truth_settings(mission, root + "/data");
  std::array<Outcome, kDelays_s.size()> outcomes;
  for (std::size_t n = 0; n < kInstants; ++n) {
    const double time_s = kFrom_s + kApart_s * static_cast<double>(n);
    const auto row = std::ranges::find(flown.record.truth, time_s, &report::TruthRow::time_s);
    ASSERT_NE(row, flown.record.truth.end()) << time_s;
    Instant(settings, mission.epoch + fsw::nearest_duration(time_s), *row).fly(outcomes);
  }
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const double distance = outcomes[k].distance;
    const double dv = outcomes[k].dv;
    std::printf("after %4.0f s: %.2f m, at most %.2f mm/s\n", kDelays_s[k], distance, 1e3 * dv);
    EXPECT_GE(distance, kSettings.contact_distance) << kDelays_s[k];
    EXPECT_LE(dv, kLargestRetreat) << kDelays_s[k];
    EXPECT_GT(dv, 0.0) << kDelays_s[k];
  }
}

}  // namespace
}  // namespace vbar::test
