#pragma once
// The filter aided by keypoints on the last two legs of the rendezvous: orbits under all forces and a rigid body by the
// truth of the twin, keypoints as a network might see them.

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "fsw/math/cholesky.h"
#include "fsw/measurements/keypoints/keypoint_aiding.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/measurements/close_flight.h"

namespace vbar::fsw::measurements {

inline constexpr double kDegree = M_PI / 180.0;

inline filter::FilterSettings flight_blocks(const vbar::test::CloseFlight& flight) {
  filter::FilterSettings blocks;
  blocks.earth = flight.earth;
  blocks.relative_orbit.acceleration = {.psd = 1e-13, .psd_min = 1e-14, .psd_max = 1e-11};
  blocks.attitude.inertia = vbar::test::close_flight_camera().inertia;
  return blocks;
}

inline KeypointAidingSettings flight_settings() {
  const vbar::test::CloseFlightCamera camera = vbar::test::close_flight_camera();
  KeypointAidingSettings settings;
  settings.inertia = camera.inertia;
  return settings;
}

inline KeypointCamera flight_camera() {
  const vbar::test::CloseFlightCamera camera = vbar::test::close_flight_camera();
  return {.model = {.camera = 1, .optics = camera.optics, .shape = camera.shape},
          .position_camera_m = camera.position_camera_m};
}

struct FlightError {
  double position_m = 0.0;
  double attitude = std::nan("");  ///< rad; not a number while it is not known
  double roe_nees = 0.0;
  double attitude_nees = std::nan("");
};

class KeypointFlight {
 public:
  KeypointFlight(const vbar::test::CloseFlight& truth, const vbar::test::KeypointErrors& errors, double rate_deg_s,
                 unsigned seed, const filter::FilterSettings& blocks, const KeypointAidingSettings& settings,
                 double torque_nm = 0.0)
      : flight(truth),
        attitudes(vbar::test::tumble(flight, rate_deg_s, seed, torque_nm)),
        network(flight, attitudes, errors, seed),
        burns(network.known_burns()) {
    filter->configure(blocks);
    aiding->configure(settings);
  }

  /// Mean ROE of preceding navigation, off by `error` (m), with its 1 sigma.
  void hand_over(const Vector6& offset, const Vector6& sigma) {
    filter::TargetApriori known;
    known.kind = filter::TargetApriori::Kind::kMeanRoe;
    known.time = flight.epochs[next].time;
    known.mean_a_roe_m = vbar::test::mean_a_roe_m(flight.epochs[next].servicer, flight.epochs[next].target) + offset;
    known.sigma_a_roe_m = sigma;
    filter->set_apriori(known);
  }

  double network_scale = 1.0;  ///< of the positions of single-image poses

  KeypointEditStatus step(bool has_image = true, const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity()) {
    const vbar::test::MeasuredEpoch& measured = network.measure(next, turned);
    filter->advance_to(measured.time, burns);
    filter::AbsolutePosition position;
    position.position_eci = measured.servicer_position_eci;
    filter->update_absolute_orbit(position);
    KeypointImage image;
    image.time = measured.time;
    image.camera = camera;
    image.sun_eci = sun_eci.value_or(measured.sun_eci);
    image.R_camera_eci = measured.R_camera_eci;
    if (has_image) {
      image.keypoints = measured.keypoints;
      image.pnp = measured.pnp;
      if (image.pnp) image.pnp->pose.position_camera_m *= network_scale;
    }
    const KeypointEditStatus status = aiding->process(image, *filter);
    if (filter->has_relative()) error = error_of(turned);
    ++next;
    return status;
  }

  /// No image at all.
  void coast() {
    const vbar::test::MeasuredEpoch& measured = network.measure(next);
    filter->advance_to(measured.time, burns);
    filter::AbsolutePosition position;
    position.position_eci = measured.servicer_position_eci;
    filter->update_absolute_orbit(position);
    aiding->check_age(measured.time);
    error = error_of(Eigen::Quaterniond::Identity());
    ++next;
  }

  FlightError error_of(const Eigen::Quaterniond& turned) const {
    const vbar::test::CloseEpoch& truth = flight.epochs[next];
    FlightError result;
    const auto estimated = orbit::relative_state_rtn(filter->servicer(), filter->target().value());
    result.position_m =
        (estimated.position_rtn - orbit::relative_state_rtn(truth.servicer, truth.target).position_rtn).norm();
    const Vector6 roe_error = filter->a_roe_m() - orbit::qns_from_cartesian(truth.servicer).value().a *
                                                      orbit::roe_of_target(truth.servicer, truth.target).value();
    result.roe_nees = roe_error.dot(math::Cholesky6(filter->a_roe_covariance_m2()).solve(roe_error));
    if (!filter->has_attitude()) return result;
    const filter::AttitudeState& attitude = filter->attitude().state();
    const Eigen::AngleAxisd between(attitude.q_eci_body.conjugate() * attitudes[next].q_eci_body * turned);
    const double angle = between.angle() > M_PI ? between.angle() - 2.0 * M_PI : between.angle();
    result.attitude = std::abs(angle);
    Vector6 attitude_error;
    attitude_error << angle * between.axis(), attitudes[next].rate_body - attitude.rate_body;
    result.attitude_nees =
        attitude_error.dot(math::Cholesky6(filter::attitude_covariance(filter->estimate())).solve(attitude_error));
    return result;
  }

  double sigma_m() const { return std::sqrt(filter->position_covariance_eci().trace()); }

  const vbar::test::CloseFlight& flight;
  std::vector<filter::AttitudeState> attitudes;
  vbar::test::SimulatedNetwork network;
  std::vector<filter::Burn> burns;
  std::unique_ptr<filter::RelativeNavigationFilter> filter = std::make_unique<filter::RelativeNavigationFilter>();
  std::unique_ptr<KeypointAiding> aiding = std::make_unique<KeypointAiding>();
  KeypointCamera camera = flight_camera();
  std::size_t next = 0;
  std::optional<Vector3> sun_eci;  ///< in place of the true one
  FlightError error;
};

}  // namespace vbar::fsw::measurements
