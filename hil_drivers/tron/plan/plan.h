#pragma once
// Which images of a mission a bench can reproduce, by the face that holds the target, and how long that takes.

#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/placement/placement.h"

namespace vbar::tron {

inline constexpr std::array<std::pair<std::string_view, MountFace>, 6> kMountFaces{{{"-x", MountFace::kMinusX},
                                                                                    {"+x", MountFace::kPlusX},
                                                                                    {"-y", MountFace::kMinusY},
                                                                                    {"+y", MountFace::kPlusY},
                                                                                    {"bottom", MountFace::kBottom},
                                                                                    {"top", MountFace::kTop}}};

struct PlanFigures {
  MountFace face = MountFace::kBottom;
  int images = 0;       ///< of a lit target
  int clear = 0;        ///< with nothing hidden
  int feasible = 0;     ///< with at most PlacementSettings::max_hidden points hidden
  NoPlacement refused;  ///< of the others: reasons of all trials
  double sun_error_max_rad = 0.0;
  std::vector<double> move_s;   ///< sorted, of the feasible ones
  std::vector<double> bench_s;  ///< likewise: move, correction, settling, pose, exposure
  double wall_s = 0.0;          ///< spent on the search
};

/// All lit scenes, one after the other, from home.
[[nodiscard]] PlanFigures plan(const BenchFile& bench, const std::vector<Scene>& scenes,
                               const PlacementSettings& settings, const std::vector<fsw::Vector3>& keypoints_m,
                               double exposure_s);

/// One line a face, with a heading.
[[nodiscard]] std::string plan_table(const std::vector<PlanFigures>& faces);

/// The arms at home.
[[nodiscard]] Posture home_of(const BenchFile& bench);

}  // namespace vbar::tron
