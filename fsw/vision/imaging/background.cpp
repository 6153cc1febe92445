#include "fsw/vision/imaging/background.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {

namespace {

constexpr double kClip = 3.0;
constexpr int kMaxIterations = 6;
/// Smallest sigma, that of equal integers: rounding alone has a standard deviation of sqrt(1/12).
constexpr double kMinSigma = 0.28867513459481287;
constexpr double kQuartilesPerSigma = 1.3489795003921634;  // from the lower to the upper

/// The values that a quarter, a half and three quarters of the samples do not exceed.
std::array<int, 3> quartiles(std::span<const std::uint16_t> counts, int total) {
  std::array<int, 3> values{};
  std::size_t found = 0;
  int below = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    below += counts[k];
    while (found < 3 && 4 * below >= (static_cast<int>(found) + 1) * total) values[found++] = static_cast<int>(k);
    if (found == 3) break;
  }
  return values;
}

/// Variance of a Gaussian truncated at +-k sigma, as part of the complete one's.
double remaining_variance(double k) {
  const double density = math::exp(-0.5 * k * k) * 0.3989422804014327;  // 1 / sqrt(2 pi)
  return 1.0 - 2.0 * k * density / math::erf(k * 0.7071067811865476);
}

}  // namespace

ClippedMoments clipped_moments(std::span<const std::uint16_t> counts, int total) {
  const auto [lower, median, upper] = quartiles(counts, total);
  ClippedMoments moments{static_cast<double>(median), std::max((upper - lower) / kQuartilesPerSigma, 2.0 * kMinSigma)};
  const int last = static_cast<int>(counts.size()) - 1;
  int first_before = -1;
  int end_before = -1;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double reach = kClip * moments.sigma;
    const int first = std::clamp(static_cast<int>(math::floor(moments.mean - reach)) + 1, 0, last);
    const int end = std::clamp(static_cast<int>(math::floor(moments.mean + reach)), first, last) + 1;
    if (first == first_before && end == end_before) break;
    first_before = first;
    end_before = end;
    std::int64_t n = 0;
    std::int64_t sum = 0;
    std::int64_t squares = 0;
    for (int k = first; k < end; ++k) {
      const std::int64_t count = counts[static_cast<std::size_t>(k)];
      const std::int64_t x = k - median;
      n += count;
      sum += count * x;
      squares += count * x * x;
    }
    if (n == 0) break;
    const double mean = static_cast<double>(sum) / static_cast<double>(n);
    const double variance = static_cast<double>(squares) / static_cast<double>(n) - mean * mean;
    // An integer represents all values rounded to it, so that the cut lies half beyond the outermost.
    const double k = std::max(0.5 * (end - first) / std::max(moments.sigma, kMinSigma), 1.0);
    moments.mean = median + mean;
    moments.sigma = std::max(math::sqrt(std::max(variance, 0.0) / remaining_variance(k)), kMinSigma);
  }
  return moments;
}

namespace {

constexpr int kOne = 256;
constexpr int kMaxLevel = 4095 * kOne;
constexpr int kMaxNoise = 255 * kOne;
/// One in 16 of the pixels of an image must be present, and one in 16 of these unsaturated.
constexpr int kMinPart = 16;
/// One in 8 of the samples of a cell must be valid, and at least this number.
constexpr int kMinPartOfCell = 8;
constexpr int kMinSamples = 12;
/// A cell brighter than the consensus of its neighbours by this number of sigma of a pixel is filled by an object.
constexpr int kOutlierNoises = 8;
constexpr int kSegmentShift = 14;  // of the 20 bits of a position, with the six that a slope has beyond DN / 256

bool is_image(const ImageView& image) {
  const ImageFrame& f = image.frame;
  if (f.width < 1 || f.height < 1 || f.width > kMaxSide || f.height > kMaxSide) return false;
  const auto pixels = static_cast<std::size_t>(f.width) * static_cast<std::size_t>(f.height);
  return pixels <= kMaxPixels && image.pixels.size() == pixels;
}

int in_256ths(double value, int maximum) {
  return std::clamp(static_cast<int>(math::floor(value * kOne + 0.5)), 0, maximum);
}

/// Between two nodes; `position` in 2^-20 of their distance.
int between(int a, int b, int position) {
  const std::int64_t part = position & ((1 << 20) - 1);
  return a + static_cast<int>((part * (b - a)) >> 20);
}

/// Median of a few values, which are sorted; for an even number the darker middle one, since errors are towards bright.
int middle_of(std::span<int> values) {
  for (std::size_t end = 1; end < values.size(); ++end) {
    for (std::size_t k = end; k > 0 && values[k] < values[k - 1]; --k) std::swap(values[k], values[k - 1]);
  }
  return values[(values.size() - 1) / 2];
}

}  // namespace

Background::Axis Background::axis_of(int pixels) {
  const int cells = std::max(1, (pixels + kCell / 2) / kCell);
  return {pixels, cells, (cells << 20) / pixels};
}

ImageCondition Background::measure(const ImageView& image, int saturation_dn) {
  if (!is_image(image) || saturation_dn < 1 || saturation_dn > 4095) return ImageCondition::kInvalid;
  x_ = axis_of(image.frame.width);
  y_ = axis_of(image.frame.height);
  if (const ImageCondition condition = measure_cells(image, saturation_dn); condition != ImageCondition::kGood) {
    return condition;
  }
  if (!fill_gaps()) return ImageCondition::kTooLittle;
  replace_outliers();
  find_typical();
  find_level_uncertainty();
  extend(level_, [](int last, int before) { return std::clamp(2 * last - before, 0, kMaxLevel); });
  extend(noise_, [](int last, int) { return last; });
  // The error of an extrapolation by half a cell is three times that of an interpolation.
  extend(level_uncertainty_, [](int last, int) { return std::min(3 * last, kMaxLevel); });
  int x = 0;
  for (int k = 0; k < x_.cells + 2; ++k) {
    while (x < x_.pixels && (x_.position(x) >> 20) < k) ++x;
    segment_begin_[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(x);
  }
  return ImageCondition::kGood;
}

ImageCondition Background::measure_cells(const ImageView& image, int saturation_dn) {
  sampled_ = 0;
  saturated_ = 0;
  missing_ = 0;
  darkest_ = static_cast<int>(kLevels);
  brightest_ = -1;
  level_count_.fill(0);
  difference_count_.fill(0);
  for (int row = 0; row < y_.cells; ++row) {
    for (int column = 0; column < x_.cells; ++column) {
      count_cell(image, saturation_dn, column, row);
      measure_cell(column, row);
    }
  }
  const int there = sampled_ - missing_;
  if (there * kMinPart < sampled_ || there == 0) return ImageCondition::kTooLittle;
  if ((there - saturated_) * kMinPart < there || there == saturated_) return ImageCondition::kSaturated;
  return darkest_ == brightest_ ? ImageCondition::kBlank : ImageCondition::kGood;
}

/// Histograms of a quarter of the cell's pixels and of their differences to the right: enough for a level to 0.04
/// sigma.
void Background::count_cell(const ImageView& image, int saturation_dn, int column, int row) {
  levels_ = 0;
  differences_ = 0;
  lowest_ = static_cast<int>(kLevels);
  highest_ = -1;
  const int begin = x_.first_pixel(column);
  const int end = x_.first_pixel(column + 1);
  const int last_row = y_.first_pixel(row + 1);
  for (int y = y_.first_pixel(row); y < last_row; y += 2) {
    const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(x_.pixels);
    for (int x = begin; x < end; x += 2) {
      const std::size_t k = start + static_cast<std::size_t>(x);
      const int value = image.pixels[k];
      ++sampled_;
      if (value >= saturation_dn) {
        ++(value == kMissingPixel ? missing_ : saturated_);
        continue;
      }
      ++levels_;
      ++level_count_[static_cast<std::size_t>(value)];
      lowest_ = std::min(lowest_, value);
      highest_ = std::max(highest_, value);
      if (x + 1 >= x_.pixels || image.pixels[k + 1] >= saturation_dn) continue;
      const int difference = std::clamp(int{image.pixels[k + 1]} - value, -kMaxDifference, kMaxDifference);
      ++differences_;
      const int bin = difference + kMaxDifference;
      ++difference_count_[static_cast<std::size_t>(bin)];
    }
  }
  darkest_ = std::min(darkest_, lowest_);
  brightest_ = std::max(brightest_, highest_);
}

/// Level and noise from the histograms, which are empty afterwards.
void Background::measure_cell(int column, int row) {
  const int width = x_.first_pixel(column + 1) - x_.first_pixel(column);
  const int height = y_.first_pixel(row + 1) - y_.first_pixel(row);
  const int minimum = std::max(kMinSamples, width * height / (4 * kMinPartOfCell));
  const std::size_t k = node(column, row);
  is_known_[k] = levels_ >= minimum && differences_ >= minimum;
  if (is_known_[k]) {
    const auto first = static_cast<std::size_t>(lowest_);
    const std::size_t count = static_cast<std::size_t>(highest_) - first + 1;
    const double level = lowest_ + clipped_moments(std::span(level_count_).subspan(first, count), levels_).mean;
    level_[k] = in_256ths(level, kMaxLevel);
    const double scatter = clipped_moments(difference_count_, differences_).sigma;
    noise_[k] = in_256ths(scatter * 0.7071067811865476, kMaxNoise);
  }
  if (levels_ > 0) std::fill(level_count_.begin() + lowest_, level_count_.begin() + highest_ + 1, std::uint16_t{0});
  if (differences_ > 0) difference_count_.fill(0);
}

/// Cells without a value are assigned that of their neighbours, from the known ones outwards. False: no cell has any.
bool Background::fill_gaps() {
  for (int pass = 0; pass < x_.cells + y_.cells; ++pass) {
    bool is_complete = true;
    bool is_changed = false;
    std::array<bool, kMaxNodes> known = is_known_;
    for (int row = 0; row < y_.cells; ++row) {
      for (int column = 0; column < x_.cells; ++column) {
        if (is_known_[node(column, row)]) continue;
        const bool is_filled = fill_gap(column, row);
        known[node(column, row)] = is_filled;
        is_changed = is_changed || is_filled;
        is_complete = is_complete && is_filled;
      }
    }
    is_known_ = known;
    if (is_complete) return true;
    if (!is_changed) return false;
  }
  return false;
}

bool Background::fill_gap(int column, int row) {
  std::int64_t level = 0;
  std::int64_t noise = 0;
  int count = 0;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, y_.cells - 1); ++r) {
    for (int c = std::max(column - 1, 0); c <= std::min(column + 1, x_.cells - 1); ++c) {
      if (!is_known_[node(c, r)]) continue;
      level += level_[node(c, r)];
      noise += noise_[node(c, r)];
      ++count;
    }
  }
  if (count == 0) return false;
  level_[node(column, row)] = static_cast<int>(level / count);
  noise_[node(column, row)] = static_cast<int>(noise / count);
  return true;
}

/// An object that fills a cell must not become background; stray light, which is smoother, should.
void Background::replace_outliers() {
  for (int row = 0; row < y_.cells; ++row) {
    for (int column = 0; column < x_.cells; ++column) {
      const std::size_t k = node(column, row);
      const int agreed = agreed_level(column, row);
      scratch_[k] = level_[k] - agreed > kOutlierNoises * noise_[k] ? agreed : level_[k];
    }
  }
  for (int row = 0; row < y_.cells; ++row) {
    for (int column = 0; column < x_.cells; ++column) level_[node(column, row)] = scratch_[node(column, row)];
  }
}

/// Median of the cell's own level and of the predictions of its neighbours along every line through it: between two of
/// them, or at the edge beyond two of them. All agree if the background is a plane, so that a gradient is preserved.
int Background::agreed_level(int column, int row) const {
  constexpr std::array<std::array<int, 2>, 4> kLines{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const auto is_inside = [this](int c, int r) { return c >= 0 && r >= 0 && c < x_.cells && r < y_.cells; };
  std::array<int, 5> said{level_[node(column, row)]};
  std::size_t count = 1;
  for (const auto& [dc, dr] : kLines) {
    const bool has_before = is_inside(column - dc, row - dr);
    const bool has_after = is_inside(column + dc, row + dr);
    if (has_before && has_after) {
      said[count++] = (level_[node(column - dc, row - dr)] + level_[node(column + dc, row + dr)]) / 2;
    } else {
      const int way = has_before ? -1 : 1;
      if (!is_inside(column + 2 * way * dc, row + 2 * way * dr)) continue;
      said[count++] =
          2 * level_[node(column + way * dc, row + way * dr)] - level_[node(column + 2 * way * dc, row + 2 * way * dr)];
    }
  }
  return std::clamp(middle_of(std::span(said).first(count)), 0, kMaxLevel);
}

/// Linear interpolation errs by an eighth of the second difference, along either axis.
void Background::find_level_uncertainty() {
  const auto bend = [](int a, int b, int c) { return (a - b) + (c - b); };
  for (int row = 0; row < y_.cells; ++row) {
    for (int column = 0; column < x_.cells; ++column) {
      int sum = 0;
      if (x_.cells > 2) {
        const int c = std::clamp(column, 1, x_.cells - 2);
        const int d = bend(level_[node(c - 1, row)], level_[node(c, row)], level_[node(c + 1, row)]);
        sum += d < 0 ? -d : d;
      }
      if (y_.cells > 2) {
        const int r = std::clamp(row, 1, y_.cells - 2);
        const int d = bend(level_[node(column, r - 1)], level_[node(column, r)], level_[node(column, r + 1)]);
        sum += d < 0 ? -d : d;
      }
      level_uncertainty_[node(column, row)] = sum / 8;
    }
  }
}

/// Nodes beyond the ends from the last two: beyond(last, the one before).
template <class Beyond>
void Background::extend(Grid& grid, Beyond beyond) const {
  for (int row = 0; row < y_.cells; ++row) {
    const int second = std::min(1, x_.cells - 1);
    grid[node(-1, row)] = beyond(grid[node(0, row)], grid[node(second, row)]);
    grid[node(x_.cells, row)] = beyond(grid[node(x_.cells - 1, row)], grid[node(x_.cells - 1 - second, row)]);
  }
  for (int column = -1; column <= x_.cells; ++column) {
    const int second = std::min(1, y_.cells - 1);
    grid[node(column, -1)] = beyond(grid[node(column, 0)], grid[node(column, second)]);
    grid[node(column, y_.cells)] = beyond(grid[node(column, y_.cells - 1)], grid[node(column, y_.cells - 1 - second)]);
  }
}

void Background::find_typical() {
  const auto median_dn = [this](const Grid& grid) {
    std::ptrdiff_t count = 0;
    for (int row = 0; row < y_.cells; ++row) {
      for (int column = 0; column < x_.cells; ++column)
        scratch_[static_cast<std::size_t>(count++)] = grid[node(column, row)];
    }
    std::sort(scratch_.begin(), scratch_.begin() + count);
    return static_cast<double>(scratch_[static_cast<std::size_t>(count / 2)]) / kOne;
  };
  typical_level_dn_ = median_dn(level_);
  typical_noise_dn_ = median_dn(noise_);
}

template <class At>
void Background::set_row(int y, RowNodes& nodes, At at_node) const {
  const int position = y_.position(y);
  const int above = (position >> 20) - 1;
  const std::size_t first = node(-1, above);
  const std::size_t count = node(-1, above + 1) - first;
  for (std::size_t k = 0; k < count; ++k) {
    nodes[k] = between(at_node(first + k), at_node(first + count + k), position);
  }
}

void Background::level_row(int y, RowNodes& nodes) const {
  set_row(y, nodes, [this](std::size_t k) { return level_[k]; });
}

void Background::threshold_row(int y, int noises_q4, RowNodes& nodes) const {
  set_row(y, nodes, [this, noises_q4](std::size_t k) {
    return 9 * (level_[k] + level_uncertainty_[k]) + noises_q4 * noise_[k] / 16;
  });
}

int Background::at(const RowNodes& nodes, int x) const {
  const int position = x_.position(x);
  const auto k = static_cast<std::size_t>(position >> 20);
  return between(nodes[k], nodes[k + 1], position);
}

void Background::fill(const RowNodes& nodes, std::span<int> out_dn) const {
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(x_.cells) + 2; ++k) {
    const int begin = segment_begin_[k];
    const int end = segment_begin_[k + 1];
    if (begin == end) continue;
    // 64ths of DN / 256 are enough: over a segment of at most 95 pixels the slope's rounding adds up to 0.006 DN.
    int value = at(nodes, begin) * 64;
    const auto slope = static_cast<int>((std::int64_t{nodes[k + 1] - nodes[k]} * x_.step) >> kSegmentShift);
    for (int x = begin; x < end; ++x, value += slope) out_dn[static_cast<std::size_t>(x)] = value >> 14;
  }
}

double Background::level_dn(int x, int y) const {
  RowNodes nodes;
  level_row(y, nodes);
  return static_cast<double>(at(nodes, x)) / kOne;
}

double Background::noise_dn(int x, int y) const {
  RowNodes nodes;
  set_row(y, nodes, [this](std::size_t k) { return noise_[k]; });
  return static_cast<double>(at(nodes, x)) / kOne;
}

}  // namespace vbar::fsw::imaging
