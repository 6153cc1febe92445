#pragma once
// Protection of the estimate against changes that no step has made (single-event upsets): a checksum and a copy.
//
// Between two steps the trunk is at rest for most of the time. Its checksum at the end of a step must therefore be that
// at the beginning of the next one; if it is not, the copy of the same instant takes its place, and nothing is lost.

#include <cstdint>

#include "fsw/trunk/trunk.h"

namespace vbar::fsw::gnc {

enum class Integrity : std::uint8_t {
  kIntact,
  kCopyDamaged,  ///< the estimate is intact
  kRestored,     ///< the estimate was damaged and is that of the copy
  kLost,         ///< both were damaged: nothing is known any more
};

class StateIntegrity {
 public:
  /// At the end of a step.
  void seal(const filter::RelativeNavigationFilter& trunk);

  /// At the beginning of the next one; kIntact before the first seal().
  [[nodiscard]] Integrity verify(filter::RelativeNavigationFilter& trunk) const;

 private:
  filter::RelativeNavigationFilter copy_;
  std::uint64_t checksum_ = 0;  ///< of both
  bool is_sealed_ = false;
};

}  // namespace vbar::fsw::gnc
