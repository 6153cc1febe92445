#include "hil_drivers/tron/geometry/board_design.h"

#include <array>
#include <cstdint>

namespace vbar::tron::calibrate {
namespace {

constexpr int kBits = 4;  ///< bits of a marker along a side

/// The first markers of DICT_4X4_50 of OpenCV's module aruco, row by row, 1 white.
constexpr std::array<std::uint16_t, 35> kMarkers{0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda,
                                                 0xcf56, 0xf991, 0x11a7, 0x0eb7, 0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600,
                                                 0x6c5e, 0x76af, 0x868b, 0xb02b, 0xccd5, 0xdd82, 0xfe47, 0x9471, 0xace4,
                                                 0xa554, 0x2123, 0x346f, 0x4415, 0x57b2, 0x9ecf, 0xf0cb, 0x08ae};

bool is_white(std::uint16_t marker, int row, int column) {
  return ((marker >> (kBits * kBits - 1 - (row * kBits + column))) & 1) != 0;
}

struct Box {
  double left, top, right, bottom;
};

std::array<fsw::Vector3, 4> corners_of(const Box& box) {
  return {fsw::Vector3(box.left, box.top, 0.0), fsw::Vector3(box.right, box.top, 0.0),
          fsw::Vector3(box.right, box.bottom, 0.0), fsw::Vector3(box.left, box.bottom, 0.0)};
}

class Tiling {
 public:
  void add(const Box& box, bool white) { quads_.push_back({corners_of(box), white}); }

  /// What of `outer` is not of `inner`, in four boxes.
  void add_frame(const Box& outer, const Box& inner, bool white) {
    add({outer.left, outer.top, outer.right, inner.top}, white);
    add({outer.left, inner.bottom, outer.right, outer.bottom}, white);
    add({outer.left, inner.top, inner.left, inner.bottom}, white);
    add({inner.right, inner.top, outer.right, inner.bottom}, white);
  }

  /// The bits of a marker; equal neighbours of a row are one box.
  void add_bits(const Box& box, std::uint16_t marker) {
    const double side = (box.right - box.left) / kBits;
    for (int row = 0; row < kBits; ++row) {
      const double top = box.top + row * side;
      for (int first = 0, next = 0; first < kBits; first = next) {
        const bool white = is_white(marker, row, first);
        while (next < kBits && is_white(marker, row, next) == white) ++next;
        add({box.left + first * side, top, box.left + next * side, top + side}, white);
      }
    }
  }

  [[nodiscard]] std::vector<BoardQuad> quads() && { return std::move(quads_); }

 private:
  std::vector<BoardQuad> quads_;
};

Box inset(const Box& box, double by) {
  return {box.left + by, box.top + by, box.right - by, box.bottom - by};
}

Box squares(const BoardDesign& design) {
  return {-0.5 * design.width_m(), -0.5 * design.height_m(), 0.5 * design.width_m(), 0.5 * design.height_m()};
}

Box plate(const BoardDesign& design) {
  Box box = inset(squares(design), -design.margin_m);
  box.bottom = 0.5 * design.height_m() + design.patch_m;
  return box;
}

}  // namespace

fsw::Vector3 BoardDesign::corner(int id) const {
  const int column = id % (columns - 1), row = id / (columns - 1);
  return {(column + 1) * square_m - 0.5 * width_m(), (row + 1) * square_m - 0.5 * height_m(), 0.0};
}

std::array<fsw::Vector3, 4> BoardDesign::patch() const {
  const Box all = squares(*this);
  return corners_of(inset({all.left, all.bottom, all.right, all.bottom + patch_m}, 0.005));
}

std::vector<BoardQuad> board_quads(const BoardDesign& design) {
  Tiling tiling;
  const Box all = squares(design);
  tiling.add_frame(plate(design), all, true);
  std::size_t marker = 0;
  for (int row = 0; row < design.rows; ++row)
    for (int column = 0; column < design.columns; ++column) {
      const double left = all.left + column * design.square_m, top = all.top + row * design.square_m;
      const Box square{left, top, left + design.square_m, top + design.square_m};
      if (row % 2 == column % 2) {
        tiling.add(square, false);
        continue;
      }
      const Box border = inset(square, 0.5 * (design.square_m - design.marker_m));
      const Box bits = inset(border, design.marker_m / (kBits + 2));
      tiling.add_frame(square, border, true);
      tiling.add_frame(border, bits, false);
      tiling.add_bits(bits, kMarkers[marker++ % kMarkers.size()]);
    }
  return std::move(tiling).quads();
}

BoardQuad board_plate(const BoardDesign& design) {
  return {corners_of(plate(design)), true};
}

Eigen::Isometry3d T_flange_board(const TestbedDesign& bench) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  T.translation() = bench.target.stand_off_m * fsw::Vector3::UnitZ();
  return T;
}

Eigen::Isometry3d T_target_board(const TestbedDesign& bench) {
  return bench.target.T_flange_target(bench.scale).inverse() * T_flange_board(bench);
}

}  // namespace vbar::tron::calibrate
