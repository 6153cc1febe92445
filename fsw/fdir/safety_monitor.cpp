#include "fsw/fdir/safety_monitor.h"

#include <array>

#include "fsw/math/math.h"

namespace vbar::fsw::fdir {

void RangeFilter::add(GpsTime time, double range_m) {
  if (!(range_m > 0.0) || (samples_ > 0 && time <= last_)) return;
  const double gap_s = seconds(time - last_);
  const double logarithm = math::log(range_m);
  if (samples_ == 0 || gap_s > kLongestGap_s) {
    *this = RangeFilter();
    first_ = last_ = time;
    samples_ = 1;
    logarithm_ = logarithm;
    return;
  }
  // The gains are those of a filter with this memory in steady state; the first samples are averaged.
  const double steady = 2.0 * gap_s / kMemory_s;
  const double averaging = 1.0 / static_cast<double>(samples_ + 1);
  const double larger = steady > averaging ? steady : averaging;
  const double alpha = larger < 1.0 ? larger : 1.0;
  const double fading = gap_s / kMemory_s;
  const double beta = fading * fading < 1.0 ? fading * fading : 1.0;
  const double predicted = logarithm_ + rate_ * gap_s;
  const double residual = logarithm - predicted;
  logarithm_ = predicted + alpha * residual;
  rate_ += beta / gap_s * residual;
  last_ = time;
  ++samples_;
}

double RangeFilter::range_m(GpsTime time) const {
  return is_known() ? math::exp(logarithm_ + rate_ * seconds(time - last_)) : 0.0;
}

namespace {

constexpr double kLitShare = 1.0 / 12.0;  // threshold as a share of the brightness of the brightest pixels
constexpr int kBrightest = 60;            // number of pixels, larger than that of hot pixels
constexpr double kMinSigmas = 60.0;       // smallest brightness of these, in sigmas of the noise
constexpr double kThresholdSigmas = 6.0;
constexpr int kMinPixels = 300;
constexpr int kMaxRimPixels = 4;  // hot pixels
constexpr double kMinCosPhase = 0.0;
// Share of a silhouette's size that is brighter than the threshold, measured on Tango.
constexpr double kBrightShare = 0.9;
constexpr std::size_t kLevels = 4096;  // of 12 bits

/// Returns the brightness that kBrightest pixels exceed or reach.
int brightest_dn(const imaging::ImageView& image) {
  std::array<int, kLevels> histogram{};
  for (const std::uint16_t pixel : image.pixels) {
    if (pixel < kLevels) ++histogram[pixel];
  }
  int count = 0;
  for (std::size_t level = kLevels; level-- > 0;) {
    count += histogram[level];
    if (count >= kBrightest) return static_cast<int>(level);
  }
  return 0;
}

}  // namespace

LitArea lit_area(const imaging::ImageView& image, const SafetyMonitorCamera& camera) {
  const double brightness_dn = brightest_dn(image) - camera.dark_level_dn;
  LitArea area;
  if (!(brightness_dn > kMinSigmas * camera.noise_dn)) return area;
  const double share_dn = kLitShare * brightness_dn;
  const double noise_dn = kThresholdSigmas * camera.noise_dn;
  const double threshold_dn = camera.dark_level_dn + (share_dn > noise_dn ? share_dn : noise_dn);
  int on_rim = 0;
  std::size_t k = 0;
  for (int y = 0; y < image.frame.height; ++y) {
    for (int x = 0; x < image.frame.width && k < image.pixels.size(); ++x, ++k) {
      const std::uint16_t pixel = image.pixels[k];
      if (pixel == imaging::kMissingPixel || !(pixel > threshold_dn)) continue;
      ++area.pixels;
      const bool is_rim = x == 0 || y == 0 || x == image.frame.width - 1 || y == image.frame.height - 1;
      if (is_rim) ++on_rim;
    }
  }
  area.is_cut = on_rim > kMaxRimPixels;
  return area;
}

std::optional<double> range_from_size(const LitArea& area, const SafetyMonitorCamera& camera,
                                      const Illumination& illumination, double target_size_m) {
  const double cos_phase = -illumination.line_of_sight.dot(illumination.to_sun);
  if (area.is_cut || area.pixels < kMinPixels || !(cos_phase >= kMinCosPhase)) return std::nullopt;
  const double lit_size_m = kBrightShare * target_size_m * math::sqrt(0.5 * (1.0 + cos_phase));
  return camera.focal_length_px * lit_size_m / math::sqrt(static_cast<double>(area.pixels));
}

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

void SafetyMonitor::take_image(GpsTime time, const imaging::ImageView& image, const SafetyMonitorCamera& camera,
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

void SafetyMonitor::take_code_baseline(GpsTime time, double range_m, double navigation_range_m) {
  if (!seen_ || time > *seen_) see(time);
  if (range_m > kCodeComparedFrom_m) static_cast<void>(compare(time, range_m, navigation_range_m));
}

bool SafetyMonitor::compare(GpsTime time, double range_m, double navigation_range_m) {
  const bool is_near = range_m < kCompareWithin_m || navigation_range_m < kCompareWithin_m;
  if (!is_near || !(navigation_range_m > 0.0)) return false;
  const double logarithm = math::log(range_m / navigation_range_m);
  set(pending_.range, true, disagrees(time, logarithm), logarithm);
  return true;
}

bool SafetyMonitor::disagrees(GpsTime time, double logarithm) {
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

void SafetyMonitor::take_command(std::int32_t maneuver_id, const Vector3& dv_rtn) {
  commands_[next_command_] = {maneuver_id, dv_rtn};
  next_command_ = (next_command_ + 1) % kCommands;
}

void SafetyMonitor::take_report(std::int32_t maneuver_id, const Vector3& dv_rtn) {
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

void SafetyMonitor::take_sunlight(GpsTime time, bool is_sunlit) {
  if (is_sunlit) {
    in_shadow_.reset();
  } else {
    in_shadow_ = time;
  }
}

void SafetyMonitor::see(GpsTime time) {
  seen_ = time;
  lit_s_ = 0.0;
  counted_until_ = time;
}

/// Adds the time since the last count, which counts as sunlit or as shadow as a whole.
void SafetyMonitor::count_sunlight(GpsTime now) {
  const bool is_dark = in_shadow_ && math::abs(seconds(now - *in_shadow_)) <= kShadowHolds_s;
  if (!is_dark) lit_s_ += seconds(now - counted_until_);
  counted_until_ = now;
}

SafetyMonitorVerdicts SafetyMonitor::judge(GpsTime now) {
  SafetyMonitorVerdicts verdicts = pending_;
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

}  // namespace vbar::fsw::fdir
