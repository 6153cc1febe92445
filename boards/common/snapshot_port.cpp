#include "boards/common/snapshot_port.h"

#include <algorithm>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/big_endian.h"

// Optional functions: an image whose flight software lacks them has null in their place.
extern "C" {
[[gnu::weak]] size_t vbar_gnc_snapshot_size(void);
[[gnu::weak]] vbar_status vbar_gnc_save(const void* state, uint8_t* snapshot, size_t size);
[[gnu::weak]] vbar_status vbar_gnc_restore(void* state, const uint8_t* snapshot, size_t size);
}

namespace vbar::boards {
namespace {

using fsw::Status;
using fsw::link::kSnapshotHeldBytes;
using fsw::link::kSnapshotPieceBytes;
using fsw::link::kSnapshotPieceHeaderBytes;

}  // namespace

void SnapshotPort::clear() {
  is_saved_ = false;
  is_restored_ = false;
  size_ = 0;
  held_ = 0;
  status_ = 0;
}

void SnapshotPort::save(const void* state) {
  is_saved_ = true;
  size_ = 0;
  if (vbar_gnc_snapshot_size == nullptr || vbar_gnc_save == nullptr) return;
  const std::size_t size = vbar_gnc_snapshot_size();
  if (size > bytes_.size() || vbar_gnc_save(state, bytes_.data(), size) != 0) return;
  size_ = static_cast<std::uint32_t>(size);
}

std::size_t SnapshotPort::read(const void* state, std::uint32_t offset, std::span<std::uint8_t> payload) {
  if (!is_saved_) save(state);
  const std::uint32_t begin = std::min(offset, size_);
  const std::size_t count = std::min<std::size_t>(size_ - begin, kSnapshotPieceBytes);
  fsw::packets::write_big_endian(size_, payload, 0);
  fsw::packets::write_big_endian(begin, payload, 4);
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin), count,
              payload.begin() + static_cast<std::ptrdiff_t>(kSnapshotPieceHeaderBytes));
  return kSnapshotPieceHeaderBytes + count;
}

fsw::Result<std::size_t> SnapshotPort::write(void* state, std::span<const std::uint8_t> piece,
                                             std::span<std::uint8_t> payload) {
  if (piece.size() <= kSnapshotPieceHeaderBytes) return Status::kWrongType;
  const auto total = fsw::packets::read_big_endian<std::uint32_t>(piece, 0);
  const auto begin = fsw::packets::read_big_endian<std::uint32_t>(piece, 4);
  const auto content = piece.subspan(kSnapshotPieceHeaderBytes);
  if (begin > total || content.size() > total - begin) return Status::kWrongType;
  if (total > bytes_.size()) {
    status_ = static_cast<std::int32_t>(Status::kTooLong);
  } else if (begin == held_ && !is_restored_) {
    std::copy(content.begin(), content.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin));
    held_ += static_cast<std::uint32_t>(content.size());
    if (held_ == total) {
      is_restored_ = true;
      status_ = vbar_gnc_restore == nullptr ? static_cast<std::int32_t>(Status::kWrongType)
                                            : vbar_gnc_restore(state, bytes_.data(), total);
    }
  }
  fsw::packets::write_big_endian(held_, payload, 0);
  fsw::packets::write_big_endian(static_cast<std::uint32_t>(status_), payload, 4);
  return kSnapshotHeldBytes;
}

}  // namespace vbar::boards
