#include "tests/unit/host_sim/truth/swarm/orbit_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <Eigen/QR>

#include "tests/support/figures.h"

namespace vbar::truth::test {
namespace {

/// Steps of the differences: 10 m, 1 cm/s, a tenth of drag. Small enough for the orbit to answer linearly (1e-5 of it),
/// large beside the propagation's error of some micrometres.
constexpr double kSteps[7] = {10.0, 10.0, 10.0, 0.01, 0.01, 0.01, 0.1};

Eigen::VectorXd stacked_difference(const Positions& a, const Positions& b) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(3 * a.size()));
  for (std::size_t i = 0; i < a.size(); ++i) result.segment<3>(static_cast<Eigen::Index>(3 * i)) = a[i] - b[i];
  return result;
}

}  // namespace

Distances distances(const Positions& a, const Positions& b) {
  double sum = 0.0;
  accuracy::Largest largest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = (a[i] - b[i]).norm();
    sum += distance * distance;
    largest.add(distance);
  }
  return {std::sqrt(sum / static_cast<double>(a.size())), largest};
}

OrbitStart OrbitFit::displaced(const OrbitStart& start, const Parameters& by) {
  OrbitStart result = start;
  for (int i = 0; i < 3; ++i) {
    result.state.position_eci[i] += by[i] * kSteps[i];
    result.state.velocity_eci[i] += by[i + 3] * kSteps[i + 3];
  }
  result.drag_scale += by[6] * kSteps[6];
  return result;
}

OrbitFit::OrbitFit(const Propagate& propagate, const OrbitStart& first, Positions measured)
    : measured_(std::move(measured)), derivatives_(static_cast<Eigen::Index>(3 * measured_.size()), kParameters) {
  for (int i = 0; i < kParameters; ++i) {
    const Parameters half = 0.5 * Parameters::Unit(i);
    derivatives_.col(i) = stacked_difference(propagate(displaced(first, half)), propagate(displaced(first, -half)));
  }
}

OrbitStart OrbitFit::fit(const Propagate& propagate, const OrbitStart& first, bool fits_drag) const {
  const int parameters = fits_drag ? kParameters : kParameters - 1;
  const auto decomposition = derivatives_.leftCols(parameters).colPivHouseholderQr();
  OrbitStart start = first;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Parameters by = Parameters::Zero();
    by.head(parameters) = decomposition.solve(stacked_difference(measured_, propagate(start)));
    start = displaced(start, by);
    // A thousandth of a step moves no position by more than a centimetre or two; the next iteration would gain three
    // digits on that.
    if (accuracy::largest_entry(by) < 1e-4) return start;
  }
  throw std::runtime_error("the fit of the orbit did not converge");
}

}  // namespace vbar::truth::test
