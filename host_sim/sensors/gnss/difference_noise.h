#pragma once
// What two receivers' differences say of their noise: integers and geometry removed, standard deviation and temporal
// correlation of what remains.

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "fsw/gnss/differential.h"
#include "host_sim/sensors/gnss/gnss_rows.h"

namespace vbar::sensors {

/// The residual of one signal of one satellite, target minus servicer. By the fit its variance is `redundancy` times
/// that of the noise of the difference.
struct Residual {
  double value_m = 0.0;
  double redundancy = 0.0;
};
struct SignalResidual {
  fsw::gnss::SatelliteId satellite;
  fsw::gnss::Signal signal = fsw::gnss::Signal::kGpsL1;
  Residual phase, code;
  double phase_sigma_m = 0.0,
         code_sigma_m = 0.0;  ///< standard deviations of the difference, as the receivers state them
  double lock_s = 0.0;        ///< shorter of the two receivers'
};

struct ResidualEpoch {
  fsw::GpsTime time;
  std::vector<SignalResidual> residuals;
  std::array<std::size_t, fsw::gnss::kSignals> excluded{};
  fsw::Vector3 baseline_correction_m = fsw::Vector3::Zero();  ///< estimated less given
};

/// Returns the residuals of one epoch. Phases less geometry are integers, the offset of their signal (receiver clocks,
/// the reference), and a small error of the baseline, which are estimated by least squares; code takes the same
/// baseline. `servicer_eci`: antenna, to some metres; `baseline_eci`: between the antennas at the receivers' own
/// instants, to a centimetre or two. The result is empty if there are too few phases.
[[nodiscard]] std::optional<ResidualEpoch> residuals_of(const fsw::gnss::DifferentialEpoch& differences,
                                                        const fsw::Vector3& servicer_eci,
                                                        const fsw::Vector3& baseline_eci);

class DifferenceNoise {
 public:
  /// Adds an epoch; epochs come in order of time.
  void add(const ResidualEpoch& epoch);

  /// Returns one row for each signal that was measured.
  [[nodiscard]] std::vector<SignalNoiseRow> rows() const;

 private:
  static constexpr std::array<fsw::Duration, 2> kLags{fsw::duration_of_seconds(10), fsw::duration_of_seconds(60)};

  /// Sums over pairs of residuals of one satellite, with a lag between them, in settled lock.
  struct Lagged {
    std::size_t pairs = 0;
    double products = 0.0, squares = 0.0;  ///< squares: mean of both
    [[nodiscard]] std::optional<double> correlation() const;
  };
  struct Sums {
    double squares = 0.0, redundancy = 0.0, stated_squares = 0.0;
    std::array<Lagged, kLags.size()> lagged{};
    void add(const Residual& residual, double stated_sigma_m);
    void add(std::size_t lag, const Residual& earlier, const Residual& later);
    [[nodiscard]] double variance() const { return squares / redundancy; }
  };
  struct SignalSums {
    std::size_t measurements = 0, excluded = 0;
    Sums phase, code;
  };

  void add_wander(const Sums& phase, SignalNoiseRow& row) const;

  std::deque<ResidualEpoch> recent_;
  std::array<SignalSums, fsw::gnss::kSignals> signals_{};
};

/// Returns the name of a signal: "GPS L1".
[[nodiscard]] const char* name_of(fsw::gnss::Signal signal);

}  // namespace vbar::sensors
