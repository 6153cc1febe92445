#include "sky_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <tuple>

#include "fsw/vision/stars/table_layout.h"

namespace vbar::star_tables {
namespace {

using namespace fsw::stars;

double chord(const Direction& a, const Direction& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

int cell_of_direction(const Direction& d, int edge) {
  return cell_of(d.x, d.y, d.z, edge);
}

/// Brightest first; the direction decides between equals, so that the order is unique.
bool brighter(const Star& a, const Star& b) {
  return std::tie(a.magnitude, a.hipparcos, a.direction.x) < std::tie(b.magnitude, b.hipparcos, b.direction.x);
}

/// Stars in a band of height z, to find neighbours without an exhaustive search: indices sorted by z.
class ByHeight {
 public:
  explicit ByHeight(const std::vector<Star>& stars) : stars_(stars), order_(stars.size()) {
    for (std::size_t k = 0; k < order_.size(); ++k) order_[k] = k;
    std::ranges::sort(order_, [&](std::size_t a, std::size_t b) { return z(a) < z(b); });
  }
  /// Calls use(k) for every star k that may lie within `distance` (chord) of `of`.
  template <class Use>
  void near(const Direction& of, double distance, const Use& use) const {
    const auto low = std::ranges::lower_bound(order_, of.z - distance, {}, [&](std::size_t k) { return z(k); });
    for (auto k = low; k != order_.end() && z(*k) <= of.z + distance; ++k) use(*k);
  }

 private:
  [[nodiscard]] double z(std::size_t k) const { return stars_[k].direction.z; }
  const std::vector<Star>& stars_;
  std::vector<std::size_t> order_;
};

Star together(const Star& a, const Star& b) {
  const double flux_a = std::pow(10.0, -0.4 * a.magnitude);
  const double flux_b = std::pow(10.0, -0.4 * b.magnitude);
  const auto mean = [&](double x, double y) { return (flux_a * x + flux_b * y) / (flux_a + flux_b); };
  Direction d{mean(a.direction.x, b.direction.x), mean(a.direction.y, b.direction.y),
              mean(a.direction.z, b.direction.z)};
  const double length = std::hypot(d.x, d.y, d.z);
  return {{d.x / length, d.y / length, d.z / length},
          -2.5 * std::log10(flux_a + flux_b),
          a.hipparcos != 0 ? a.hipparcos : b.hipparcos};
}

/// Cells within the margin of a direction. Cells are at least four times as wide as the margin, so that a circle of
/// points finds them all. The circle is 1 per cent wider than the margin, to cover the chord between two points.
std::vector<int> cells_around(const Direction& d, int edge) {
  constexpr int kPoints = 32;
  const double across = std::hypot(d.x, d.y);
  const Direction east = across > 0.0 ? Direction{-d.y / across, d.x / across, 0.0} : Direction{0.0, 1.0, 0.0};
  const Direction north{-d.z * east.y, d.z * east.x, d.x * east.y - d.y * east.x};
  std::vector<int> touched{cell_of_direction(d, edge)};
  for (int point = 0; point < kPoints; ++point) {
    const double angle = 2.0 * std::numbers::pi * point / kPoints;
    const double e = 1.01 * kCellMargin * std::cos(angle);
    const double n = 1.01 * kCellMargin * std::sin(angle);
    touched.push_back(
        cell_of(d.x + e * east.x + n * north.x, d.y + e * east.y + n * north.y, d.z + e * east.z + n * north.z, edge));
  }
  std::ranges::sort(touched);
  const auto repeated = std::ranges::unique(touched);
  touched.erase(repeated.begin(), repeated.end());
  return touched;
}

}  // namespace

std::vector<Star> merge_unresolved(std::vector<Star> stars, double separation) {
  std::ranges::sort(stars, brighter);
  const ByHeight heights(stars);
  std::vector<bool> gone(stars.size(), false);
  std::vector<Star> merged;
  for (std::size_t k = 0; k < stars.size(); ++k) {
    if (gone[k]) continue;
    std::vector<std::size_t> companions;
    heights.near(stars[k].direction, separation, [&](std::size_t other) {
      if (other > k && !gone[other] && chord(stars[k].direction, stars[other].direction) < separation) {
        companions.push_back(other);
      }
    });
    std::ranges::sort(companions);
    Star joint = stars[k];
    for (const std::size_t other : companions) {
      joint = together(joint, stars[other]);
      gone[other] = true;
    }
    merged.push_back(joint);
  }
  return merged;
}

std::vector<std::uint16_t> sort_by_cell(std::vector<Star>& stars) {
  const auto cell = [](const Star& star) { return cell_of_direction(star.direction, kCoarseEdge); };
  std::ranges::sort(
      stars, [&](const Star& a, const Star& b) { return cell(a) != cell(b) ? cell(a) < cell(b) : brighter(a, b); });
  std::vector<std::uint16_t> first(kCoarseCells + 1, 0);
  for (const Star& star : stars) ++first[static_cast<std::size_t>(cell(star)) + 1];
  for (std::size_t c = 1; c < first.size(); ++c) first[c] = static_cast<std::uint16_t>(first[c] + first[c - 1]);
  return first;
}

CellTable make_cell_table(const std::vector<Star>& stars) {
  std::vector<std::vector<std::uint16_t>> cells(kFineCells);
  for (std::size_t k = 0; k < stars.size(); ++k) {
    for (const int cell : cells_around(stars[k].direction, kFineEdge)) {
      cells[static_cast<std::size_t>(cell)].push_back(static_cast<std::uint16_t>(k));
    }
  }
  CellTable table;
  table.first.push_back(0);
  for (std::vector<std::uint16_t>& cell : cells) {
    std::ranges::sort(cell, [&](std::uint16_t a, std::uint16_t b) { return brighter(stars[a], stars[b]); });
    table.stars.insert(table.stars.end(), cell.begin(), cell.end());
    table.first.push_back(static_cast<std::uint32_t>(table.stars.size()));
  }
  return table;
}

std::vector<std::uint32_t> make_occupancy(const std::vector<Star>& stars) {
  std::vector<std::uint32_t> words(kOccupancyWords, 0);
  for (const Star& star : stars) {
    for (const int cell : cells_around(star.direction, kOccupancyEdge)) {
      words[static_cast<std::size_t>(cell / 32)] |= std::uint32_t{1} << cell % 32;
    }
  }
  return words;
}

std::vector<std::uint16_t> choose_guides(const std::vector<Star>& stars, double faintest, double radius,
                                         int neighbours) {
  const double reach = 2.0 * std::sin(0.5 * radius);
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < stars.size(); ++k) {
    if (stars[k].magnitude <= faintest) order.push_back(k);
  }
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return brighter(stars[a], stars[b]); });
  const ByHeight heights(stars);
  std::vector<bool> chosen(stars.size(), false);
  std::vector<std::uint16_t> guides;
  for (const std::size_t k : order) {
    int near = 0;
    heights.near(stars[k].direction, reach, [&](std::size_t other) {
      if (chosen[other] && chord(stars[k].direction, stars[other].direction) < reach) ++near;
    });
    if (near >= neighbours) continue;
    chosen[k] = true;
    guides.push_back(static_cast<std::uint16_t>(k));
  }
  return guides;
}

PairTable make_pair_table(const std::vector<Star>& stars, const std::vector<std::uint16_t>& guides) {
  std::vector<Star> guide_stars;
  for (const std::uint16_t k : guides) guide_stars.push_back(stars[k]);  // brightest first
  const ByHeight heights(guide_stars);
  std::vector<std::vector<std::pair<std::uint16_t, std::uint16_t>>> steps(kChordSteps);
  for (std::size_t a = 0; a < guides.size(); ++a) {
    std::vector<std::size_t> partners;
    heights.near(guide_stars[a].direction, (kLastChord + 1) * kChordStep, [&](std::size_t b) {
      if (b > a) partners.push_back(b);
    });
    std::ranges::sort(partners);
    for (const std::size_t b : partners) {
      const int step =
          static_cast<int>(chord(guide_stars[a].direction, guide_stars[b].direction) / kChordStep) - kFirstChord;
      if (step >= 0 && step < kChordSteps) steps[static_cast<std::size_t>(step)].emplace_back(guides[a], guides[b]);
    }
  }
  PairTable table;
  table.first.push_back(0);
  for (const auto& step : steps) {
    table.pairs.insert(table.pairs.end(), step.begin(), step.end());
    table.first.push_back(static_cast<std::uint32_t>(table.pairs.size()));
  }
  return table;
}

}  // namespace vbar::star_tables
