#include "fsw/guard/guard.h"

#include "fsw/math/math.h"

namespace vbar::fsw::guard {
namespace {

constexpr int kSeenPixels = 60;  // a crescent counts as seen

// Difference of a burn that contradicts its command: more than this share of it, and more than the minimum impulse of a
// thruster.
constexpr double kLargestShare = 0.2;
constexpr double kMinImpulse = 2e-5;  // m/s

// Closing rate that is an alarm: more than the whole range in this time, and more than that of natural relative orbits
// of metres.
constexpr double kClosingTime_s = 1000.0;
constexpr double kOrbitalRate = 0.01;  // m/s
constexpr double kClosingWithin_m = 150.0;

/// Assigns member by member: a copied aggregate would bring the padding of the stack into the state.
void set(Verdict& verdict, bool is_checked, bool is_alarm, double value) {
  verdict.is_checked = is_checked;
  verdict.is_alarm = is_alarm;
  verdict.value = value;
}

}  // namespace

void Guard::take_image(GpsTime time, const imaging::ImageView& image, const GuardCamera& camera,
                       const Illumination& illumination, double navigation_range_m) {
  const LitArea area = lit_area(image, camera);
  if (area.pixels >= kSeenPixels) see(time);
  const std::optional<double> range_m = range_from_size(area, camera, illumination, settings_.target_size_m);
  if (!range_m) return;
  range_.add(time, *range_m);
  if (!compare(time, *range_m, navigation_range_m) || !range_.has_rate()) return;
  const double rate = range_.range_rate(time);
  const double range_now_m = range_.range_m(time);
  const double largest_rate = range_now_m / kClosingTime_s + kOrbitalRate;
  set(pending_.closing, range_now_m < kClosingWithin_m, rate < -largest_rate, rate);
}

void Guard::take_code_baseline(GpsTime time, double range_m, double navigation_range_m) {
  if (!seen_ || time > *seen_) see(time);
  if (range_m > kCodeComparedFrom_m) static_cast<void>(compare(time, range_m, navigation_range_m));
}

bool Guard::compare(GpsTime time, double range_m, double navigation_range_m) {
  const bool is_near = range_m < kCompareWithin_m || navigation_range_m < kCompareWithin_m;
  if (!is_near || !(navigation_range_m > 0.0)) return false;
  const double logarithm = math::log(range_m / navigation_range_m);
  set(pending_.range, true, disagrees(time, logarithm), logarithm);
  return true;
}

bool Guard::disagrees(GpsTime time, double logarithm) {
  if (!(math::abs(logarithm) > kLargestLogarithm)) {
    disagreement_.reset();
    return false;
  }
  const bool continues = disagreement_ && seconds(time - disagreement_->last) <= RangeFilter::kLongestGap_s;
  if (!continues) disagreement_ = Disagreement{.first = time, .last = time};
  disagreement_->last = time;
  if (disagreement_->count < kFewestDisagreeing) ++disagreement_->count;
  return disagreement_->count >= kFewestDisagreeing && seconds(time - disagreement_->first) >= kLongestDisagreement_s;
}

void Guard::take_command(std::int32_t maneuver_id, const Vector3& dv_rtn) {
  commands_[next_command_] = {maneuver_id, dv_rtn};
  next_command_ = (next_command_ + 1) % kCommands;
}

void Guard::take_report(std::int32_t maneuver_id, const Vector3& dv_rtn) {
  Vector3 commanded = Vector3::Zero();
  for (const Command& command : commands_) {
    if (command.id == maneuver_id) commanded = command.dv_rtn;
  }
  const double size = math::sqrt(commanded.squaredNorm());
  const double difference = math::sqrt((dv_rtn - commanded).squaredNorm());
  const bool is_alarm = difference > kLargestShare * size + kMinImpulse;
  // One contradiction among several reports in a step decides.
  if (pending_.burns.is_alarm) return;
  set(pending_.burns, true, is_alarm, size > 0.0 ? difference / size : difference);
}

void Guard::take_sunlight(GpsTime time, bool is_sunlit) {
  if (is_sunlit) {
    in_shadow_.reset();
  } else {
    in_shadow_ = time;
  }
}

void Guard::see(GpsTime time) {
  seen_ = time;
  lit_s_ = 0.0;
  counted_until_ = time;
}

/// Adds the time since the last count, which counts as sunlit or as shadow as a whole.
void Guard::count_sunlight(GpsTime now) {
  const bool is_dark = in_shadow_ && math::abs(seconds(now - *in_shadow_)) <= kShadowHolds_s;
  if (!is_dark) lit_s_ += seconds(now - counted_until_);
  counted_until_ = now;
}

GuardVerdicts Guard::judge(GpsTime now) {
  GuardVerdicts verdicts = pending_;
  for (Verdict* verdict : {&pending_.range, &pending_.burns, &pending_.closing}) set(*verdict, false, false, 0.0);
  count_sunlight(now);
  if (range_.is_known() && seen_) {
    const double age_s = seconds(now - *seen_);
    const bool is_near = range_.range_m(range_.last()) < settings_.data_timeout_range_m;
    const bool is_late = age_s > settings_.data_timeout_s && lit_s_ > kLitShare * settings_.data_timeout_s;
    verdicts.silence = {.is_checked = true, .is_alarm = is_near && is_late, .value = age_s};
  }
  return verdicts;
}

}  // namespace vbar::fsw::guard
