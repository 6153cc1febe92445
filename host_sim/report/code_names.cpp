#include "host_sim/report/code_names.h"

#include <array>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>

namespace vbar::report {
namespace {

template <std::size_t size>
std::string name_in(const std::array<std::string_view, size>& names, int code) {
  if (code < 0 || static_cast<std::size_t>(code) >= size) return fmt::format("unknown ({})", code);
  return std::string(names[static_cast<std::size_t>(code)]);
}

constexpr std::array<std::string_view, 4> kModes{"idle", "approach", "station keeping", "hold"};
constexpr std::array<std::string_view, 3> kSolvers{"closed form", "Koenig-D'Amico", "least squares"};
constexpr std::array<std::string_view, 14> kStatuses{
    "ok",        "invalid argument", "not finite", "out of range",   "did not converge", "singular", "full",
    "too short", "too long",         "wrong type", "wrong checksum", "out of sequence",  "unsafe",   "not ready"};

constexpr std::array<std::string_view, 6> kObstacles{"none", "too few", "success rate", "ratio", "residual", "search"};
constexpr std::array<std::string_view, 8> kSightings{"bearing",
                                                     "wrong frame",
                                                     "blank",
                                                     "too little of it arrived",
                                                     "no stars identified",
                                                     "no target",
                                                     "target not confirmed",
                                                     "own orbit not known"};
constexpr std::array<std::string_view, 7> kPoseSightings{
    "pose", "keypoints, no pose", "no keypoints", "no target", "no light", "blinded", "invalid"};

}  // namespace

std::string mode_name(int mode) {
  return name_in(kModes, mode);
}
std::string solver_name(int solver) {
  return solver == -1 ? "none" : name_in(kSolvers, solver);
}
std::string status_name(int status) {
  return name_in(kStatuses, status);
}
std::string sighting_name(int status) {
  return name_in(kSightings, status);
}
std::string pose_sighting_name(int status) {
  return name_in(kPoseSightings, status);
}
std::string obstacle_name(int obstacle) {
  return name_in(kObstacles, obstacle);
}

}  // namespace vbar::report
