#pragma once
// Generation of the lookup tables of flight software from stars.

#include <cstdint>
#include <utility>
#include <vector>

#include "star_file.h"

namespace vbar::star_tables {

/// Stars closer than `separation` (rad) are merged: joint brightness, at their photocentre.
std::vector<Star> merge_unresolved(std::vector<Star> stars, double separation);

/// Sorts by coarse cell, in a cell by brightness. Element c is the first star of cell c; one more at the end.
std::vector<std::uint16_t> sort_by_cell(std::vector<Star>& stars);

/// For each fine cell the stars in it or within the margin of it, brightest first.
struct CellTable {
  std::vector<std::uint32_t> first;  ///< per cell; one more at the end
  std::vector<std::uint16_t> stars;
};
CellTable make_cell_table(const std::vector<Star>& stars);

/// A bit for each cell of occupancy, 32 a word from the lowest: whether a star is in it or within the margin of it.
std::vector<std::uint32_t> make_occupancy(const std::vector<Star>& stars);

/// Numbers of the stars used for lost-in-space identification: to `faintest`, and only those with less than
/// `neighbours` brighter chosen ones within `radius` (rad), for a uniform distribution over the sky.
std::vector<std::uint16_t> choose_guides(const std::vector<Star>& stars, double faintest, double radius,
                                         int neighbours);

/// Pairs of guides by length of chord: the brighter star first, and for each step of the chord the first pair that is
/// not shorter (a k-vector, Mortari 1997, on a line of given slope).
struct PairTable {
  std::vector<std::uint32_t> first;  ///< per step of the chord; one more at the end
  std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs;
};
PairTable make_pair_table(const std::vector<Star>& stars, const std::vector<std::uint16_t>& guides);

}  // namespace vbar::star_tables
