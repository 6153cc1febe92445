#pragma once
#include "fsw/control/plan.h"
#include "fsw/control/primer.h"
namespace vbar::fsw::control {
inline constexpr std::size_t kMaxGrid = 640;
struct KoenigDamicoSettings {
  Duration grid_step = duration_of_seconds(30);
};
struct KoenigDamicoWorkspace {
  PrimerWorkspace primer;
  std::array<Matrix63, kMaxGrid> effects;
  std::array<ThrustCost, kMaxGrid> costs;
};
Result<Plan> solve_koenig_damico(const ControlProblem& problem, const KoenigDamicoSettings& settings,
                                 KoenigDamicoWorkspace& workspace);
}
