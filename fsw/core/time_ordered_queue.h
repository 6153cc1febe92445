#pragma once
// A bounded queue of entries with a time tag, kept in an order that does not depend on the order of arrival.

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"

namespace vbar::fsw {

/// Sort key of entries: time first, then the unit and sequence count of the sender, so that entries of the same instant
/// are ordered alike irrespective of their arrival.
struct FilingTag {
  GpsTime time;
  std::uint32_t unit = 0;
  std::uint32_t sequence_count = 0;
  constexpr auto operator<=>(const FilingTag&) const = default;
};
// Without padding, which a copy may take from the stack into a snapshot.
static_assert(std::has_unique_object_representations_v<FilingTag>);

/// Holds up to `kCapacity` entries in order of their tags. If it is full the newest arrival is rejected; nothing is
/// overwritten.
template <class T, std::size_t kCapacity>
class TimeOrderedQueue {
 public:
  struct Entry {
    FilingTag tag;
    T value{};
  };

  /// Files an entry. kBadSequence: an entry with the same tag exists already (a duplicate); kFull.
  [[nodiscard]] Status file(const FilingTag& tag, const T& value) {
    std::size_t place = size_;
    while (place > 0 && tag < entries_[place - 1].tag) --place;
    if (place > 0 && entries_[place - 1].tag == tag) return Status::kBadSequence;
    if (size_ == kCapacity) return Status::kFull;
    for (std::size_t k = size_; k > place; --k) entries_[k] = entries_[k - 1];
    entries_[place] = {tag, value};
    ++size_;
    return Status::kOk;
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const Entry& operator[](std::size_t k) const { return entries_[k]; }

  void clear() { size_ = 0; }

 private:
  std::array<Entry, kCapacity> entries_{};
  std::size_t size_ = 0;
};

}  // namespace vbar::fsw
