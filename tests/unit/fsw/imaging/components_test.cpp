// Components against a flood fill of the whole mask, which is slow and obvious.

#include "fsw/imaging/components.h"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::imaging {
namespace {

/// Rows of text: '#' is above the threshold.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<bool> is_set;
  [[nodiscard]] bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && is_set[static_cast<std::size_t>(y * width + x)];
  }
};

Mask random_mask(int width, int height, double part, std::mt19937& random) {
  std::bernoulli_distribution is_set(part);
  Mask mask{width, height, {}};
  for (int k = 0; k < width * height; ++k) mask.is_set.push_back(is_set(random));
  return mask;
}

Mask mask_of(const std::vector<std::string>& rows) {
  Mask mask{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), {}};
  for (const std::string& row : rows) {
    for (const char c : row) mask.is_set.push_back(c == '#');
  }
  return mask;
}

/// What identifies a component: number of pixels, sums of coordinates, box.
using Facts = std::array<std::int64_t, 7>;

std::vector<Facts> flood_filled(const Mask& mask) {
  std::vector<bool> is_seen(mask.is_set.size());
  std::vector<Facts> all;
  for (int k = 0; k < mask.width * mask.height; ++k) {
    if (!mask.is_set[static_cast<std::size_t>(k)] || is_seen[static_cast<std::size_t>(k)]) continue;
    Facts f{0, 0, 0, mask.width, -1, mask.height, -1};
    std::vector<int> open{k};
    is_seen[static_cast<std::size_t>(k)] = true;
    while (!open.empty()) {
      const int x = open.back() % mask.width;
      const int y = open.back() / mask.width;
      open.pop_back();
      f[0] += 1;
      f[1] += x;
      f[2] += y;
      f[3] = std::min<std::int64_t>(f[3], x);
      f[4] = std::max<std::int64_t>(f[4], x);
      f[5] = std::min<std::int64_t>(f[5], y);
      f[6] = std::max<std::int64_t>(f[6], y);
      for (int j = y - 1; j <= y + 1; ++j) {
        for (int i = x - 1; i <= x + 1; ++i) {
          const auto n = static_cast<std::size_t>(j * mask.width + i);
          if (!mask.at(i, j) || is_seen[n]) continue;
          is_seen[n] = true;
          open.push_back(j * mask.width + i);
        }
      }
    }
    all.push_back(f);
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// A pixel's light is one; its sums as the detector would add them.
void scan(Components& components, const Mask& mask, std::int32_t largest) {
  components.clear(largest);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (!mask.at(x, y) || mask.at(x - 1, y)) continue;
      int end = x;
      while (mask.at(end, y)) ++end;
      Component* c = components.add_run(y, x, end);
      if (c == nullptr) continue;
      c->pixels += end - x;
      c->flux += end - x;
      for (int i = x; i < end; ++i) {
        c->x += i;
        c->y += y;
      }
    }
    components.end_row(y);
  }
  components.finish();
}

std::vector<Facts> labelled(const Mask& mask) {
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1'000'000);
  std::vector<Facts> all;
  for (const Component& c : components->kept()) all.push_back({c.pixels, c.x, c.y, c.x_min, c.x_max, c.y_min, c.y_max});
  EXPECT_EQ(components->found(), static_cast<int>(all.size()));
  EXPECT_EQ(components->runs_dropped(), 0);
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Components, AreThoseOfAFloodFill) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    // From sparse to past the density where all grows together (40.7 % with eight neighbours): long and winding ones.
    const Mask mask = random_mask(60, 40, 0.02 + 0.0018 * trial, random);
    const std::vector<Facts> expected = flood_filled(mask);
    if (expected.size() > kMaxObjects) continue;
    ASSERT_EQ(labelled(mask), expected) << "trial " << trial;
  }
}

TEST(Components, ShapesThatMeetLate) {
  const std::vector<std::vector<std::string>> shapes{
      {"#.#.#.#", "#.#.#.#", "#######"},                                              // a comb
      {"#######", "#.....#", "#.###.#", "#.#.#.#", "#.#...#", "#.#####", "#......"},  // a spiral
      {"#...#", ".#.#.", "..#..", ".#.#.", "#...#"},                                  // corners touch
      {"#.....#", "#.#.#.#", "#.#.#.#", "###.###", "......."},                        // two, side by side
      {"##.##", ".....", "##.##"},                                                    // four
  };
  for (const auto& shape : shapes) EXPECT_EQ(labelled(mask_of(shape)), flood_filled(mask_of(shape)));
}

TEST(Components, OfTooManyTheBrightestAreKept) {
  // Singles first, then so many of two pixels
  Mask mask{400, 101, std::vector<bool>(400 * 101)};
  int doubles = 0;
  for (int y = 0; y < 100; y += 2) {
    for (int x = 0; x < 399; x += 4) {
      mask.is_set[static_cast<std::size_t>(y * 400 + x)] = true;
      if ((x / 4 + y) % 20 == 19 && doubles < 200) {
        mask.is_set[static_cast<std::size_t>(y * 400 + x + 1)] = true;
        ++doubles;
      }
    }
  }
  ASSERT_EQ(doubles, 200);
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1000);
  EXPECT_EQ(components->found(), 5000);
  ASSERT_EQ(components->kept().size(), kMaxObjects);
  for (std::size_t k = 0; k < kMaxObjects; ++k) EXPECT_EQ(components->kept()[k].flux, k < 200 ? 2 : 1);
  // Of those that are alike, the topmost
  EXPECT_EQ(components->kept()[200].y_min, 0);
  EXPECT_LE(components->kept()[255].y_min, 2);
}

TEST(Components, ExtendedOnesAreCountedAndLeftOut) {
  const auto components = std::make_unique<Components>();
  scan(*components, mask_of({"###..#", "###...", "###..#"}), 8);
  EXPECT_EQ(components->found(), 3);
  EXPECT_EQ(components->extended(), 1);
  EXPECT_EQ(components->extended_pixels(), 9);
  EXPECT_EQ(components->kept().size(), 2u);
}

TEST(Components, ARowTooFullIsNotReadToItsEnd) {
  Mask mask{2048, 3, {}};
  for (int k = 0; k < 2048 * 3; ++k) mask.is_set.push_back(k % 2 == 0);
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1'000'000);
  EXPECT_EQ(components->runs_dropped(), 3 * (1024 - 512));
  EXPECT_EQ(components->found(), 512);
}

}  // namespace
}  // namespace vbar::fsw::imaging
