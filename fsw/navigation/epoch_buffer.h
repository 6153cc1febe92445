#pragma once
// The epochs of one receiver that wait for those of the other, in order of their tags irrespective of their arrival.

#include <array>
#include <cstddef>

#include "fsw/core/result.h"
#include "fsw/gnss/observation.h"

namespace vbar::fsw::navigation {

class EpochBuffer {
 public:
  static constexpr std::size_t kEpochs = 24;

  /// Files an epoch. kBadSequence: the tag exists already. When full, the oldest is dropped in favour of the newest.
  Status file(const gnss::ObservationEpoch& epoch) {
    if (find(epoch.receiver_time) != nullptr) return Status::kBadSequence;
    if (count_ == kEpochs) {
      if (epoch.receiver_time < oldest()->receiver_time) return Status::kFull;
      drop_through(oldest()->receiver_time);
    }
    std::size_t place = count_++;
    while (place > 0 && epoch.receiver_time < at(place - 1).receiver_time) {
      order_[place] = order_[place - 1];
      --place;
    }
    order_[place] = free_slot();
    epochs_[order_[place]] = epoch;
    used_[order_[place]] = true;
    return Status::kOk;
  }

  [[nodiscard]] const gnss::ObservationEpoch* oldest() const { return count_ == 0 ? nullptr : &at(0); }
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Keeps an epoch, in order of tags.
  [[nodiscard]] const gnss::ObservationEpoch& operator[](std::size_t k) const { return at(k); }
  [[nodiscard]] const gnss::ObservationEpoch* find(GpsTime tag) const {
    for (std::size_t k = 0; k < count_; ++k) {
      if (at(k).receiver_time == tag) return &at(k);
    }
    return nullptr;
  }

  /// Discards all epochs tagged at or before `tag`.
  void drop_through(GpsTime tag) {
    std::size_t dropped = 0;
    while (dropped < count_ && at(dropped).receiver_time <= tag) used_[order_[dropped++]] = false;
    for (std::size_t k = dropped; k < count_; ++k) order_[k - dropped] = order_[k];
    count_ -= dropped;
  }

 private:
  [[nodiscard]] const gnss::ObservationEpoch& at(std::size_t k) const { return epochs_[order_[k]]; }
  [[nodiscard]] std::size_t free_slot() const {
    std::size_t slot = 0;
    while (slot + 1 < kEpochs && used_[slot]) ++slot;
    return slot;
  }

  std::array<gnss::ObservationEpoch, kEpochs> epochs_{};
  std::array<std::size_t, kEpochs> order_{};  ///< slots in order of tags
  std::array<bool, kEpochs> used_{};
  std::size_t count_ = 0;
};

}  // namespace vbar::fsw::navigation
