#pragma once
// State block of ranges.

namespace vbar::fsw::measurements {

/// Bias of a range finder, a constant, m.
struct RangeBias {
  static constexpr int kSize = 1;
};

}  // namespace vbar::fsw::measurements
