#pragma once
// The list of all control solvers. A new solver is a header and a source file beside this one, its constants and fields
// in vbar.lcm, and its place in the list below.
//
// An entry is a type with these members:
//   kId, kName                        value and word of its constant kSolver... of waypoint (vbar.lcm)
//   kStatus                           its field of telemetry_control, in which the status of its last attempt is sent
//   kDescription, kMaxEccentricity    the method, and the largest mean eccentricity up to which the rendezvous with
//   ideal
//                                     navigation stays within twice the control error and cost of the paper's orbit
//   Settings, settings(configuration, windows)   parameters of a solution, from the telecommand in force
//   Workspace                         arrays too large for the stack, owned by the caller
//   solve(problem, settings, workspace)          Result<Plan>

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fsw/control/closed_form.h"
#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// The order is that of the fallback: a solver without an acceptable plan is followed by the next one. The last one
/// always has a plan, if not the cheapest.
using SolverList = std::tuple<ClosedForm, KoenigDamico, LeastSquares>;

inline constexpr std::size_t kSolvers = std::tuple_size_v<SolverList>;

/// The last entry of the list.
using LastSolver = std::tuple_element_t<kSolvers - 1, SolverList>;

/// Calls visit.operator()<Entry>(place) for the entries in order, until one returns true. Returns whether one did.
template <class Visitor>
constexpr bool any_solver(Visitor&& visit) {
  return [&]<std::size_t... place>(std::index_sequence<place...>) {
    return (visit.template operator()<std::tuple_element_t<place, SolverList>>(place) || ...);
  }
  (std::make_index_sequence<kSolvers>{});
}

/// Returns whether `number` is the kId of an entry.
constexpr bool is_solver(int number) {
  return any_solver([&]<class Entry>(std::size_t /*place*/) { return static_cast<int>(Entry::kId) == number; });
}

/// Returns the place of a solver in the list; for kNone that of the last one.
constexpr std::size_t place_of(Solver solver) {
  std::size_t found = kSolvers - 1;
  any_solver([&]<class Entry>(std::size_t place) {
    if (Entry::kId != solver) return false;
    found = place;
    return true;
  });
  return found;
}

/// Returns whether the burns of a solver lie in the thrust windows that it is given.
constexpr bool observes_windows(Solver solver) {
  return any_solver([&]<class Entry>(std::size_t /*place*/) {
    constexpr bool kHasWindows = requires(const typename Entry::Settings& settings) {
      settings.windows;
    };
    return kHasWindows && Entry::kId == solver;
  });
}

template <class List>
struct WorkspacesOf;
template <class... Entries>
struct WorkspacesOf<std::tuple<Entries...>> {
  using Type = std::tuple<typename Entries::Workspace...>;
};
/// The workspaces of all solvers.
using SolverWorkspaces = WorkspacesOf<SolverList>::Type;

}  // namespace vbar::fsw::control
