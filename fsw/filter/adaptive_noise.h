#pragma once
// Process noise of the acceleration, adapted to the innovations of the filter.
//
// The innovations of an optimal filter are white (Mehra 1970). Too little process noise makes the filter lag, and
// neighbouring innovations then have the same sign; measurement noise larger than assumed leaves them white. Therefore
// the correlation of neighbours decides, over windows without burns or gaps, and the result stays within bounds.
//
// Matching the covariance of the filter's corrections to process noise (Stacey and D'Amico 2021) is inconclusive here:
// in a minute the noise moves the target by micrometres, and one bearing is accurate to metres.

#include "fsw/core/types.h"

namespace vbar::fsw::filter {

struct AdaptiveNoiseSettings {
  double psd = 1e-14;  ///< m^2/s^3, initial value
  double psd_min = 1e-15;
  double psd_max = 1e-11;

  bool operator==(const AdaptiveNoiseSettings&) const = default;
};

class AdaptiveNoise {
 public:
  explicit AdaptiveNoise(const AdaptiveNoiseSettings& settings = {}) : settings_(settings), psd_(settings.psd) {}

  /// m^2/s^3, of the relative acceleration, per axis.
  [[nodiscard]] double psd() const { return psd_; }

  /// What makes neighbouring innovations alike, if they are.
  enum class Correlation : unsigned char {
    kOfLag,     ///< a filter that lags
    kOfEither,  ///< or errors of the measurements that are themselves correlated: no reason for more noise
    /// either again; but a lag that matters makes innovations exceed their standard deviations too, while correlated
    /// errors of the expected size do not
    kOfEitherBySize
  };
  /// Adds two innovations, each normalised by its standard deviation. After every kWindow pairs of neighbours the noise
  /// may change.
  void add(const Vector2& normalised, Correlation correlation = Correlation::kOfLag);

  /// A burn or a gap: the next innovation has no neighbour, and the window restarts.
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

}  // namespace vbar::fsw::filter
