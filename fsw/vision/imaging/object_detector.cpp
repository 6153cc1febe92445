#include "fsw/vision/imaging/object_detector.h"

#include <algorithm>

#include "fsw/math/math.h"
#include "fsw/vision/imaging/centroid.h"

namespace vbar::fsw::imaging {
namespace {

/// The image of a point extends to at most this multiple of its own width, with smear; wider components are measured
/// as a whole, unless they are several points.
constexpr double kWidestPoint = 2.0;
/// Smallest multiple of a point's width at which an object may be several points, if it has no more pixels than these
/// would have: a resolved spacecraft has bright spots too.
constexpr double kWiderThanPoint = 1.3;
constexpr int kMaxBlendedPixels = 250;
/// Around a bright object noise raises parts of its halo above the threshold: within this number of pixels, and fainter
/// by this factor.
constexpr int kFragmentMargin = 3;
constexpr std::int64_t kFragmentFlux = 100;

bool is_within(double value, double minimum, double maximum) {
  return value >= minimum && value <= maximum;  // false for a NaN
}

bool is_usable(const DetectorSettings& s) {
  return is_within(s.detection_sigmas, 1.0, 30.0) && is_within(s.gain_dn_per_electron, 1e-6, 1e6) &&
         is_within(s.point_spread_sigma_px, 0.3, 3.0) && s.largest_object_px >= 1;
}

/// Brightest first; of equally bright ones, from the top and from the left.
bool is_first(const DetectedObject& a, const DetectedObject& b) {
  if (a.flux_dn != b.flux_dn) return a.flux_dn > b.flux_dn;
  if (a.centroid_px.y() != b.centroid_px.y()) return a.centroid_px.y() < b.centroid_px.y();
  return a.centroid_px.x() < b.centroid_px.x();
}

}  // namespace

DetectionReport ObjectDetector::detect(const ImageView& image, const DetectorSettings& settings) {
  object_count_ = 0;
  DetectionReport report;
  if (!is_usable(settings)) return report;
  report.condition = background_.measure(image, settings.saturation_dn);
  if (report.condition != ImageCondition::kGood) return report;
  image_ = image;
  settings_ = settings;
  find_components();
  const std::span<const Component> kept = components_.kept();
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (is_fragment(k)) {
      ++report.fragments;
    } else {
      measure(kept[k]);
    }
  }
  std::sort(objects_.begin(), objects_.begin() + static_cast<std::ptrdiff_t>(object_count_), is_first);
  image_ = {};  // the caller may release its pixels
  rows_ = {};
  report.background_dn = background_.typical_level_dn();
  report.noise_dn = background_.typical_noise_dn();
  report.components = components_.found();
  report.objects = static_cast<int>(object_count_);
  report.extended = components_.extended();
  report.pixels_rejected = components_.extended_pixels();
  report.runs_dropped = runs_dropped_;
  return report;
}

void ObjectDetector::find_components() {
  components_.clear(settings_.largest_object_px);
  runs_dropped_ = 0;
  // The noise of nine pixels is three times that of one.
  noises_q4_ = static_cast<int>(settings_.detection_sigmas * 3.0 * 16.0);
  for (int y = 1; y + 1 < image_.frame.height; ++y) {
    rows_ = {image_row(y - 1), image_row(y), image_row(y + 1)};
    is_patched_ = false;
    Background::RowNodes nodes;
    background_.threshold_row(y, noises_q4_, nodes);
    background_.fill(nodes, threshold_dn_);
    if (!scan_row()) {
      patch_rows(y);
      static_cast<void>(scan_row());
    }
    if (run_count_ > 0) background_.level_row(y, level_);
    for (std::size_t k = 0; k < run_count_; ++k) add_run(y, runs_[k]);
    components_.end_row(y);
  }
  components_.finish();
}

/// Runs of pixels whose 3 x 3 sum exceeds the threshold. False if a sum exceeds that of any nine pixels: a missing
/// pixel is among them, and the rows must be patched. Images without gaps therefore need no search for gaps.
bool ObjectDetector::scan_row() {
  const int last = image_.frame.width - 1;
  const std::uint16_t* above = rows_[0];
  const std::uint16_t* here = rows_[1];
  const std::uint16_t* below = rows_[2];
  run_count_ = 0;
  if (last < 2) return true;
  const auto column = [&](int x) { return int{above[x]} + here[x] + below[x]; };
  int left = column(0);
  int middle = column(1);
  int begin = -1;
  for (int x = 1; x < last; ++x) {
    const int right = column(x + 1);
    const int sum = left + middle + right;
    left = middle;
    middle = right;
    if (sum > threshold_dn_[static_cast<std::size_t>(x)]) {
      if (sum >= kMissingPixel && !is_patched_) return false;
      if (begin < 0) begin = x;
    } else if (begin >= 0) {
      push_run(begin, x);
      begin = -1;
    }
  }
  if (begin >= 0) push_run(begin, last);
  return true;
}

void ObjectDetector::push_run(int begin, int end) {
  if (run_count_ == runs_.size()) {
    ++runs_dropped_;
    return;
  }
  runs_[run_count_++] = {static_cast<std::int16_t>(begin), static_cast<std::int16_t>(end)};
}

/// Copies of the three rows with the background in place of missing pixels.
void ObjectDetector::patch_rows(int y) {
  for (std::size_t k = 0; k < 3; ++k) {
    Background::RowNodes nodes;
    background_.level_row(y - 1 + static_cast<int>(k), nodes);
    for (int x = 0; x < image_.frame.width; ++x) {
      const std::uint16_t pixel = rows_[k][x];
      patched_[k][static_cast<std::size_t>(x)] =
          pixel == kMissingPixel ? static_cast<std::uint16_t>((background_.at(nodes, x) + 128) / 256) : pixel;
    }
    rows_[k] = patched_[k].data();
  }
  is_patched_ = true;
}

void ObjectDetector::add_run(int y, const Run& run) {
  Component* component = components_.add_run(y, run.begin, run.end);
  if (component == nullptr) return;
  const ImageFrame& f = image_.frame;
  // The sums of these pixels include the outermost ones.
  const bool is_at_edge = run.begin == 1 || run.end == f.width - 1 || y == 1 || y == f.height - 2;
  if (is_at_edge || (is_patched_ && touches_missing(y, run))) component->is_cut = true;
  if (components_.is_extended(*component)) {
    component->pixels += run.end - run.begin;  // the other members are not needed
  } else {
    add_pixels(*component, y, run);
  }
}

void ObjectDetector::add_pixels(Component& component, int y, const Run& run) {
  std::int64_t flux = 0;
  std::int64_t flux_x = 0;
  std::int64_t flux_xx = 0;
  for (std::int64_t x = run.begin; x < run.end; ++x) {
    const int column = static_cast<int>(x);
    const int pixel = rows_[1][x];
    const int light = 16 * pixel - background_.at(level_, column) / 16;
    flux += light;
    flux_x += light * x;
    flux_xx += light * x * x;
    component.x += x;
    component.xx += x * x;
    component.peak_dn = std::max(component.peak_dn, pixel);
    const int sum = sum_around(column);
    if (sum > component.peak_sum) {
      component.peak_sum = sum;
      component.peak_x = column;
      component.peak_y = y;
    }
  }
  const std::int64_t pixels = run.end - run.begin;
  component.pixels += static_cast<int>(pixels);
  component.is_saturated = component.is_saturated || component.peak_dn >= settings_.saturation_dn;
  component.y += pixels * y;
  component.yy += pixels * y * y;
  component.flux += flux;
  component.flux_x += flux_x;
  component.flux_xx += flux_xx;
  component.flux_y += flux * y;
  component.flux_xy += flux_x * y;
  component.flux_yy += flux * y * y;
}

int ObjectDetector::sum_around(int x) const {
  int sum = 0;
  for (const std::uint16_t* row : rows_) sum += int{row[x - 1]} + row[x] + row[x + 1];
  return sum;
}

bool ObjectDetector::touches_missing(int y, const Run& run) const {
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int x = run.begin - 1; x <= run.end; ++x) {
      if (image_row(row)[x] == kMissingPixel) return true;
    }
  }
  return false;
}

/// Returns true if a component kept lies in or beside the box of a much brighter one.
bool ObjectDetector::is_fragment(std::size_t k) const {
  const std::span<const Component> kept = components_.kept();
  const Component& c = kept[k];
  for (std::size_t j = 0; j < k && kept[j].flux > kFragmentFlux * c.flux; ++j) {
    const Component& bright = kept[j];
    if (c.peak_x >= bright.x_min - kFragmentMargin && c.peak_x <= bright.x_max + kFragmentMargin &&
        c.peak_y >= bright.y_min - kFragmentMargin && c.peak_y <= bright.y_max + kFragmentMargin) {
      return true;
    }
  }
  return false;
}

void ObjectDetector::measure(const Component& component) {
  const double radius = component_radius(component);
  const double point = math::sqrt(settings_.point_spread_sigma_px * settings_.point_spread_sigma_px + 1.0 / 12.0);
  const bool is_small = !component.is_saturated && component.pixels <= kMaxBlendedPixels;
  Blend blend;
  if (is_small && radius > kWiderThanPoint * point) {
    blend = separate(image_, background_, component, settings_.gain_dn_per_electron, settings_.detection_sigmas);
  }
  if (blend.count < 2) {
    blend.count = 1;
    blend.peaks[0] = {component.peak_x, component.peak_y, 1};
    if (component.is_saturated || radius > kWidestPoint * point) return measure_whole(component);
  }
  if (!measure_points(component, blend)) measure_whole(component);
}

void ObjectDetector::measure_whole(const Component& component) {
  add_object(component, component_centroid(background_, component, settings_.gain_dn_per_electron),
             component_radius(component));
}

/// Each peak as a point with its share of the component's light and pixels. False if none of them is a point.
bool ObjectDetector::measure_points(const Component& component, const Blend& blend) {
  std::int64_t all = 0;
  for (std::size_t k = 0; k < blend.count; ++k) all += blend.peaks[k].sum_dn;
  const std::size_t before = object_count_;
  for (std::size_t k = 0; k < blend.count; ++k) {
    const Blend::Peak& peak = blend.peaks[k];
    Component part = component;
    part.peak_x = peak.x;
    part.peak_y = peak.y;
    if (blend.count > 1) {
      part.flux = component.flux * peak.sum_dn / all;
      part.pixels = std::max(1, static_cast<int>(std::int64_t{component.pixels} * peak.sum_dn / all));
      part.peak_dn = brightest_around(peak.x, peak.y);
    }
    const Centroid centroid =
        windowed_centroid(image_, background_, part, settings_.point_spread_sigma_px, settings_.gain_dn_per_electron);
    if (centroid.is_found)
      add_object(part, centroid, blend.count > 1 ? centroid.radius_px : component_radius(component));
  }
  return object_count_ > before;
}

int ObjectDetector::brightest_around(int x, int y) const {
  int maximum = 0;
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int column = x - 1; column <= x + 1; ++column) {
      const int pixel = image_row(row)[column];
      if (pixel != kMissingPixel) maximum = std::max(maximum, pixel);
    }
  }
  return maximum;
}

void ObjectDetector::add_object(const Component& component, const Centroid& centroid, double radius_px) {
  if (object_count_ == objects_.size()) return;
  DetectedObject& object = objects_[object_count_++];
  object.centroid_px = {image_.frame.origin_x + centroid.x, image_.frame.origin_y + centroid.y};
  object.sigma_px = centroid.sigma_px;
  object.flux_dn = static_cast<double>(component.flux) / 16.0;
  object.peak_dn = component.peak_dn;
  const double peak_dn = component.peak_dn - background_.level_dn(component.peak_x, component.peak_y);
  object.sharpness = object.flux_dn > 0.0 ? std::min(peak_dn / object.flux_dn, 1.0) : 1.0;
  object.pixels = component.pixels;
  object.radius_px = radius_px;
  object.is_saturated = component.is_saturated;
  object.is_cut = component.is_cut || centroid.is_cut;
}

}  // namespace vbar::fsw::imaging
