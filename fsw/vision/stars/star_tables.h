#pragma once
// The star tables in memory, as the linker placed them (star_tables.S). For the code of this folder; others use
// catalogue.h. The bytes are little-endian, as all targets are.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/vision/stars/star_table_sizes.h"  // generated
#include "fsw/vision/stars/table_layout.h"

namespace vbar::fsw::stars {

struct StarTables {
  /// Unit vectors in ICRS at the epoch, in units of kDirectionUnit. Stars are in order of their coarse cell, in a cell
  /// brightest first.
  std::array<std::array<std::int32_t, 3>, kTableStars> direction;
  std::array<std::int32_t, kTableStars> hipparcos;  ///< 0: has no number
  /// Stars of fine cell c: cell_star[first_of_cell[c]] to before cell_star[first_of_cell[c + 1]], brightest first.
  std::array<std::uint32_t, kFineCells + 1> first_of_cell;
  std::array<std::uint32_t, kOccupancyWords> occupied;  ///< one bit per cell of occupancy, from the lowest
  /// Pairs of chord step s, counted from kFirstChord: pair[first_of_chord[s]] to before pair[first_of_chord[s + 1]].
  std::array<std::uint32_t, kChordSteps + 1> first_of_chord;
  std::array<std::array<std::uint16_t, 2>, kTablePairs> pair;  ///< the brighter star first
  std::array<std::int16_t, kTableStars> millimagnitude;
  std::array<std::uint16_t, kCoarseCells + 1> first_of_coarse_cell;
  std::array<std::uint16_t, kTableCellEntries> cell_star;
};

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
static_assert(sizeof(StarTables) == kTableBytes, "toolchains/star_tables writes another layout");

extern "C" const StarTables vbar_star_tables;

}  // namespace vbar::fsw::stars
