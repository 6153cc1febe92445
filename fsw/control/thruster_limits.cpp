#include "fsw/control/thruster_limits.h"

#include "fsw/math/math.h"
#include "fsw/orbit/finite_burn.h"

namespace vbar::fsw::control {
namespace {

constexpr int kMaxRevolutions = 30;  // earlier or later

// A burn that is reduced to the maximum is below it, rounding included.
constexpr double kBelowMaximum = 1.0 - 1e-9;

Duration half(Duration duration) {
  return {duration.ns / 2};
}

/// Returns the least time between the middles of two burns.
Duration spacing(const ThrusterLimits& limits, const Vector3& dv, const Vector3& other) {
  return half(limits.duration_of(dv)) + half(limits.duration_of(other)) + limits.pause;
}

bool are_apart(const ThrusterLimits& limits, const Burn& burn, const Burn& other) {
  const Duration between = burn.time < other.time ? other.time - burn.time : burn.time - other.time;
  return between >= spacing(limits, burn.dv_rtn, other.dv_rtn);
}

/// Returns the latest time at which a burn is over, and its report due, at the arrival, or the earliest possible one.
GpsTime latest_time(const ThrusterLimits& limits, const BurnSpan& span, const Vector3& dv) {
  const GpsTime latest = span.arrival - half(limits.duration_of(dv)) - limits.pause;
  return latest < span.earliest ? span.earliest : latest;
}

/// Returns one burn in place of two: their sum, at their common centre.
Burn united(const Burn& first, const Burn& second) {
  const double sum = first.dv_rtn.norm() + second.dv_rtn.norm();
  const double share = sum > 0.0 ? second.dv_rtn.norm() / sum : 0.5;
  const Duration shift = nearest_duration(share * seconds(second.time - first.time));
  return {first.time + shift, first.dv_rtn + second.dv_rtn};
}

/// Returns the plan with neighbours united until all are apart. Each round unites two burns.
Plan with_burns_apart(const Plan& plan, const ThrusterLimits& limits) {
  Plan apart;
  apart.solver = plan.solver;
  for (const Burn& next : plan.all()) {
    Burn burn = next;
    while (apart.count > 0 && !are_apart(limits, apart.burns[apart.count - 1], burn)) {
      burn = united(apart.burns[--apart.count], burn);
    }
    apart.burns[apart.count++] = burn;
  }
  return apart;
}

bool has_room(const Plan& plan, std::size_t except, const ThrusterLimits& limits, const Burn& part) {
  for (std::size_t k = 0; k < plan.count; ++k) {
    if (k != except && !are_apart(limits, plan.burns[k], part)) return false;
  }
  return true;
}

void insert(Plan& plan, const Burn& burn) {
  std::size_t place = plan.count++;
  for (; place > 0 && burn.time < plan.burns[place - 1].time; --place) plan.burns[place] = plan.burns[place - 1];
  plan.burns[place] = burn;
}

/// Returns the number of revolutions to the k-th place of a part: 0, 1, -1, 2, -2 ...
int revolutions_to(int k) {
  return k % 2 == 0 ? -k / 2 : (k + 1) / 2;
}

/// Divides burn `k` of `plan`; its parts are added to `parts`. They keep apart from the other burns of both.
void divide(const Plan& plan, std::size_t k, const ThrusterLimits& limits, const BurnSpan& span, Plan& parts) {
  const Burn& burn = plan.burns[k];
  const double size = burn.dv_rtn.norm();
  const double most = (1.0 - kCorrectionMargin) * limits.maximum_dv;
  const double wanted = math::floor(size / most) + 1.0;
  const Vector3 largest = most / size * burn.dv_rtn;
  std::array<GpsTime, kMaxBurns> times;
  std::size_t count = 0;
  for (int place = 0; place <= 2 * kMaxRevolutions && parts.count + count < kMaxBurns; ++place) {
    if (static_cast<double>(count) >= wanted) break;
    const Burn part{burn.time + Duration{revolutions_to(place) * span.revolution.ns}, largest};
    if (part.time < span.earliest || part.time > latest_time(limits, span, largest)) continue;
    if (place > 0 && !(has_room(plan, k, limits, part) && has_room(parts, kMaxBurns, limits, part))) continue;
    times[count++] = part.time;
  }
  if (count == 0) return;
  const Vector3 share = static_cast<double>(count) < wanted ? largest : Vector3(burn.dv_rtn / wanted);
  for (std::size_t part = 0; part < count; ++part) insert(parts, {times[part], share});
}

}  // namespace

Duration ThrusterLimits::duration_of(const Vector3& dv) const {
  return orbit::burn_duration(dv.norm(), acceleration);
}

GpsTime ThrusterLimits::end_of(const Burn& burn) const {
  const Duration duration = duration_of(burn.dv_rtn);
  return burn.time - half(duration) + duration;
}

Duration ThrusterLimits::half_of_longest() const {
  return half(orbit::burn_duration(maximum_dv, acceleration));
}

GpsTime ThrusterLimits::after(const Burn& last) const {
  if (are_impulses()) return last.time + Duration{1};
  return end_of(last) + pause + half_of_longest();
}

bool can_fly(const Plan& plan, const ThrusterLimits& limits, const BurnSpan& span) {
  if (limits.are_impulses()) return true;
  for (std::size_t k = 0; k < plan.count; ++k) {
    const Burn& burn = plan.burns[k];
    if (burn.dv_rtn.norm() > limits.maximum_dv || burn.time > latest_time(limits, span, burn.dv_rtn)) return false;
    if (k > 0 && !are_apart(limits, plan.burns[k - 1], burn)) return false;
  }
  return true;
}

Plan divided(const Plan& plan, const ThrusterLimits& limits, const BurnSpan& span) {
  if (limits.are_impulses()) return plan;
  Plan whole = plan;
  for (std::size_t k = 0; k < whole.count; ++k) {
    Burn& burn = whole.burns[k];
    const Vector3 first_part = limits.maximum_dv < burn.dv_rtn.norm()
                                   ? Vector3(limits.maximum_dv / burn.dv_rtn.norm() * burn.dv_rtn)
                                   : burn.dv_rtn;
    const GpsTime latest = latest_time(limits, span, first_part);
    if (burn.time > latest) burn.time = latest;
  }
  whole = with_burns_apart(whole, limits);
  Plan parts;
  parts.solver = plan.solver;
  for (const Burn& burn : whole.all()) {
    if (burn.dv_rtn.norm() <= limits.maximum_dv) insert(parts, burn);
  }
  for (std::size_t k = 0; k < whole.count; ++k) {
    if (whole.burns[k].dv_rtn.norm() > limits.maximum_dv) divide(whole, k, limits, span, parts);
  }
  return with_burns_apart(parts, limits);
}

Plan limited(const Plan& plan, const ThrusterLimits& limits) {
  Plan small = plan;
  if (limits.are_impulses()) return small;
  for (std::size_t k = 0; k < small.count; ++k) {
    Vector3& dv = small.burns[k].dv_rtn;
    const double size = dv.norm();
    if (size > limits.maximum_dv) dv *= kBelowMaximum * limits.maximum_dv / size;
  }
  return small;
}

Plan without_small_burns(const Plan& plan, const ThrusterLimits& limits) {
  Plan large;
  large.solver = plan.solver;
  for (const Burn& burn : plan.all()) {
    if (burn.dv_rtn.norm() >= limits.minimum_dv) large.burns[large.count++] = burn;
  }
  return large;
}

Plan remaining(const Plan& plan, const ThrusterLimits& limits, GpsTime now) {
  Plan ahead;
  ahead.solver = plan.solver;
  for (const Burn& burn : plan.all()) {
    const Duration duration = limits.duration_of(burn.dv_rtn);
    const GpsTime begin = burn.time - half(duration);
    const GpsTime end = begin + duration;
    if (duration.ns == 0 ? burn.time < now : end <= now) continue;
    Burn& rest = ahead.burns[ahead.count++];
    rest = burn;
    if (begin >= now || duration.ns == 0) continue;
    rest.time = now + half(end - now);
    rest.dv_rtn *= seconds(end - now) / seconds(duration);
  }
  return ahead;
}

}  // namespace vbar::fsw::control
