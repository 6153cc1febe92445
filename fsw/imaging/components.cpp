#include "fsw/imaging/components.h"

#include <algorithm>
#include <limits>

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

}  // namespace vbar::fsw::imaging
