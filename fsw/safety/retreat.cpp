#include "fsw/safety/retreat.h"

#include <array>

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/safety/linear_drift.h"

namespace vbar::fsw::safety {
namespace {

// The menu: semi-major axis afterwards, and radial and normal impulses as the change of the eccentricity and the
// inclination vector that they cause, m.
constexpr std::array kRecessions_m{0.5, 1.0, 2.0, 4.0, 6.0, -0.5, -1.0, -2.0, -4.0, -6.0};
constexpr std::array kRadial_m{0.0, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0};
constexpr std::array kNormal_m{0.0, 1.0, -1.0, 2.0, -2.0};
constexpr std::size_t kMenuSize = kRecessions_m.size() * kRadial_m.size() * kNormal_m.size();

constexpr double kDelayStep_s = 60.0;

struct Menu {
  std::array<Vector3, kMenuSize> dv_rtn;
  std::array<double, kMenuSize> squared;
  std::array<std::uint16_t, kMenuSize> order;
};

/// Returns the along-track impulse of the servicer that leaves the given a da, m.
double along_track_impulse(double n, double a_da_m, double a_da_after_m) {
  return 0.5 * n * (a_da_m - a_da_after_m);
}

/// Returns the sign of the along-track position; a target beside the servicer counts as ahead.
double side_of(const Vector6& a_roe_m) {
  return a_roe_m(1) < 0.0 ? -1.0 : 1.0;
}

/// Fills the menu with all burns and their order of size.
void fill(Menu& menu, double n, const Vector6& a_roe_m) {
  std::size_t count = 0;
  for (const double recession : kRecessions_m) {
    const double along = along_track_impulse(n, a_roe_m(0), -side_of(a_roe_m) * recession);
    for (const double radial : kRadial_m) {
      for (const double normal : kNormal_m) {
        const Vector3 dv(n * radial, along, n * normal);
        const double squared = dv.squaredNorm();
        std::size_t place = count;
        for (; place > 0 && squared < menu.squared[menu.order[place - 1]]; --place) {
          menu.order[place] = menu.order[place - 1];
        }
        menu.dv_rtn[count] = dv;
        menu.squared[count] = squared;
        menu.order[place] = static_cast<std::uint16_t>(count);
        ++count;
      }
    }
  }
}

/// Finds the minimum distance after a burn with every combination of the errors; any value below `enough` if the
/// minimum is below it.
class Judge {
 public:
  Judge(const LinearDrift& drift, const Matrix63& a_control, const Vector6& a_roe_m, const RetreatSettings& settings)
      : drift_(drift), a_control_(a_control), a_roe_m_(a_roe_m), settings_(settings) {}

  [[nodiscard]] double distance_after(const Vector3& dv_rtn, double enough) const {
    const Vector6 after = a_roe_m_ - a_control_ * dv_rtn;
    const double da = settings_.a_da_error_m;
    const double drag = settings_.differential_drag;
    const double since = settings_.unmeasured;
    const std::array<DriftError, 5> errors{
        {{}, {da, drag, since}, {-da, -drag, since}, {da, -drag, since}, {-da, drag, since}}};
    double least = drift_.min_distance(after, errors[0], enough);
    for (std::size_t k = 1; k < errors.size() && least >= enough; ++k) {
      const double distance = drift_.min_distance(after, errors[k], enough);
      if (distance < least) least = distance;
    }
    return least;
  }

 private:
  const LinearDrift& drift_;
  const Matrix63& a_control_;
  const Vector6& a_roe_m_;
  const RetreatSettings& settings_;
};

}  // namespace

Result<RetreatBurn> find_retreat(const orbit::QnsElements& servicer_mean, const Vector6& a_roe_m,
                                 const RetreatSettings& settings) {
  const Result<LinearDrift> drift = LinearDrift::make(servicer_mean, settings.horizon);
  if (!drift.ok()) return drift.status();
  if (!math::is_finite(a_roe_m.squaredNorm())) return Status::kNotFinite;
  const double n = orbit::mean_motion(servicer_mean.a);
  const double enough = settings.contact_distance + settings.margin;
  const Matrix63 a_control = servicer_mean.a * orbit::roe_control_matrix(servicer_mean);
  const Judge judge(drift.value(), a_control, a_roe_m, settings);

  RetreatBurn receding{.choice = RetreatChoice::kReceding};
  receding.dv_rtn(1) = along_track_impulse(n, a_roe_m(0), -side_of(a_roe_m) * settings.recession);
  receding.distance = judge.distance_after(receding.dv_rtn, enough);
  receding.keeps_distance = receding.distance >= enough;
  if (receding.keeps_distance) return receding;

  Menu menu;
  fill(menu, n, a_roe_m);
  for (const std::uint16_t k : menu.order) {
    const double distance = judge.distance_after(menu.dv_rtn[k], enough);
    if (distance >= enough) {
      return RetreatBurn{
          .dv_rtn = menu.dv_rtn[k], .distance = distance, .choice = RetreatChoice::kMenu, .keeps_distance = true};
    }
  }
  receding.distance = judge.distance_after(receding.dv_rtn, 0.0);
  return receding;
}

Result<DelayedRetreat> find_delayed_retreat(const orbit::QnsElements& servicer_mean, const Vector6& a_roe_m,
                                            double delay, const RetreatSettings& settings) {
  if (!math::is_finite(delay)) return Status::kNotFinite;
  if (delay < 0.0 || delay > settings.horizon) return Status::kOutOfRange;
  DelayedRetreat delayed{.burn = {},
                         .servicer_mean = orbit::propagate_secular(servicer_mean, delay),
                         .a_roe_m = orbit::roe_transition_j2(servicer_mean, delay) * a_roe_m};
  const Result<RetreatBurn> burn = find_retreat(delayed.servicer_mean, delayed.a_roe_m, settings);
  if (!burn.ok()) return burn.status();
  delayed.burn = burn.value();
  for (double t = 0.0; t < delay; t += kDelayStep_s) {
    const orbit::QnsElements servicer = orbit::propagate_secular(servicer_mean, t);
    const Vector6 roe = orbit::roe_transition_j2(servicer_mean, t) * a_roe_m / servicer.a;
    const double distance = math::sqrt(orbit::rtn_from_roe_linear(servicer, roe).head<3>().squaredNorm());
    if (distance < delayed.burn.distance) delayed.burn.distance = distance;
  }
  delayed.burn.keeps_distance =
      delayed.burn.keeps_distance && delayed.burn.distance >= settings.contact_distance + settings.margin;
  return delayed;
}

Result<DriftProbability> retreat_probability(const DelayedRetreat& retreat, const Matrix6& covariance_m2,
                                             const RetreatSettings& settings) {
  const Result<LinearDrift> drift = LinearDrift::make(retreat.servicer_mean, settings.horizon);
  if (!drift.ok()) return drift.status();
  const Matrix63 a_control = retreat.servicer_mean.a * orbit::roe_control_matrix(retreat.servicer_mean);
  return drift_probability(drift.value(), retreat.a_roe_m - a_control * retreat.burn.dv_rtn, covariance_m2,
                           settings.contact_distance);
}

}  // namespace vbar::fsw::safety
