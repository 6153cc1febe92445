#pragma once
// Dormand and Prince's Runge-Kutta method of order 5(4) with Hairer's step-size control and dense output.
// Sources: Dormand and Prince, J. Comp. Appl. Math. 6 (1980) 19; Hairer, Norsett, Wanner, Solving Ordinary Differential
// Equations I (1993), sections II.4 to II.6, and their program DOPRI5, whose step sequence this one reproduces.
//
// The step sequence depends on the start, the tolerances and the limits given to step() only: looking at the solution
// between steps (dense output) does not change it.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>

#include "host_sim/truth/integration/event_location.h"

namespace vbar::truth {

/// Cost of an integration so far.
struct IntegrationStatistics {
  std::int64_t accepted_steps = 0;
  std::int64_t rejected_steps = 0;
  std::int64_t evaluations = 0;  ///< number of evaluations of the right-hand side
};

/// One accepted step's continuous solution: a polynomial of order 4 in time, once continuously differentiable across
/// steps.
template <int N>
struct DenseStep {
  using State = Eigen::Matrix<double, N, 1>;

  double start = 0.0;  ///< time at which the step began
  double size = 0.0;   ///< its length, negative if time runs backwards
  State c[5];          ///< Hairer et al., eq. II.6.13 ff.

  /// Returns the solution at `time`; meant for times within the step.
  State operator()(double time) const {
    const double s = (time - start) / size;
    const double r = 1.0 - s;
    return c[0] + s * (c[1] + r * (c[2] + s * (c[3] + r * c[4])));
  }
};

/// Integrates y' = rhs(t, y) for N components. Rhs: Eigen::Matrix<double, N, 1> rhs(double, const Eigen::Matrix<double,
/// N, 1>&).
template <int N, class Rhs>
class Dopri5 {
 public:
  using State = Eigen::Matrix<double, N, 1>;

  /// Local error of component i held below absolute[i] + relative[i] |y[i]|, in the root mean square over components.
  struct Tolerance {
    State relative;
    State absolute;
  };

  /// Throws std::invalid_argument for a tolerance that is negative, not finite or below what doubles can hold.
  Dopri5(Rhs rhs, const Tolerance& tolerance) : rhs_(std::move(rhs)), tolerance_(tolerance) {
    for (int i = 0; i < N; ++i) {
      const double relative = tolerance.relative[i], absolute = tolerance.absolute[i];
      // Ten units in the last place, as DOPRI5: below, rounding and not the method determines the step.
      const bool too_fine = absolute == 0.0 && relative < 10.0 * std::numeric_limits<double>::epsilon();
      if (!std::isfinite(relative) || !std::isfinite(absolute) || relative < 0.0 || absolute < 0.0 || too_fine) {
        throw std::invalid_argument("an integration tolerance must be finite and above what doubles can hold");
      }
    }
  }

  /// Begins at time `t` with state `y`, towards later times if `direction` > 0. Chooses the first step by itself.
  void start(double t, const State& y, double direction = 1.0) {
    time_ = t;
    state_ = y;
    direction_ = direction < 0.0 ? -1.0 : 1.0;
    rate_ = evaluate(time_, state_);
    step_ = direction_ * first_step();
    previous_error_ = kSmallestError;
    just_rejected_ = false;
  }

  /// Replaces the state at the current time, as an impulse does; the step size is kept.
  void restart(const State& y) {
    state_ = y;
    rate_ = evaluate(time_, state_);
  }

  /// Adds a constant under which the right-hand side does not change (a full revolution of an angle).
  void translate(const State& offset) { state_ += offset; }

  /// Takes one accepted step, not beyond `limit`. Throws std::runtime_error if no step, however small, meets the
  /// tolerance.
  void step(double limit) {
    while (true) {
      // A step that would leave less than a hundredth of itself is stretched or cut to end at the limit.
      double h = step_;
      const bool last = direction_ * (time_ + 1.01 * h - limit) > 0.0;
      if (last) h = limit - time_;
      if (0.1 * std::abs(h) <= std::abs(time_) * std::numeric_limits<double>::epsilon()) {
        throw std::runtime_error("the integration cannot go on: the step it needs is below the resolution of time");
      }
      const Stages stages = try_step(h);
      const double error = error_norm(h, stages);
      const double fac11 = std::pow(error, kExponent);
      if (error <= 1.0) {
        accept(last ? limit : time_ + h, h, stages);
        double shrink = fac11 / std::pow(previous_error_, kBeta);
        shrink = std::clamp(shrink / kSafety, 1.0 / kLargestGrowth, kLargestShrink);
        double next = h / shrink;
        if (just_rejected_) next = direction_ * std::min(std::abs(next), std::abs(h));
        // A step shortened by the limit is not used to choose the next one: the size chosen before is kept.
        if (std::abs(h) < std::abs(step_) && std::abs(next) < std::abs(step_)) next = step_;
        previous_error_ = std::max(error, kSmallestError);
        just_rejected_ = false;
        step_ = next;
        return;
      }
      // A NaN counts as the largest error.
      step_ = h / (std::isfinite(error) ? std::min(kLargestShrink, fac11 / kSafety) : kLargestShrink);
      just_rejected_ = true;
      ++statistics_.rejected_steps;
    }
  }

  /// Takes one step of the integrator's own choice.
  void step() { step(direction_ * std::numeric_limits<double>::infinity()); }

  /// Steps until exactly `end`, which must not lie before the current time.
  void integrate_to(double end) {
    if (direction_ * (end - time_) < 0.0) throw std::invalid_argument("an integration cannot turn back");
    while (time_ != end) step(end);
  }

  /// Takes the last step again, but only up to `time` inside it: the state there is a Runge-Kutta solution, not an
  /// interpolated one.
  void cut_last_step(double time) {
    const double h = time - last_step_.start;
    if (!(direction_ * h > 0.0 && direction_ * (time_ - time) >= 0.0)) {
      throw std::invalid_argument("the time to cut at is not inside the last step");
    }
    if (time == time_) return;
    time_ = last_step_.start;
    state_ = start_state_;
    rate_ = start_rate_;
    --statistics_.accepted_steps;
    accept(time, h, try_step(h));
  }

  /// Takes one step, ended at the first sign change of g(t, y) inside it, if any: returns whether there was one. The
  /// step is searched at `samples` equal parts, and the change found to `resolution`.
  template <class EventFunction>
  bool step_to_event(const EventFunction& g, double limit, int samples, double resolution) {
    step(limit);
    const auto along_step = [&](double t) { return g(t, last_step_(t)); };
    const std::optional<double> found = first_sign_change(along_step, last_step_.start, time_, samples, resolution);
    if (found) cut_last_step(*found);
    return found.has_value();
  }

  double time() const { return time_; }
  const State& state() const { return state_; }
  const DenseStep<N>& last_step() const { return last_step_; }
  const IntegrationStatistics& statistics() const { return statistics_; }

 private:
  static constexpr double kBeta = 0.04;
  static constexpr double kExponent = 0.2 - 0.75 * kBeta;
  static constexpr double kSafety = 0.9;
  static constexpr double kLargestShrink = 5.0;
  static constexpr double kLargestGrowth = 10.0;
  static constexpr double kSmallestError = 1e-4;

  struct Stages {
    State k2, k3, k4, k5, k6, k7;
    State end;
  };

  State evaluate(double t, const State& y) {
    ++statistics_.evaluations;
    return rhs_(t, y);
  }

  Stages try_step(double h) {
    const State& y = state_;
    const State& k1 = rate_;
    Stages s;
    s.k2 = evaluate(time_ + h / 5.0, y + h * (1.0 / 5.0) * k1);
    s.k3 = evaluate(time_ + h * 0.3, y + h * (3.0 / 40.0 * k1 + 9.0 / 40.0 * s.k2));
    s.k4 = evaluate(time_ + h * 0.8, y + h * (44.0 / 45.0 * k1 - 56.0 / 15.0 * s.k2 + 32.0 / 9.0 * s.k3));
    s.k5 = evaluate(time_ + h * (8.0 / 9.0), y + h * (19372.0 / 6561.0 * k1 - 25360.0 / 2187.0 * s.k2 +
                                                      64448.0 / 6561.0 * s.k3 - 212.0 / 729.0 * s.k4));
    s.k6 = evaluate(time_ + h, y + h * (9017.0 / 3168.0 * k1 - 355.0 / 33.0 * s.k2 + 46732.0 / 5247.0 * s.k3 +
                                        49.0 / 176.0 * s.k4 - 5103.0 / 18656.0 * s.k5));
    s.end = y + h * (35.0 / 384.0 * k1 + 500.0 / 1113.0 * s.k3 + 125.0 / 192.0 * s.k4 - 2187.0 / 6784.0 * s.k5 +
                     11.0 / 84.0 * s.k6);
    s.k7 = evaluate(time_ + h, s.end);
    return s;
  }

  /// Returns the root mean square over components of error estimate over tolerance.
  double error_norm(double h, const Stages& s) const {
    const State error = h * (71.0 / 57600.0 * rate_ - 71.0 / 16695.0 * s.k3 + 71.0 / 1920.0 * s.k4 -
                             17253.0 / 339200.0 * s.k5 + 22.0 / 525.0 * s.k6 - 1.0 / 40.0 * s.k7);
    double sum = 0.0;
    for (int i = 0; i < N; ++i) {
      const double scale =
          tolerance_.absolute[i] + tolerance_.relative[i] * std::max(std::abs(state_[i]), std::abs(s.end[i]));
      sum += (error[i] / scale) * (error[i] / scale);
    }
    return std::sqrt(sum / N);
  }

  void accept(double end_time, double h, const Stages& s) {
    const State difference = s.end - state_;
    const State bspline = h * rate_ - difference;
    last_step_.start = time_;
    last_step_.size = h;
    last_step_.c[0] = state_;
    last_step_.c[1] = difference;
    last_step_.c[2] = bspline;
    last_step_.c[3] = difference - h * s.k7 - bspline;
    last_step_.c[4] = h * (-12715105075.0 / 11282082432.0 * rate_ + 87487479700.0 / 32700410799.0 * s.k3 -
                           10690763975.0 / 1880347072.0 * s.k4 + 701980252875.0 / 199316789632.0 * s.k5 -
                           1453857185.0 / 822651844.0 * s.k6 + 69997945.0 / 29380423.0 * s.k7);
    start_state_ = state_;
    start_rate_ = rate_;
    time_ = end_time;
    state_ = s.end;
    rate_ = s.k7;  // "first same as last"
    ++statistics_.accepted_steps;
  }

  /// Returns the length of the first step: Hairer et al., section II.4, "Starting Step Size".
  double first_step() {
    const auto norm = [&](const State& v) {
      double sum = 0.0;
      for (int i = 0; i < N; ++i) {
        const double scale = tolerance_.absolute[i] + tolerance_.relative[i] * std::abs(state_[i]);
        sum += (v[i] / scale) * (v[i] / scale);
      }
      return std::sqrt(sum);
    };
    const double d0 = norm(state_), d1 = norm(rate_);
    const double h0 = (d0 <= 1e-5 || d1 <= 1e-5) ? 1e-6 : 0.01 * d0 / d1;
    const State next_rate = evaluate(time_ + direction_ * h0, state_ + direction_ * h0 * rate_);
    const double d2 = norm(next_rate - rate_) / h0;
    const double largest = std::max(d1, d2);
    const double h1 = largest <= 1e-15 ? std::max(1e-6, 1e-3 * h0) : std::pow(0.01 / largest, 1.0 / 5.0);
    return std::min(100.0 * h0, h1);
  }

  Rhs rhs_;
  Tolerance tolerance_;
  double direction_ = 1.0;
  double time_ = 0.0;
  State state_ = State::Zero();
  State rate_ = State::Zero();
  State start_state_ = State::Zero();  ///< state at the start of the last step
  State start_rate_ = State::Zero();
  double step_ = 0.0;
  double previous_error_ = kSmallestError;
  bool just_rejected_ = false;
  DenseStep<N> last_step_;
  IntegrationStatistics statistics_;
};

}  // namespace vbar::truth
