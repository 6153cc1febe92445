#pragma once
// The truth model of a mission, its spacecraft in place, as the world of a run.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/truth_model.h"
#include "host_sim/twins/true_world.h"

namespace vbar::app {

class FlownTruth final : public twins::TrueWorld, public twins::TruthOutlook {
 public:
  /// Starts at the mission's start; `servicer` is the spacecraft that flies. Throws what truth, orbits and attitudes
  /// throw.
  FlownTruth(const mission::Mission& mission, const mission::Spacecraft& servicer,
             const std::filesystem::path& data_directory);

  void advance_to(fsw::GpsTime time) override { truth_.advance_to(time); }
  [[nodiscard]] twins::TruthSnapshot snapshot(twins::TruthDetail detail) override;
  void apply_impulse_rtn(const fsw::Vector3& dv_rtn) override { truth_.apply_impulse_rtn(servicer_, dv_rtn); }
  void point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) override;
  [[nodiscard]] double wall_s() const override { return truth_.statistics().wall_s; }

  /// Returns the truth within the last integration step; where that ends before `time`, perturbations are constant from
  /// there on (a micrometre in a second), and an attitude continues with its angular acceleration.
  [[nodiscard]] twins::TruthSnapshot at(fsw::GpsTime time) override;

  [[nodiscard]] const truth::TruthModel& model() const { return truth_; }

 private:
  [[nodiscard]] double mission_seconds(fsw::GpsTime time) const { return fsw::seconds(time - epoch_); }
  void add_accelerations(std::size_t index, twins::SpacecraftTruth& one) const;

  fsw::GpsTime epoch_;
  truth::TruthModel truth_;
  truth::EarthRotation earth_rotation_;
  std::size_t servicer_ = 0;
  bool is_pointed_ = false;  ///< the servicer's attitude is commanded
  std::vector<std::string> names_;
  std::vector<std::size_t> indices_;  ///< index in the truth of each name
};

}  // namespace vbar::app
