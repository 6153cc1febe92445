#pragma once
// Snapshot of the flight software (vbar_gnc_save, vbar_gnc_restore) in pieces, as the host reads it from a board and
// writes it to one (fsw/link/frame.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/link/frame.h"

namespace vbar::boards {

/// Room for a snapshot, which holds the state and a header.
inline constexpr std::size_t kSnapshotBytes = std::size_t{8} * 1024 * 1024;

class SnapshotPort {
 public:
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): bytes_ holds what size_ and held_ say
  SnapshotPort() = default;

  /// Discards what was saved, since the state has changed.
  void clear();

  /// Writes the piece at `offset` to `payload`; returns its length. The first call since clear() saves the state. A
  /// total of 0 means that there is no snapshot.
  std::size_t read(const void* state, std::uint32_t offset, std::span<std::uint8_t> payload);

  /// Accepts a piece, and with the last one restores `state`. Writes the payload of a kSnapshotHeld; returns its
  /// length. A repeated piece changes nothing; one beyond the next is not accepted. kWrongType if it is not a piece,
  /// kTooLong if the snapshot exceeds the room, then the status of the restoration.
  fsw::Result<std::size_t> write(void* state, std::span<const std::uint8_t> piece, std::span<std::uint8_t> payload);

 private:
  void save(const void* state);

  bool is_saved_ = false;
  bool is_restored_ = false;
  std::uint32_t size_ = 0;  ///< size of the saved snapshot; 0: none
  std::uint32_t held_ = 0;  ///< bytes of the snapshot being written, from its first on
  std::int32_t status_ = 0;
  std::array<std::uint8_t, kSnapshotBytes> bytes_;
};

}  // namespace vbar::boards
