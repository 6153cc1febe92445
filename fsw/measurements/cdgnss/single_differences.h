#pragma once
// Measurement model of single differences of code and phase, target minus servicer:
//
//   range difference + clock difference + antennas and their jitter (+ code bias | + ambiguity + wander)
//
// The position of the target at reception depends on the ROE alone; its 3x6 Jacobian and its nonlinearity are computed
// once an epoch, and each observation then costs one product with its line of sight. All other states enter linearly.
// The Jacobian is that of central differences of 7 m: a regression by sigma points of a millimetre would lose its
// digits in positions of seven thousand kilometres (1e-9 m of 1e-3 m). Where the orbit is uncertain by more than some
// 35 m, curvature exceeds a tenth of the phase noise, and the regression by sigma points replaces the differences.

#include <array>
#include <cstddef>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/gnss/differential.h"
#include "fsw/gnss/observation.h"
#include "fsw/measurements/state_blocks/cdgnss_blocks.h"

namespace vbar::fsw::measurements {

// Assignment of the filter's ambiguities to signals and satellites, and whether each carrier was tracked without
// a break. A channel is assigned at first sight, kept through short gaps, and released after long ones.

inline constexpr std::size_t kPhaseChannels = kPhaseChannelCount;

struct PhaseChannel {
  bool in_use = false;
  gnss::SatelliteId satellite;
  gnss::Signal signal = gnss::Signal::kGpsL1;
  GpsTime first_seen;  ///< of the present track: its ambiguity was determined from then on
  GpsTime last_seen;
  double servicer_lock_s = 0.0;
  double target_lock_s = 0.0;
  int epochs = 0;      ///< tracked without a break
  bool fixed = false;  ///< its differences to the other fixed ones of its signal are integers, held by the filter
};

class PhaseChannels {
 public:
  /// Indices of the channels whose signal has not been seen for kKeptUnseen in epochs until `last`: released, to be
  /// deactivated by the caller. Calls `given_back(place)` for each. An outage of all signals, as of the crosslink, ends
  /// no ambiguity: the lock times of its end decide.
  template <class Visitor>
  void give_back_unseen(GpsTime last, Visitor&& given_back) {
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (channels_[k].in_use && last - channels_[k].last_seen > kKeptUnseen) {
        channels_[k] = PhaseChannel{};
        given_back(k);
      }
    }
  }

  [[nodiscard]] std::optional<std::size_t> find(gnss::SatelliteId satellite, gnss::Signal signal) const;

  /// A free channel for the signal, not yet tracked; no value when all are assigned.
  std::optional<std::size_t> take(gnss::SatelliteId satellite, gnss::Signal signal);

  /// Whether the receiver's lock time shows a loss of lock since the channel was last seen.
  [[nodiscard]] bool lost_lock(std::size_t place, const gnss::DifferentialObservation& observation, GpsTime now) const;

  /// The carrier was tracked, or its tracking restarts.
  void see(std::size_t place, const gnss::DifferentialObservation& observation, GpsTime now);
  void restart(std::size_t place);

  [[nodiscard]] const PhaseChannel& operator[](std::size_t place) const { return channels_[place]; }
  void set_fixed(std::size_t place, bool fixed) { channels_[place].fixed = fixed; }
  void clear() { channels_ = {}; }
  [[nodiscard]] bool is_any_tracked() const {
    for (const PhaseChannel& channel : channels_) {
      if (channel.epochs > 0) return true;
    }
    return false;
  }

  static constexpr Duration kKeptUnseen = duration_of_seconds(120);

 private:
  std::array<PhaseChannel, kPhaseChannels> channels_{};
};

/// A-priori knowledge of one receiver at an epoch.
struct AntennaPlatform {
  Matrix3 R_eci_body = Matrix3::Identity();
  Vector3 antenna_body_m = Vector3::Zero();  ///< nominal phase centre, from the centre of mass
  double clock_m = 0.0;                      ///< c times the receiver clock's advance
};

/// Position of the centre of mass when signals arrived: the tag is that of the receiver's own clock.
[[nodiscard]] Vector3 position_at_reception(const orbit::CartesianState& at_tag, double clock_m);

/// The target's position at reception as a function of the ROE.
struct ReceptionMap {
  Vector3 position_eci = Vector3::Zero();  ///< m, mean
  Eigen::Matrix<double, 3, 6> jacobian;    ///< m, of the dimensionless ROE
  Matrix3 nonlinearity = Matrix3::Zero();  ///< m^2
  Matrix3 covariance = Matrix3::Zero();    ///< m^2, by the Jacobian
};

/// kSingular or kOutOfRange if an orbit or the covariance is invalid.
[[nodiscard]] Result<ReceptionMap> reception_map(const orbit::CartesianState& servicer, const Vector6& roe,
                                                 const Matrix6& covariance, double target_clock_m);

class DifferenceRows {
 public:
  using Sensitivity = filter::Estimate::Vector;

  /// Forms the model of all observations about the present mean of the estimate; the filter stands at the tag.
  Status form(const gnss::DifferentialEpoch& epoch, const AntennaPlatform& servicer, const AntennaPlatform& target,
              const filter::RelativeNavigationFilter& filter);

  /// Measured minus predicted by the estimate, m; of a code with its bias, of a phase with ambiguity and wander of
  /// `channel`, of either without these and without the ionosphere.
  [[nodiscard]] double code_residual(std::size_t n, const gnss::DifferentialObservation& observation,
                                     const filter::Estimate& estimate) const;
  [[nodiscard]] double residual(std::size_t n, double measured_m, const filter::Estimate& estimate) const;
  [[nodiscard]] double phase_residual(std::size_t n, std::size_t channel,
                                      const gnss::DifferentialObservation& observation,
                                      const filter::Estimate& estimate) const;

  [[nodiscard]] Sensitivity code_sensitivity(std::size_t n, gnss::Signal signal) const;
  [[nodiscard]] Sensitivity phase_sensitivity(std::size_t n, std::size_t channel, gnss::Signal signal) const;
  /// Change of a range by a displacement of the target, in ECI: the unit vector along the line of sight.
  [[nodiscard]] const Vector3& direction(std::size_t n) const { return rows_[n].jitter; }
  /// Variance due to the nonlinearity, m^2.
  [[nodiscard]] double extra_variance(std::size_t n) const { return rows_[n].extra_variance; }
  /// Distance between the phase centres, m.
  [[nodiscard]] double baseline_m() const { return baseline_m_; }
  /// 1 sigma of the target's position due to the nonlinearity of its elements, m; zero of a narrow orbit.
  [[nodiscard]] double nonlinearity_m() const { return nonlinearity_m_; }

 private:
  struct Row {
    Vector6 roe = Vector6::Zero();
    Vector3 servicer_antenna = Vector3::Zero();
    Vector3 target_antenna = Vector3::Zero();
    Vector3 jitter = Vector3::Zero();
    Vector3 group_delay = Vector3::Zero();  ///< of L1, of the states of the ionosphere
    double predicted = 0.0;
    double extra_variance = 0.0;
  };
  /// The linearisation point.
  struct Reference {
    Vector6 roe = Vector6::Zero();
    Vector3 servicer_antenna = Vector3::Zero();
    Vector3 target_antenna = Vector3::Zero();
    Vector3 jitter = Vector3::Zero();
    double clock = 0.0;
  };

  [[nodiscard]] Sensitivity range_sensitivity(std::size_t n) const;
  [[nodiscard]] Vector3 group_delay(std::size_t n, gnss::Signal signal) const;

  std::array<Row, gnss::kMaxObservations> rows_{};
  Reference reference_;
  double nonlinearity_m_ = 0.0;
  double baseline_m_ = 0.0;
};

}  // namespace vbar::fsw::measurements
