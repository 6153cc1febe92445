#pragma once
// Persistence of a detection, the counter that all faults use.

#include <cstdint>

namespace vbar::fsw::faults {

/// Counts detections. A detection is persistent once `limit` of the last `window` checks detect it, until none of them
/// does.
class Persistence {
 public:
  static constexpr int kMaxWindow = 64;

  /// Requires 1 <= limit <= window <= kMaxWindow.
  constexpr Persistence(int limit, int window) : limit_(limit), window_(window) {}

  /// Records a check. Returns whether the detection is persistent after it.
  constexpr bool add(bool is_detected) {
    const std::uint64_t mask = window_ == kMaxWindow ? ~std::uint64_t{0} : (std::uint64_t{1} << window_) - 1;
    history_ = ((history_ << 1U) | (is_detected ? 1U : 0U)) & mask;
    if (detections() >= limit_) is_persistent_ = true;
    if (history_ == 0) is_persistent_ = false;
    return is_persistent_;
  }
  [[nodiscard]] constexpr bool is_persistent() const { return is_persistent_; }
  constexpr void reset() {
    history_ = 0;
    is_persistent_ = false;
  }

 private:
  /// Returns the number of detections within the window.
  [[nodiscard]] constexpr int detections() const {
    int count = 0;
    for (int k = 0; k < window_; ++k) count += static_cast<int>((history_ >> static_cast<unsigned>(k)) & 1U);
    return count;
  }

  std::uint64_t history_ = 0;  ///< checks in the window, the latest in the lowest bit
  int limit_;
  int window_;
  bool is_persistent_ = false;
};

}  // namespace vbar::fsw::faults
