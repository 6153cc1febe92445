#pragma once
// The snapshot of the flight software (vbar_gnc_save, vbar_gnc_restore) in pieces, as the host reads it from a board
// and writes it to one (fsw/link/frame.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/link/frame.h"

namespace vbar::boards {

/// Largest size of a snapshot, which holds the state and a header.
inline constexpr std::size_t kSnapshotBytes = std::size_t{8} * 1024 * 1024;

class SnapshotPort {
 public:
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): bytes_ holds what size_ and held_ say
  SnapshotPort() = default;

  /// Discards the saved snapshot, when the state has changed.
  void clear();

  /// Writes the piece at `offset` to `payload` and returns its length. The first call since clear() saves the state. A
  /// total of 0 means that there is no snapshot.
  std::size_t read(const void* state, std::uint32_t offset, std::span<std::uint8_t> payload);

  /// Accepts a piece, and restores `state` with the last one. Writes the payload of a kSnapshotHeld and returns its
  /// length. A repeated piece changes nothing; one beyond the next is not accepted. kWrongType for an invalid piece,
  /// kTooLong for a snapshot larger than the room, else the status of the restoration.
  fsw::Result<std::size_t> write(void* state, std::span<const std::uint8_t> piece, std::span<std::uint8_t> payload);

 private:
  void save(const void* state);

  bool is_saved_ = false;
  bool is_restored_ = false;
  std::uint32_t size_ = 0;  ///< size of the saved snapshot; 0: none
  std::uint32_t held_ = 0;  ///< bytes received of the snapshot that is written, from its first byte on
  std::int32_t status_ = 0;
  std::array<std::uint8_t, kSnapshotBytes> bytes_;
};

}  // namespace vbar::boards
