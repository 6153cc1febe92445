#pragma once
// A camera on the servicer that looks at a target among other satellites, false detections and hot pixels: true motion
// by the host's truth model, bearings straight from it. Expectations of the tracker come from here, not from its own
// equations.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fsw/vision/target_tracking/target_tracker.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/truth/truth_model.h"

namespace vbar::testing {

struct SceneBurn {
  double time_s = 0.0;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
};

struct SceneEclipse {
  double from_s = 0.0;
  double to_s = 0.0;
};

struct SceneSettings {
  std::uint64_t seed = 1;
  fsw::Vector6 target_a_roe_m{-2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0};  ///< mean
  std::vector<fsw::Vector6> decoys_a_roe_m;
  /// 1 sigma of the orbit that navigation goes by at first, and by which part of it it errs after `refined_after_s`.
  fsw::Vector6 sigma_a_roe_m{20.0, 1000.0, 200.0, 200.0, 200.0, 200.0};
  double refined = 0.05;
  double refined_after_s = 5400.0;
  double noise_arcsec = 12.0;
  double jitter_arcsec = 15.0;  ///< of pointing, each axis
  double detection_probability = 0.9;
  double false_detections = 5.0;  ///< an image
  int hot_pixels = 20;
  bool has_target = true;
  std::vector<SceneEclipse> eclipses;
  std::vector<SceneBurn> burns;
  double burn_error = 0.01;  ///< of its size, each axis, 1 sigma
  double period_s = 60.0;
};

/// An image: what the tracker is given, and what it does not know.
struct Scene {
  fsw::GpsTime time;
  fsw::orbit::CartesianState servicer;
  std::vector<fsw::target_tracking::Candidate> candidates;
  std::vector<int> source;  ///< of each candidate: 0 target, 1.. decoy, -1 false, -2 hot pixel
  std::vector<fsw::target_tracking::OwnBurn> burns;
  fsw::target_tracking::Prediction prediction;
  double detection_probability = 0.0;
  fsw::orbit::RelativeState target;

  /// Index of the target among the candidates, -1 if it is not there.
  [[nodiscard]] int target_index() const;
  [[nodiscard]] fsw::target_tracking::TrackerInput input() const;
};

class SceneMaker {
 public:
  explicit SceneMaker(const SceneSettings& settings);
  ~SceneMaker();
  SceneMaker(SceneMaker&&) noexcept;

  /// The next image, `period_s` after the last; the first is at the start.
  Scene next();

 private:
  struct Sky;
  std::unique_ptr<Sky> sky_;
};

/// How the tracker did.
struct RunResult {
  int target_seen = 0;  ///< images in which the target was among the candidates
  int confirmed = 0;
  int wrong = 0;  ///< confirmed, and not the target
  int first_confirmed = -1;
};

RunResult run_tracker(fsw::target_tracking::TargetTracker& tracker, SceneMaker& maker, int images);

}  // namespace vbar::testing
