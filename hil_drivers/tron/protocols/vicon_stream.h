#pragma once
// The UDP object stream of Vicon Tracker. A datagram is a block, little-endian and packed:
//
//   u32 frame number, u8 items in the block, then for each item
//   u8 kind (0: object), u16 bytes that follow (72), char[24] name padded with NUL, f64 x 3 translation, mm,
//   f64 x 3 rotation, rad
//
// Blocks are padded to 256, 512 or 1024 bytes or not at all. Objects that do not fit into one block follow in further
// blocks of the same frame number. All numbers of an object that is occluded are zero. There is no time stamp.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::tron::vicon {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

inline constexpr std::size_t kHeaderBytes = 5;
inline constexpr std::size_t kItemHeaderBytes = 3;
inline constexpr std::size_t kNameBytes = 24;
inline constexpr std::size_t kObjectBytes = kNameBytes + 6 * sizeof(double);
inline constexpr std::size_t kItemBytes = kItemHeaderBytes + kObjectBytes;
inline constexpr std::uint8_t kObjectKind = 0;
inline constexpr std::size_t kMaxItems = 255;
inline constexpr std::array<std::size_t, 4> kBlockBytes{0, 256, 512, 1024};  ///< 0: as long as its items
inline constexpr std::size_t kMaxDatagramBytes = 65507;                      ///< largest payload of UDP over IPv4

struct TrackedObject {
  std::string name;
  std::array<double, 3> translation_mm{};
  std::array<double, 3> rotation_rad{};  ///< RotX, RotY, RotZ

  [[nodiscard]] bool is_occluded() const;  ///< all six numbers are zero
  /// Returns true if the bits of the numbers are equal.
  [[nodiscard]] bool has_same_numbers(const TrackedObject& other) const;
};

struct ObjectBlock {
  std::uint32_t frame = 0;
  std::vector<TrackedObject> objects;

  /// Returns nothing if the block has no object of that name.
  [[nodiscard]] const TrackedObject* find(std::string_view name) const;
};

/// Encodes the blocks of a frame. Throws std::invalid_argument for a name that is empty, longer than 24 bytes or
/// contains NUL, for a size of blocks that is not in kBlockBytes, and for objects that do not fit into one unpadded
/// block.
[[nodiscard]] std::vector<Bytes> encode_frame(const ObjectBlock& frame, std::size_t block_bytes);

/// Decodes bytes from the network. Items of other kinds are skipped; bytes after the last item are padding and are not
/// read. Throws std::invalid_argument with the position of the error: a block shorter than its items, an object of
/// another size, a name that is empty, not printable ASCII or given twice, a number that is not finite.
[[nodiscard]] ObjectBlock decode_block(ByteSpan datagram);

// Angles about the axes of motion capture and rotation matrices. In the order "xyz" R = Rx(RotX) Ry(RotY) Rz(RotZ);
// "zyx" is Rz(RotZ) Ry(RotY) Rx(RotX).

inline constexpr std::array<std::string_view, 6> kRotationOrders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

/// Returns the rotation by `angles_rad` about x, y, z, whatever the order. Throws std::invalid_argument for an order
/// that is not in kRotationOrders.
[[nodiscard]] fsw::Matrix3 rotation_of(const std::array<double, 3>& angles_rad, std::string_view order);

/// Returns the angles about x, y, z of a rotation.
[[nodiscard]] std::array<double, 3> angles_of(const fsw::Matrix3& rotation, std::string_view order);

}  // namespace vbar::tron::vicon
