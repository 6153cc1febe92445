#include "tests/integration/rendezvous/ideal_loop.h"

#include <algorithm>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include "fsw/control/koenig_damico.h"
#include "fsw/control/leg.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::testing {
namespace {

using namespace fsw;
namespace mission = orbit::mission;
using control::LegAction;
using control::Plan;
using orbit::QnsElements;

constexpr std::size_t kServicer = 0;
constexpr std::size_t kTarget = 1;

template <class T>
T must(const Result<T>& result, const std::string& what) {
  if (!result.ok()) throw std::runtime_error(what + ": status " + std::to_string(static_cast<int>(result.status())));
  return result.value();
}

QnsElements mean_of(const orbit::CartesianState& state) {
  return must(orbit::mean_from_osculating(must(orbit::qns_from_cartesian(state), "elements")), "mean elements");
}

orbit::CartesianState state_of_mean(const QnsElements& mean) {
  return must(orbit::cartesian_from_qns(must(orbit::osculating_from_mean(mean), "osculating elements")), "state");
}

class Loop {
 public:
  explicit Loop(const LoopSettings& settings) : settings_(settings), noise_(settings.seed) {
    truth::TruthSettings truth_settings;
    truth_settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
    truth_settings.gravity_degree = settings.gravity_degree;
    truth_settings.gravity_order = settings.gravity_degree;
    truth_settings.tolerance = 1e-12;
    truth_settings.data_directory = vbar::tests::source_path("data");
    truth_ = std::make_unique<truth::TruthModel>(truth_settings);
    start_ = truth_settings.epoch;

    const mission::Waypoint& origin = mission::kWaypoints[settings.first];
    const QnsElements servicer =
        orbit::propagate_secular(must(orbit::mean_from_osculating(mission::kServicerOsculating), "mean elements"),
                                 origin.time_h * 3600.0 + settings.start_delay_s);
    const Vector6 roe = origin.roe() + settings.start_error_m / mission::kReferenceA;
    truth_->add_spacecraft("servicer", state_of_mean(servicer));
    truth_->add_spacecraft("target", state_of_mean(orbit::qns_from_roe(servicer, roe)));
  }

  LegResult fly_leg(std::size_t index) {
    const mission::Waypoint& waypoint = mission::kWaypoints[index];
    goal_ = {start_ + nearest_duration((waypoint.time_h - mission::kWaypoints[settings_.first].time_h) * 3600.0),
             waypoint.roe()};
    result_ = {};
    result_.waypoint = index;
    plan_ = {};
    const bool close = index >= 8;
    policy_.tolerance_m = close        ? settings_.close_tolerance_m
                          : index >= 4 ? settings_.middle_tolerance_m
                                       : settings_.far_tolerance_m;
    policy_.closed_form.eccentricity_floor_m = index >= 4 ? 0.05 : 1.0;
    const int period = close ? 1 : settings_.ticks_a_closed_form_decision;
    for (int tick = 0; truth_->time() < goal_.time; ++tick) {
      if (tick % period == 0) decide(close);
      const GpsTime next = std::min(truth_->time() + nearest_duration(settings_.tick_s), goal_.time);
      commit_until(next + nearest_duration(settings_.latency_s));
      fly_until(next);
    }
    const orbit::CartesianState servicer = truth_->state(kServicer);
    const Vector3 reached = orbit::relative_state_rtn(servicer, truth_->state(kTarget)).position_rtn;
    const Vector3 wanted =
        must(orbit::relative_state_from_mean_roe(mean_of(servicer), goal_.roe), "commanded position").position_rtn;
    result_.control_error_m = (reached - wanted).norm();
    return result_;
  }

 private:
  control::LegSituation situation() {
    control::LegSituation now;
    now.orbits = {truth_->time(), mean_of(truth_->state(kServicer)), mean_of(truth_->state(kTarget))};
    now.committed = committed_;
    now.earliest_burn = truth_->time() + nearest_duration(settings_.latency_s);
    now.waypoint = goal_;
    now.sigma_roe = settings_.navigation_sigma_m / mission::kReferenceA;
    Vector6 roe = orbit::roe_from_qns(now.orbits.servicer, now.orbits.target);
    std::normal_distribution<double> standard;
    for (int k = 0; k < 6; ++k) roe[k] += now.sigma_roe[k] * standard(noise_);
    if (settings_.navigation_sigma_m.norm() > 0.0) now.orbits.target = orbit::qns_from_roe(now.orbits.servicer, roe);
    return now;
  }

  // The closed form plans far legs, the fuel-optimal solver close ones and what the closed form leaves of far ones.
  void decide(bool close) {
    const control::LegSituation now = situation();
    if (now.earliest_burn >= goal_.time) return;
    const control::LegDecision decision = must(
        close ? control::keep_or_correct(now, plan_, policy_) : control::decide_leg(now, plan_, policy_), "decision");
    plan_ = decision.plan;
    if (decision.action == LegAction::kCorrect) ++result_.corrections;
    if (decision.action == LegAction::kReplan) ++result_.replans;
    if (decision.action != LegAction::kHandOver) return;
    ++result_.hand_overs;
    const Result<Plan> plan = fuel_optimal(now);
    if (plan.ok()) plan_ = plan.value();
  }

  Result<Plan> fuel_optimal(const control::LegSituation& now) {
    const Result<control::ControlProblem> problem =
        control::remaining_problem(now.orbits, now.committed.all(), now.earliest_burn, now.waypoint);
    if (!problem.ok()) return problem.status();
    const Result<Plan> plan = control::solve_koenig_damico(problem.value(), {}, *workspace_);
    if (!plan.ok() || plan.value().count == 0) return plan;
    return control::correct_plan(now.orbits, now.committed, plan.value(), now.waypoint);
  }

  // Burns that the next tick could not command in time any more; they count for the leg that asked for them.
  void commit_until(GpsTime time) {
    std::size_t due = 0;
    for (; due < plan_.count && plan_.burns[due].time < time; ++due) {
      committed_.burns[committed_.count++] = plan_.burns[due];
      result_.dv_mps += plan_.burns[due].dv_rtn.norm();
      ++result_.burns;
    }
    Plan rest;
    rest.solver = plan_.solver;
    for (std::size_t k = due; k < plan_.count; ++k) rest.burns[rest.count++] = plan_.burns[k];
    plan_ = rest;
  }

  // A burn at exactly `time` is left for afterwards, as at a waypoint.
  void fly_until(GpsTime time) {
    Plan later;
    for (const control::Burn& burn : committed_.all()) {
      if (burn.time >= time) {
        later.burns[later.count++] = burn;
        continue;
      }
      truth_->advance_to(burn.time);
      truth_->apply_impulse_rtn(kServicer, burn.dv_rtn);
    }
    committed_ = later;
    truth_->advance_to(time);
  }

  LoopSettings settings_;
  std::mt19937 noise_;
  std::unique_ptr<truth::TruthModel> truth_;
  std::unique_ptr<control::KoenigDamicoWorkspace> workspace_ = std::make_unique<control::KoenigDamicoWorkspace>();
  GpsTime start_;
  control::Waypoint goal_;
  control::LegPolicy policy_;
  Plan plan_;
  Plan committed_;
  LegResult result_{};
};

}  // namespace

std::vector<LegResult> fly_mission(const LoopSettings& settings) {
  Loop loop(settings);
  std::vector<LegResult> results;
  for (std::size_t index = settings.first + 1; index <= settings.last; ++index) results.push_back(loop.fly_leg(index));
  return results;
}

}  // namespace vbar::testing
