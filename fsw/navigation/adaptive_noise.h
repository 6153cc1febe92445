#pragma once
// How much acceleration the filter admits not to know, judged by its own innovations.
//
// Those of an optimal filter are white (Mehra 1970). Too little process noise makes the filter lag behind, and
// neighbouring innovations then share their sign; a camera noisier than said leaves them white. So what decides is the
// correlation of neighbours, over windows that no burn and no gap interrupts, and the answer stays within bounds.
//
// Matching the covariance of the filter's corrections to process noise (Stacey and D'Amico 2021) tells nothing here: in
// a minute the noise moves the target by micrometres, and one bearing is good to metres.

#include "fsw/core/types.h"

namespace vbar::fsw::navigation {

struct AdaptiveNoiseSettings {
  double psd = 1e-14;  ///< m^2/s^3, where it starts
  double psd_least = 1e-15;
  double psd_most = 1e-11;
};

class AdaptiveNoise {
 public:
  explicit AdaptiveNoise(const AdaptiveNoiseSettings& settings = {}) : settings_(settings), psd_(settings.psd) {}

  /// m^2/s^3, of the relative acceleration, each axis.
  [[nodiscard]] double psd() const { return psd_; }

  /// Two innovations, each over its expected standard deviation. After every kWindow pairs of neighbours the noise may
  /// change.
  void take(const Vector2& normalised);

  /// A burn or a gap: what comes next has no neighbour, and the window begins anew.
  void interrupt();

  static constexpr int kWindow = 30;

 private:
  AdaptiveNoiseSettings settings_;
  double psd_ = 0.0;
  bool has_last_ = false;
  Vector2 last_ = Vector2::Zero();
  int pairs_ = 0;
  double products_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace vbar::fsw::navigation
