#pragma once
// Checks that the states of a truth in another process can be those of the mission's spacecraft. An invalid unit, frame
// or convention is found by the motion: a state is compared with the position and velocity to which the point mass of
// the Earth leads the previous one.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "hil_drivers/external/exchange.h"
#include "host_sim/sensors/testbed.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::external {

/// Largest perturbation of the point mass that is accepted, m/s^2. That of the Earth's oblateness is 0.032 m/s^2 above
/// a pole at the surface, and less everywhere else; that of all other forces is far smaller.
inline constexpr double kLargestPerturbation = 0.05;

/// Returns the reason why `stated` cannot be the state `interval` after `before`, the impulses since then included;
/// empty if it can. A constant acceleration a moves a spacecraft by up to 1.5 a t^2 against an orbit without it, along
/// track; in addition 10 m and 0.01 m/s are accepted, more than the EME2000 frame (0.8 m) or single precision (0.5 m)
/// cause.
[[nodiscard]] std::string fault_of_motion(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& before,
                                          fsw::Duration interval);

/// Returns the reason why `stated` cannot be the attitude at the start, `expected` that of the mission; empty if it
/// can, or if the mission has none. A difference of a degree is accepted.
[[nodiscard]] std::string fault_of_first_attitude(const twins::SpacecraftTruth& stated,
                                                  const twins::SpacecraftTruth& expected);

/// Returns the reason why a matrix is not a rotation; empty if it is.
[[nodiscard]] std::string fault_of_rotation(const fsw::Matrix3& R_itrf_gcrf);

// True motion of a run in another process, in lock-step: for each time that the run needs, the process is sent the
// events since the last time, and simulated time waits for its states.

class ExternalTruth final : public testbeds::TestbedTruth {
 public:
  /// Connects to the program at the other end of the link, which answers batches in the place of steps.
  using Connect = std::function<std::unique_ptr<pil::FlightComputer>()>;

  ExternalTruth(testbeds::TruthPlan plan, Connect connect);
  ~ExternalTruth() override { end(); }

  /// Starts the truth and requests the states at the start, which must be those of the plan.
  void start() override;
  void stop() noexcept override { end(); }
  [[nodiscard]] std::int64_t exchanges() const override { return exchanges_; }

  void advance_to(fsw::GpsTime time) override;
  [[nodiscard]] twins::TruthSnapshot snapshot(twins::TruthDetail detail) override;
  void apply_impulse_rtn(const fsw::Vector3& dv_rtn) override;
  void point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) override;
  [[nodiscard]] double wall_s() const override { return wall_s_; }

  /// Returns the states at `time`. Beyond the present the perturbations of the point mass and angular accelerations are
  /// constant.
  [[nodiscard]] twins::TruthSnapshot at(fsw::GpsTime time) override;

 private:
  void end() noexcept;
  [[nodiscard]] fsw::Matrix3 modelled_earth_at(fsw::GpsTime time);
  void open();
  void ask_for(fsw::GpsTime time);
  [[nodiscard]] Answer exchange(const Batch& batch);
  void take(StatedTruth stated);
  void check(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& expected,
             fsw::Duration interval) const;

  testbeds::TruthPlan plan_;
  SpacecraftNumbers numbers_;
  Connect connect_;
  truth::EarthRotation earth_rotation_;
  bool is_pointed_ = false;  ///< the attitude of the servicer is commanded
  std::unique_ptr<pil::FlightComputer> program_;
  std::uint32_t step_ = 0;
  std::int64_t exchanges_ = 0;
  double wall_s_ = 0.0;
  twins::TruthSnapshot present_;                  ///< as last stated
  std::vector<twins::SpacecraftTruth> expected_;  ///< present_ with the impulses since then
  std::vector<Command> commands_;                 ///< commands since present_
};

}  // namespace vbar::external
