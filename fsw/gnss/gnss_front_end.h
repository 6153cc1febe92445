#pragma once
// From the bytes of the receivers to observation epochs, in order of their tags, and broadcast ephemerides: shared by
// the sources that use them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fsw/core/result.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/receiver_decoder.h"

namespace vbar::fsw::gnss {

// The epochs of one receiver that wait for those of the other, in order of their tags irrespective of their arrival.

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

class GnssFrontEnd {
 public:
  /// When a receiver was heard.
  struct Heard {
    GpsTime newest;        ///< tag of its newest epoch
    Duration interval{0};  ///< from the epoch before it; 0 of the first
  };
  /// Decodes the packets of the step. An epoch tagged before `oldest`, or twice, is counted as too late.
  void decode(messaging::Inbox& inbox, GpsTime oldest);

  [[nodiscard]] const gnss::EphemerisStore& ephemerides() const { return ephemerides_; }
  [[nodiscard]] const gnss::EpochBuffer& waiting(Receiver receiver) const {
    return waiting_[static_cast<std::size_t>(receiver)];
  }
  /// An epoch of a receiver was received.
  void hear(Receiver receiver, GpsTime tag);
  /// Empty before the first epoch of the receiver.
  [[nodiscard]] const std::optional<Heard>& heard(Receiver receiver) const {
    return heard_[static_cast<std::size_t>(receiver)];
  }
  /// Epochs of both receivers tagged before `time` are no longer needed.
  void drop_before(GpsTime time) {
    for (gnss::EpochBuffer& buffer : waiting_) buffer.drop_through(time - Duration{1});
  }

  /// Clock of the servicer's receiver (c times its advance, m) by the single-point solution of an epoch.
  void keep_servicer_clock(GpsTime tag, double clock_m) { servicer_clock_ = {tag, clock_m}; }
  /// No value if the epoch of that tag had no solution.
  [[nodiscard]] std::optional<double> servicer_clock_m(GpsTime tag) const {
    return servicer_clock_.tag == tag ? std::optional(servicer_clock_.clock_m) : std::nullopt;
  }
  [[nodiscard]] std::int32_t too_late() const { return too_late_; }
  /// Complete messages of both receivers, and those refused because of checksum or contents.
  [[nodiscard]] std::int32_t messages() const { return decoders_.messages(); }
  [[nodiscard]] std::int32_t messages_refused() const { return decoders_.refused(); }

 private:
  struct ServicerClock {
    GpsTime tag{-1};
    double clock_m = 0.0;
  };

  ReceiverDecoders decoders_;
  gnss::EphemerisStore ephemerides_;
  std::array<gnss::EpochBuffer, 2> waiting_{};
  std::array<std::optional<Heard>, 2> heard_{};
  ServicerClock servicer_clock_;
  std::int32_t too_late_ = 0;
};

}  // namespace vbar::fsw::gnss
