#pragma once
// Noise of a receiver's code and carrier by elevation, from its observations of two frequencies alone: combinations
// without geometry, clocks and ionosphere. Recorded observations and those of the twin are measured alike.

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "fsw/gnss/observation.h"

namespace vbar::flown_gnss {

/// Standard deviation in a bin of elevation.
struct ElevationBin {
  std::size_t count = 0;
  double squares = 0.0;
  void add(double value) {
    ++count;
    squares += value * value;
  }
  [[nodiscard]] double sigma() const;
};

/// Bins of 10 deg from -20 to 90 deg.
inline constexpr int kFirstElevation_deg = -20, kBinWidth_deg = 10;
inline constexpr std::size_t kElevationBins = 11;
using ElevationBins = std::array<ElevationBin, kElevationBins>;

/// Returns the bin of an elevation, rad.
[[nodiscard]] std::size_t bin_of(double elevation);
/// Returns all bins in one.
[[nodiscard]] ElevationBin sum_of(const ElevationBins& bins);

/// Autocorrelation of a quantity within arcs.
struct Correlation {
  static constexpr std::size_t kLags = 61;
  std::array<double, kLags> products{};
  std::array<std::size_t, kLags> pairs{};
  void add(std::size_t lag, double product) {
    products[lag] += product;
    ++pairs[lag];
  }
  [[nodiscard]] double at(std::size_t lag) const;
  /// Lag at which it falls below 1/e, in epochs, interpolated; none within kLags.
  [[nodiscard]] std::optional<double> time() const;
  /// The same of what is not white noise: lag, counted from 1 on, within which the correlation falls to 1/e of that at
  /// 1. A first-order Gauss-Markov process with white noise beside it has that of the process.
  [[nodiscard]] std::optional<double> time_beside_white() const;
};

/// A quantity of each satellite: its noise by elevation and its correlation in time.
struct SignalNoise {
  /// Elevation, rad, above which the white noise of a receiver hides less of what is correlated: 30 deg.
  static constexpr double kHighElevation = std::numbers::pi / 6.0;
  ElevationBins bins;
  Correlation correlation;
  Correlation high_correlation;  ///< of values above kHighElevation
};

class SignalStatistics {
 public:
  /// `interval_s`: of the epochs; a longer step, by half, ends an arc.
  explicit SignalStatistics(double interval_s) : interval_s_(interval_s) {}

  /// Adds an epoch; `elevation` of a satellite in rad.
  void add(const fsw::gnss::ObservationEpoch& epoch, const std::function<double(fsw::gnss::SatelliteId)>& elevation);
  /// Ends all arcs.
  void finish();

  /// Code less carrier of both frequencies, without ionosphere and the mean of the arc: noise and multipath of code
  /// (Estey, Meertens 1999: MP1, MP2). m.
  [[nodiscard]] const SignalNoise& code_l1() const { return code_l1_; }
  [[nodiscard]] const SignalNoise& code_l2() const { return code_l2_; }
  /// Third differences in time of L1 less L2 carrier over sqrt(20): the white noise of both, m, where the ionosphere is
  /// smooth over 30 s.
  [[nodiscard]] const ElevationBins& carrier() const { return carrier_; }
  [[nodiscard]] double interval_s() const { return interval_s_; }
  /// Number of times that L1 less L2 carrier steps by more than 5 cm though both report continuous lock: cycle slips,
  /// or an ionosphere that is not smooth.
  [[nodiscard]] std::size_t steps() const { return steps_; }
  /// Arcs, and hours of satellites in them.
  [[nodiscard]] std::size_t arcs() const { return arcs_; }
  [[nodiscard]] double satellite_hours() const { return satellite_hours_; }

 private:
  struct Sample {
    double elevation = 0.0, code_l1_m = 0.0, code_l2_m = 0.0, geometry_free_m = 0.0;
  };
  struct Arc {
    fsw::GpsTime last;
    double lock_l1_s = 0.0, lock_l2_s = 0.0;
    std::vector<Sample> samples;
  };
  void finish(Arc& arc);

  double interval_s_;
  std::map<fsw::gnss::SatelliteId, Arc> open_;
  SignalNoise code_l1_, code_l2_;
  ElevationBins carrier_{};
  std::size_t steps_ = 0, arcs_ = 0;
  double satellite_hours_ = 0.0;
};

}  // namespace vbar::flown_gnss
