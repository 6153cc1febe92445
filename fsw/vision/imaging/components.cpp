#include "fsw/vision/imaging/components.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {

namespace {

void add(Component& sum, const Component& other) {
  sum.pixels += other.pixels;
  sum.x_min = std::min(sum.x_min, other.x_min);
  sum.x_max = std::max(sum.x_max, other.x_max);
  sum.y_min = std::min(sum.y_min, other.y_min);
  sum.y_max = std::max(sum.y_max, other.y_max);
  sum.peak_dn = std::max(sum.peak_dn, other.peak_dn);
  if (other.peak_sum > sum.peak_sum) {
    sum.peak_sum = other.peak_sum;
    sum.peak_x = other.peak_x;
    sum.peak_y = other.peak_y;
  }
  sum.is_saturated = sum.is_saturated || other.is_saturated;
  sum.is_cut = sum.is_cut || other.is_cut;
  sum.x += other.x;
  sum.y += other.y;
  sum.xx += other.xx;
  sum.yy += other.yy;
  sum.flux += other.flux;
  sum.flux_x += other.flux_x;
  sum.flux_y += other.flux_y;
  sum.flux_xx += other.flux_xx;
  sum.flux_xy += other.flux_xy;
  sum.flux_yy += other.flux_yy;
}

}  // namespace

bool is_brighter(const Component& a, const Component& b) {
  if (a.flux != b.flux) return a.flux > b.flux;
  if (a.y_min != b.y_min) return a.y_min < b.y_min;
  return a.x_min < b.x_min;
}

void Components::clear(int largest_px) {
  largest_px_ = largest_px;
  run_count_.fill(0);
  now_ = 0;
  before_ = 0;
  free_count_ = 0;
  for (std::size_t k = kMaxLabels; k > 0; --k) release(static_cast<Label>(k - 1));
  united_count_ = 0;
  kept_count_ = 0;
  min_flux_ = std::numeric_limits<std::int64_t>::min();
  found_ = 0;
  extended_ = 0;
  extended_pixels_ = 0;
  runs_dropped_ = 0;
}

Component* Components::add_run(int y, int begin, int end) {
  const auto& old_runs = runs_[1 - now_];
  const std::size_t old_count = run_count_[1 - now_];
  if (run_count_[now_] == kMaxRunsOfRow) {
    ++runs_dropped_;
    return nullptr;
  }
  // Diagonal neighbours are connected: a run reaches one pixel beyond either of its ends.
  while (before_ < old_count && old_runs[before_].end < begin) ++before_;
  Label label = -1;
  for (std::size_t k = before_; k < old_count && old_runs[k].begin <= end; ++k) {
    const Label other = root_of(old_runs[k].label);
    if (label < 0) {
      label = other;
    } else if (label != other) {
      unite(label, other);
    }
  }
  if (label < 0) label = new_label(y, begin, end);
  runs_[now_][run_count_[now_]++] = {static_cast<std::int16_t>(begin), static_cast<std::int16_t>(end), label};
  Component& c = component(label);
  c.x_min = std::min(c.x_min, begin);
  c.x_max = std::max(c.x_max, end - 1);
  c.y_max = y;
  return &c;
}

Components::Label Components::root_of(Label label) const {
  for (std::size_t step = 0; step < kMaxLabels && parent_[static_cast<std::size_t>(label)] != label; ++step) {
    label = parent_[static_cast<std::size_t>(label)];
  }
  return label;
}

/// There is always a free one: labels in use are those of runs of two rows.
Components::Label Components::new_label(int y, int begin, int end) {
  const Label label = free_[--free_count_];
  parent_[static_cast<std::size_t>(label)] = label;
  component(label) = {.x_min = begin, .x_max = end - 1, .y_min = y, .y_max = y};
  return label;
}

void Components::unite(Label into, Label from) {
  add(component(into), component(from));
  parent_[static_cast<std::size_t>(from)] = into;
  united_[united_count_++] = from;
}

void Components::end_row(int y) {
  // A component without a run in this row is complete. Its label is met once per run, and free after the first.
  const auto& old_runs = runs_[1 - now_];
  for (std::size_t k = 0; k < run_count_[1 - now_]; ++k) {
    const Label label = root_of(old_runs[k].label);
    Component& c = component(label);
    if (c.y_max == y || c.pixels == 0) continue;
    close(c);
    c.pixels = 0;
    release(label);
  }
  for (std::size_t k = 0; k < run_count_[now_]; ++k) runs_[now_][k].label = root_of(runs_[now_][k].label);
  for (std::size_t k = 0; k < united_count_; ++k) release(united_[k]);
  united_count_ = 0;
  now_ = 1 - now_;
  run_count_[now_] = 0;
  before_ = 0;
}

void Components::finish() {
  // An empty row: it continues nothing.
  end_row(-1);
  keep_brightest();
}

void Components::close(const Component& component) {
  ++found_;
  if (is_extended(component)) {
    ++extended_;
    extended_pixels_ += component.pixels;
    return;
  }
  if (component.flux < min_flux_) return;
  if (kept_count_ == kept_.size()) keep_brightest();
  kept_[kept_count_++] = component;
}

void Components::keep_brightest() {
  std::sort(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(kept_count_), is_brighter);
  if (kept_count_ < kMaxObjects) return;
  kept_count_ = kMaxObjects;
  min_flux_ = kept_[kMaxObjects - 1].flux;
}

namespace {

constexpr double kSignificance = 4.0;

class Sums {
 public:
  Sums(const ImageView& image, const Background& background, const Component& component, double gain,
       double detection_sigmas)
      : image_(image), gain_(gain) {
    level_ = static_cast<int>(9.0 * background.level_dn(component.peak_x, component.peak_y) + 0.5);
    const double noise = background.noise_dn(component.peak_x, component.peak_y);
    variance_ = 9.0 * noise * noise;
    threshold_ = static_cast<int>(detection_sigmas * 3.0 * noise);
  }

  /// Returns the sum of 3 x 3 pixels, above the background; missing pixels are background. A component keeps off the
  /// image's outermost pixels, so all nine are there.
  [[nodiscard]] int at(int x, int y) const {
    int sum = -level_;
    for (int j = y - 1; j <= y + 1; ++j) {
      const std::uint16_t* row = image_.pixels.data() + static_cast<std::ptrdiff_t>(j) * image_.frame.width;
      for (int i = x - 1; i <= x + 1; ++i) sum += row[i] == kMissingPixel ? level_ / 9 : row[i];
    }
    return sum;
  }

  /// Returns true if none of its eight neighbours is greater, and none of the equal ones comes first.
  [[nodiscard]] bool is_maximum(int x, int y, const Component& c) const {
    const int here = at(x, y);
    for (int j = std::max(y - 1, c.y_min); j <= std::min(y + 1, c.y_max); ++j) {
      for (int i = std::max(x - 1, c.x_min); i <= std::min(x + 1, c.x_max); ++i) {
        const int other = at(i, j);
        const bool comes_first = j < y || (j == y && i < x);
        if (other > here || (other == here && comes_first)) return false;
      }
    }
    return true;
  }

  /// Returns true if the fainter of two peaks exceeds the minimum on the straight path between them.
  [[nodiscard]] bool are_apart(const Blend::Peak& bright, const Blend::Peak& faint) const {
    const int dx = faint.x - bright.x;
    const int dy = faint.y - bright.y;
    const int steps = std::max(dx < 0 ? -dx : dx, dy < 0 ? -dy : dy);
    int minimum = faint.sum_dn;
    for (int k = 1; k < steps; ++k) {
      const int x = bright.x + (2 * dx * k + (dx < 0 ? -steps : steps)) / (2 * steps);
      const int y = bright.y + (2 * dy * k + (dy < 0 ? -steps : steps)) / (2 * steps);
      minimum = std::min(minimum, at(x, y));
    }
    const double noise = math::sqrt(2.0 * (variance_ + gain_ * std::max(faint.sum_dn, 0)));
    return minimum > threshold_ && faint.sum_dn - minimum > kSignificance * noise;
  }

 private:
  ImageView image_;
  double gain_;
  int level_ = 0;  // level of nine pixels
  int threshold_ = 0;
  double variance_ = 0.0;  // variance of nine pixels without light
};

/// The brightest maxima, in order.
Blend maxima(const Sums& sums, const Component& c) {
  Blend found;
  for (int y = c.y_min; y <= c.y_max; ++y) {
    for (int x = c.x_min; x <= c.x_max; ++x) {
      if (!sums.is_maximum(x, y, c)) continue;
      Blend::Peak peak{x, y, sums.at(x, y)};
      for (std::size_t k = 0; k < found.count; ++k) {
        if (peak.sum_dn > found.peaks[k].sum_dn) std::swap(peak, found.peaks[k]);
      }
      if (found.count < Blend::kMaxPeaks) found.peaks[found.count++] = peak;
    }
  }
  return found;
}

}  // namespace

Blend separate(const ImageView& image, const Background& background, const Component& component,
               double gain_dn_per_electron, double detection_sigmas) {
  const Sums sums(image, background, component, gain_dn_per_electron, detection_sigmas);
  const Blend all = maxima(sums, component);
  Blend apart;
  for (std::size_t k = 0; k < all.count; ++k) {
    const Blend::Peak& peak = all.peaks[k];
    const auto stands_out = [&](const Blend::Peak& brighter) { return sums.are_apart(brighter, peak); };
    if (std::all_of(apart.peaks.begin(), apart.peaks.begin() + static_cast<std::ptrdiff_t>(apart.count), stands_out)) {
      apart.peaks[apart.count++] = peak;
    }
  }
  return apart;
}

}  // namespace vbar::fsw::imaging
