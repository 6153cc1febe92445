// Prints errors of pose navigation for seeds 1 to N: what the tests look at.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/integration/pose_filter/close_flight.h"
#include "tests/support/figures.h"

namespace {

using namespace vbar;

double option(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atof(text) : otherwise;
}

}  // namespace

int main(int argc, char** argv) {
  const unsigned seeds = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 10;
  const test::CloseFlight flight = test::fly_closely(option("HOURS", 2.25));
  test::KeypointErrors errors;
  errors.sigma_px = option("SIGMA", errors.sigma_px);
  errors.told_px = option("TOLD", errors.sigma_px);
  errors.lasting_share = option("LASTING", 0.0);
  errors.lasting_time_s = option("LASTING_TIME", errors.lasting_time_s);
  errors.outlier_share = option("OUTLIERS", 0.0);
  errors.unseen_share = option("UNSEEN", errors.unseen_share);
  errors.flip_share = option("FLIPS", 0.0);
  errors.stretch = option("STRETCH", 0.0);
  errors.has_dark = option("DARK", 1.0) > 0.0;
  const double rate = option("RATE", 0.0);
  const bool is_loud = option("LOUD", 0.0) > 0.0;
  double all_position = 0.0;
  double all_attitude = 0.0;
  double all_roe_nees = 0.0;
  double all_attitude_nees = 0.0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const double rate_deg_s = rate > 0.0 ? rate : 0.3 + 1.2 * (seed % 7) / 6.0;
    const auto attitudes = test::tumble(flight, rate_deg_s, seed, option("TORQUE", 0.0));
    test::SimulatedNetwork network(flight, attitudes, errors, seed);
    fsw::navigation::PoseSettings settings = test::pose_settings(flight);
    auto& filter = settings.filter;
    filter.correlated_share = option("F_SHARE", filter.correlated_share);
    filter.correlation_angle = option("F_TURN", filter.correlation_angle);
    filter.stretch_sigma = option("F_STRETCH", filter.stretch_sigma);
    filter.lasting_stretch_sigma = option("F_LASTING_STRETCH", filter.lasting_stretch_sigma);
    filter.shift_sigma_px = option("F_SHIFT", filter.shift_sigma_px);
    filter.acceleration.psd_max = option("F_ACC_MOST", filter.acceleration.psd_max);
    filter.angular_acceleration.psd_min = option("F_ANG_LEAST", filter.angular_acceleration.psd_min);
    filter.angular_acceleration.psd_max = option("F_ANG_MOST", filter.angular_acceleration.psd_max);
    auto navigation = std::make_unique<fsw::navigation::PoseNavigation>();
    if (navigation->configure(settings) != fsw::Status::kOk) return 1;
    double position = 0.0, attitude = 0.0, roe_nees = 0.0, attitude_nees = 0.0, nis = 0.0, rows = 0.0;
    vbar::accuracy::Largest worst_position, worst_attitude;
    int count = 0;
    int first = -1;
    for (std::size_t k = 0; k < flight.epochs.size(); ++k) {
      const auto status = navigation->update(network.measure(k), network.known_burns());
      if (!navigation->valid()) continue;
      if (first < 0) first = static_cast<int>(k);
      const test::PoseError error = test::pose_error(flight.epochs[k], attitudes[k], *navigation);
      if (status == fsw::navigation::PoseEditStatus::kFilter) {
        nis += navigation->last_update().nis;
        rows += 2.0 * navigation->last_update().used;
      }
      if (is_loud && k % 20 == 0) {
        const fsw::Matrix6 c = navigation->covariance_rtn();
        std::printf(
            "   %5.0f s fate %d lit %d range %5.2f err %6.1f %6.1f %6.1f mm (%5.1f %5.1f %5.1f) att %6.3f deg (%6.3f) "
            "rate %7.4f deg/s nees %6.1f %6.1f used %d psd %.0e %.0e scale %.1f\n",
            5.0 * static_cast<double>(k), static_cast<int>(status), flight.epochs[k].is_target_lit,
            (flight.epochs[k].target.position_eci - flight.epochs[k].servicer.position_eci).norm(),
            1e3 * error.position_rtn(0), 1e3 * error.position_rtn(1), 1e3 * error.position_rtn(2),
            1e3 * std::sqrt(c(0, 0)), 1e3 * std::sqrt(c(1, 1)), 1e3 * std::sqrt(c(2, 2)), error.attitude * 57.3,
            navigation->filter().attitude_sigma() * 57.3, error.rate * 57.3, error.roe_nees, error.attitude_nees,
            navigation->last_update().used, navigation->filter().acceleration_psd(),
            navigation->filter().angular_acceleration_psd(), navigation->last_update().noise_scale);
      }
      if (k < 120 || status != fsw::navigation::PoseEditStatus::kFilter) continue;  // ten minutes to settle
      position += error.position_m;
      attitude += error.attitude * 57.2958;
      worst_position.add(error.position_m);
      worst_attitude.add(error.attitude * 57.2958);
      roe_nees += error.roe_nees;
      attitude_nees += error.attitude_nees;
      ++count;
    }
    const auto& c = navigation->counters();
    std::printf(
        "%3u %.2f deg/s first %d: position %5.2f cm (most %5.2f) attitude %5.2f deg (most %5.2f) nees %5.1f %5.1f "
        "nis/dof %.2f psd %.0e %.0e | images %d refused %d keypoints %d refused %d positions %d attitudes %d "
        "restarts %d\n",
        seed, rate_deg_s, first, 100 * position / count, 100 * worst_position, attitude / count, worst_attitude.value,
        roe_nees / count, attitude_nees / count, nis / rows, navigation->filter().acceleration_psd(),
        navigation->filter().angular_acceleration_psd(), c.images_used, c.images_refused, c.keypoints_used,
        c.keypoints_refused, c.positions_used, c.attitudes_reset, c.restarts);
    all_position += position / count / seeds;
    all_attitude += attitude / count / seeds;
    all_roe_nees += roe_nees / count / seeds;
    all_attitude_nees += attitude_nees / count / seeds;
  }
  std::printf("all: position %.2f cm, attitude %.3f deg, nees %.2f %.2f\n", 100 * all_position, all_attitude,
              all_roe_nees, all_attitude_nees);
}
