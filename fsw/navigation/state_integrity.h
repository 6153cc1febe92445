#pragma once
// Protection of the estimate against changes that no step has made (single-event upsets): a checksum and a copy.
//
// Between two steps the relative navigation filter does not change. Its checksum at the end of a step must therefore be
// that at the beginning of the next one. Otherwise the copy of the same instant replaces it, without any loss.

#include <cstdint>

#include "fsw/filter/relative_navigation_filter.h"

namespace vbar::fsw::navigation {

enum class Integrity : std::uint8_t {
  kIntact,
  kCopyDamaged,  ///< the estimate is intact
  kRestored,     ///< the estimate was damaged and is that of the copy
  kLost,         ///< both were damaged: navigation restarts
};

class StateIntegrity {
 public:
  /// Takes checksum and copy at the end of a step.
  void seal(const filter::RelativeNavigationFilter& filter);

  /// Verifies and restores the filter at the beginning of the next step; kIntact before the first seal().
  [[nodiscard]] Integrity verify(filter::RelativeNavigationFilter& filter) const;

 private:
  filter::RelativeNavigationFilter copy_;
  std::uint64_t checksum_ = 0;  ///< of filter and copy
  bool is_sealed_ = false;
};

}  // namespace vbar::fsw::navigation
