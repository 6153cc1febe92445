#include "fsw/safety/passive_safety.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::safety {
namespace {

using orbit::QnsElements;

constexpr int kSamplesPerRevolution = 100;
constexpr double kMaxRevolutions = 40.0;
constexpr double kMaxRoe = 0.5;  ///< beyond it the relative-motion map is not valid

bool within_model(const Vector6& roe) {
  for (int k = 0; k < 6; ++k) {
    if (!(math::abs(roe(k)) <= kMaxRoe)) return false;
  }
  return true;
}

/// Returns the position of the target in the servicer's RTN during a drift. The ROE change linearly from their values
/// at the start to those at the end: all but the slow rotation of the e-vector is linear in time.
class DriftPath {
 public:
  DriftPath(const QnsElements& servicer, const Vector6& roe, const Vector6& roe_end, double duration)
      : a_(servicer.a),
        u_(servicer.u),
        u_rate_(orbit::secular_rates(servicer).mean_argument_of_latitude()),
        roe_(roe),
        roe_rate_(duration > 0.0 ? Vector6((roe_end - roe) / duration) : Vector6(Vector6::Zero())) {}

  [[nodiscard]] Vector3 position_rtn(double t) const {
    const double cos_u = math::cos(u_ + u_rate_ * t);
    const double sin_u = math::sin(u_ + u_rate_ * t);
    const Vector6 roe = roe_ + t * roe_rate_;
    const double radius = 1.0 + roe(0) - roe(2) * cos_u - roe(3) * sin_u;
    const double along = roe(1) + 2.0 * roe(2) * sin_u - 2.0 * roe(3) * cos_u;
    const double across = roe(4) * sin_u - roe(5) * cos_u;
    const double cos_across = math::cos(across);
    return a_ * Vector3(radius * cos_across * math::cos(along) - 1.0, radius * cos_across * math::sin(along),
                        radius * math::sin(across));
  }

 private:
  double a_;
  double u_;
  double u_rate_;
  Vector6 roe_;
  Vector6 roe_rate_;
};

/// Holds squared distances, reduced by PositionBound.
struct Clearance {
  double spatial_squared;
  double radial_normal_squared;
};

double excess(double distance, double bound) {
  return distance > bound ? distance - bound : 0.0;
}

Clearance clearance(const DriftPath& path, double t, const PositionBound& bound) {
  const Vector3 r = path.position_rtn(t);
  const double radial_normal = excess(math::hypot(r.x(), r.z()), bound.radial_normal);
  const double along_track = excess(math::abs(r.y()), bound.along_track + bound.along_track_rate * t);
  return {.spatial_squared = radial_normal * radial_normal + along_track * along_track,
          .radial_normal_squared = radial_normal * radial_normal};
}

/// Finds the minimum of a function sampled at equal steps. It holds the last three samples and requests one more where
/// they are convex.
class Minimum {
 public:
  explicit Minimum(double step) : step_(step) {}

  /// Adds the sample at `t`. Returns true if a minimum was passed; `vertex()` is then its estimated time.
  bool add(double t, double squared) {
    note(t, squared);
    before_ = previous_;
    previous_ = last_;
    last_ = squared;
    ++count_;
    const double curvature = before_ - 2.0 * previous_ + last_;
    if (count_ < 3 || previous_ > before_ || previous_ > last_ || !(curvature > 0.0)) return false;
    vertex_ = t - step_ + 0.5 * step_ * (before_ - last_) / curvature;
    return true;
  }

  void note(double t, double squared) {
    if (noted_ && squared >= min_squared_) return;
    noted_ = true;
    min_squared_ = squared;
    time_ = t;
  }

  [[nodiscard]] double vertex() const { return vertex_; }
  [[nodiscard]] Closest closest() const { return {.distance = math::sqrt(min_squared_), .time = time_}; }

 private:
  double step_;
  double before_ = 0.0;
  double previous_ = 0.0;
  double last_ = 0.0;
  double vertex_ = 0.0;
  double min_squared_ = 0.0;
  double time_ = 0.0;
  int count_ = 0;
  bool noted_ = false;
};

DriftSafety watch(const DriftPath& path, double duration, int samples, const PositionBound& bound) {
  const double step = samples > 0 ? duration / samples : 0.0;
  Minimum spatial(step);
  Minimum radial_normal(step);
  for (int k = 0; k <= samples; ++k) {
    const double t = k * step;
    const Clearance c = clearance(path, t, bound);
    if (spatial.add(t, c.spatial_squared)) {
      spatial.note(spatial.vertex(), clearance(path, spatial.vertex(), bound).spatial_squared);
    }
    if (radial_normal.add(t, c.radial_normal_squared)) {
      radial_normal.note(radial_normal.vertex(), clearance(path, radial_normal.vertex(), bound).radial_normal_squared);
    }
  }
  return {.spatial = spatial.closest(), .radial_normal = radial_normal.closest()};
}

/// Describes the situation after some burns of a plan.
struct Prefix {
  QnsElements servicer;
  QnsElements target;
  GpsTime time;
  PositionBound bound;
  Matrix6 covariance_m2 = Matrix6::Zero();  ///< covariance of the mean ROE times a

  /// Drifts to the burn and executes it, as the control matrix states its effect in terms of ROE.
  void execute(const control::Burn& burn, const BurnUncertainty& uncertainty) {
    const double dt = seconds(burn.time - time);
    const Matrix6 transition = orbit::roe_transition_j2(servicer, dt);
    servicer = orbit::propagate_secular(servicer, dt);
    target = orbit::propagate_secular(target, dt);
    time = burn.time;
    const Matrix63 control = orbit::roe_control_matrix(servicer);
    servicer = orbit::qns_from_roe(servicer, control * burn.dv_rtn);

    const double sigma = uncertainty.sigma_mps + uncertainty.sigma_relative * math::sqrt(burn.dv_rtn.squaredNorm());
    const Matrix63 a_control = servicer.a * control;
    covariance_m2 =
        transition * covariance_m2 * transition.transpose() + sigma * sigma * a_control * a_control.transpose();
    // The bounds are three sigma, as those of the caller. An impulse v moves the orbit by at most 2 v / n, and its
    // drift along track by 3 v.
    const double bound_mps = 3.0 * sigma;
    bound.along_track += bound.along_track_rate * dt;
    bound.along_track_rate = math::hypot(bound.along_track_rate, 3.0 * bound_mps);
    bound.radial_normal = math::hypot(bound.radial_normal, 2.0 * bound_mps / orbit::mean_motion(servicer.a));
  }
};

struct RetreatOutlook {
  bool is_possible = false;
  double distance = 0.0;
  double probability = 0.0;
};

/// Assesses the retreat after a prefix. Its errors grow with the uncertainty of the prefix.
Result<RetreatOutlook> assess_retreat(const Prefix& prefix, const RetreatCriterion& criterion) {
  RetreatSettings settings = criterion.settings;
  const double a_da_bound_m = 3.0 * math::sqrt(prefix.covariance_m2(0, 0));
  if (a_da_bound_m > settings.a_da_error_m) settings.a_da_error_m = a_da_bound_m;
  const Vector6 a_roe_m = prefix.servicer.a * orbit::roe_from_qns(prefix.servicer, prefix.target);
  const Result<DelayedRetreat> retreat = find_delayed_retreat(prefix.servicer, a_roe_m, criterion.delay, settings);
  if (!retreat.ok()) return retreat.status();
  const Matrix6 transition = orbit::roe_transition_j2(prefix.servicer, criterion.delay);
  const Matrix6 covariance_m2 = transition * prefix.covariance_m2 * transition.transpose();
  const Result<DriftProbability> probability = retreat_probability(retreat.value(), covariance_m2, settings);
  if (!probability.ok()) return probability.status();
  return RetreatOutlook{.is_possible = retreat.value().burn.keeps_distance &&
                                       probability.value().spatial <= criterion.maximum_collision_probability,
                        .distance = retreat.value().burn.distance,
                        .probability = probability.value().spatial};
}

}  // namespace

double eccentricity_inclination_separation(const Vector6& roe, double a) {
  const double dex = roe(2), dey = roe(3), dix = roe(4), diy = roe(5);
  const double squares = dex * dex + dey * dey + dix * dix + diy * diy;
  const double sum = math::hypot(dex + dix, dey + diy);
  const double difference = math::hypot(dex - dix, dey - diy);
  const double denominator = squares + sum * difference;
  if (denominator == 0.0) return 0.0;
  return math::sqrt(2.0 / denominator) * a * math::abs(dex * dix + dey * diy);
}

Result<DriftSafety> assess_drift(const QnsElements& servicer_mean, const Vector6& mean_roe, double horizon,
                                 const PositionBound& bound) {
  const double elements =
      servicer_mean.a + servicer_mean.ex + servicer_mean.ey + servicer_mean.i + servicer_mean.raan + servicer_mean.u;
  const double bounds = bound.radial_normal + bound.along_track + bound.along_track_rate;
  if (!math::is_finite(elements + bounds + horizon) || !math::is_finite(mean_roe.squaredNorm()))
    return Status::kNotFinite;
  const double e_squared = servicer_mean.ex * servicer_mean.ex + servicer_mean.ey * servicer_mean.ey;
  if (servicer_mean.a <= 0.0 || e_squared >= 1.0 || horizon < 0.0 || !within_model(mean_roe))
    return Status::kOutOfRange;
  const double revolutions = horizon * orbit::mean_motion(servicer_mean.a) / math::kTwoPi;
  if (revolutions > kMaxRevolutions) return Status::kOutOfRange;

  const QnsElements target = orbit::qns_from_roe(servicer_mean, mean_roe);
  if (target.ex * target.ex + target.ey * target.ey >= 1.0) return Status::kOutOfRange;
  const Vector6 roe_end =
      orbit::roe_from_qns(orbit::propagate_secular(servicer_mean, horizon), orbit::propagate_secular(target, horizon));
  if (!within_model(roe_end)) return Status::kOutOfRange;
  const int samples = static_cast<int>(revolutions * kSamplesPerRevolution) + (horizon > 0.0 ? 2 : 0);
  return watch(DriftPath(servicer_mean, mean_roe, roe_end, horizon), horizon, samples, bound);
}

namespace {

/// Returns whether the present drift keeps the distance until the first burn, or until a retreat in its place. Holding
/// flies this drift too: if it is unsafe later, that does not exclude a plan whose burns leave it before.
Result<bool> keeps_distance_until(double until_burn_s, const Prefix& now, const SafetyCriterion& criterion) {
  const double watched = until_burn_s + (criterion.retreat ? criterion.retreat->delay : 0.0);
  const Result<DriftSafety> drift =
      assess_drift(now.servicer, orbit::roe_from_qns(now.servicer, now.target), watched, now.bound);
  if (!drift.ok()) return drift.status();
  return drift.value().spatial.distance >= criterion.keep_out_radius;
}

}  // namespace

Result<PlanSafety> assess_plan(GpsTime start, const QnsElements& servicer_mean, const Vector6& mean_roe,
                               const control::Plan& plan, const SafetyCriterion& criterion) {
  if (plan.count > control::kMaxBurns) return Status::kInvalidArgument;
  Prefix now{.servicer = servicer_mean,
             .target = orbit::qns_from_roe(servicer_mean, mean_roe),
             .time = start,
             .bound = criterion.bound};
  if (criterion.retreat) now.covariance_m2 = criterion.retreat->covariance_m2;
  PlanSafety worst;
  bool keeps_distance = true;
  for (std::size_t prefix = 0; prefix <= plan.count; ++prefix) {
    const bool more = prefix < plan.count;
    const double until_next = more ? seconds(plan.burns[prefix].time - now.time) : 0.0;
    if (until_next < 0.0) return Status::kInvalidArgument;
    const double watched = until_next > criterion.horizon ? until_next : criterion.horizon;
    const Result<DriftSafety> drift =
        assess_drift(now.servicer, orbit::roe_from_qns(now.servicer, now.target), watched, now.bound);
    if (!drift.ok()) return drift.status();
    const DriftSafety& d = drift.value();
    if (!(d.spatial.distance >= criterion.keep_out_radius)) {
      const Result<bool> is_left = prefix == 0 && more ? keeps_distance_until(until_next, now, criterion) : false;
      if (!is_left.ok()) return is_left.status();
      keeps_distance = keeps_distance && is_left.value();
    }
    if (prefix == 0 || d.spatial.distance < worst.min_distance) {
      worst.min_distance = d.spatial.distance;
      worst.time = seconds(now.time - start) + d.spatial.time;
      worst.prefix = prefix;
    }
    if (prefix == 0 || d.radial_normal.distance < worst.min_rn_distance) {
      worst.min_rn_distance = d.radial_normal.distance;
    }
    if (criterion.retreat) {
      const Result<RetreatOutlook> outlook = assess_retreat(now, *criterion.retreat);
      if (!outlook.ok()) return outlook.status();
      worst.allows_retreat = worst.allows_retreat && outlook.value().is_possible;
      if (prefix == 0 || outlook.value().distance < worst.retreat_distance) {
        worst.retreat_distance = outlook.value().distance;
      }
      if (outlook.value().probability > worst.collision_probability) {
        worst.collision_probability = outlook.value().probability;
      }
      if (!worst.allows_retreat) break;
    }
    if (!more) break;
    now.execute(plan.burns[prefix], criterion.burns);
  }
  worst.safe = keeps_distance && worst.allows_retreat;
  return worst;
}

}  // namespace vbar::fsw::safety
