#include "host_sim/orbit_fit/batch.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/QR>
#include <fmt/format.h>

#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_fit {

namespace {

using fsw::Vector3;
using fsw::Vector6;
using fsw::orbit::CartesianState;

/// Longest step of the quadrature: 4e-4 of a once-per-revolution term in a low orbit.
constexpr double kLongestStep_s = 60.0;

std::vector<double> nodes_of(const Arc& arc) {
  std::vector<double> nodes{arc.seconds.front()};
  for (std::size_t k = 1; k < arc.seconds.size(); ++k) {
    const double from = arc.seconds[k - 1], width = arc.seconds[k] - from;
    const double steps = std::ceil(width / kLongestStep_s);
    for (double step = 1.0; step < steps; ++step) nodes.push_back(from + width * step / steps);
    nodes.push_back(arc.seconds[k]);
  }
  return nodes;
}

/// Both ascend, and all of `times` are among the nodes.
std::vector<std::size_t> places_of(const std::vector<double>& times, const std::vector<double>& nodes) {
  std::vector<std::size_t> places;
  std::size_t node = 0;
  for (const double time : times) {
    while (nodes[node] < time) ++node;
    places.push_back(node);
  }
  return places;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Marks positions farther off than eight times the median distance (which is 1.54 sigma of Gaussian components: 12
/// sigma), as gross errors are; systematic residuals of a force model reach three times it.
std::vector<bool> near_positions(const std::vector<Vector3>& residuals) {
  constexpr double kEdit = 8.0, kFloor_m = 1e-3;
  std::vector<double> distances;
  for (const Vector3& residual : residuals) distances.push_back(residual.norm());
  const double limit = kEdit * std::max(median(distances), kFloor_m);
  std::vector<bool> used;
  for (const double distance : distances) used.push_back(distance <= limit);
  return used;
}

/// Number of successive values that count as one: 1 + 2 sum of the autocorrelations up to their first zero (Geyer's
/// initial sequence), weighted over the components by their variance.
double correlated_count(const std::vector<Vector3>& residuals) {
  double weighted = 0.0, total = 0.0;
  const auto count = residuals.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto covariance = [&](std::size_t lag) {
      double sum = 0.0;
      for (std::size_t k = lag; k < count; ++k) sum += residuals[k][axis] * residuals[k - lag][axis];
      return sum / static_cast<double>(count);
    };
    const double variance = covariance(0);
    if (variance <= 0.0) continue;
    double factor = 1.0;
    for (std::size_t lag = 1; lag < count / 4; ++lag) {
      const double correlation = covariance(lag) / variance;
      if (correlation <= 0.0) break;
      factor += 2.0 * correlation;
    }
    weighted += variance * factor;
    total += variance;
  }
  return total > 0.0 ? weighted / total : 1.0;
}

}  // namespace

/// The design of all positions, with what a step along each column changes.
struct Batch::Columns {
  Eigen::MatrixXd design;  ///< 3 rows a position, ECI
  std::vector<std::string> names;
  std::vector<double> per_si;  ///< unit of the name over SI
  std::vector<std::function<double&(OrbitParameters&)>> values;

  void add(const std::string& name, double unit, std::function<double&(OrbitParameters&)> value) {
    names.push_back(name);
    per_si.push_back(unit);
    values.push_back(std::move(value));
    design.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(names.size()));
  }

  /// The last column at one position.
  [[nodiscard]] auto last(std::size_t position) {
    return design.col(design.cols() - 1).segment<3>(static_cast<Eigen::Index>(3 * position));
  }
};

std::vector<Vector3> residuals_rtn(const std::vector<Vector3>& measured_eci,
                                   const std::vector<CartesianState>& states) {
  std::vector<Vector3> residuals;
  residuals.reserve(measured_eci.size());
  for (std::size_t k = 0; k < measured_eci.size(); ++k)
    residuals.push_back(fsw::orbit::R_rtn_eci(states[k]) * (measured_eci[k] - states[k].position_eci));
  return residuals;
}

Batch::Batch(const FittedDynamics& dynamics, Arc arc, int threads)
    : dynamics_(dynamics),
      arc_(std::move(arc)),
      nodes_s_(nodes_of(arc_)),
      node_of_(places_of(arc_.seconds, nodes_s_)),
      transition_(dynamics.simplified(), arc_.first, nodes_s_, threads) {}

Batch::Columns Batch::columns_of(const OrbitParameters& parameters, const Estimated& estimated) const {
  Columns columns;
  columns.design.resize(static_cast<Eigen::Index>(3 * arc_.seconds.size()), 0);
  for (int k = 0; k < 6; ++k) {
    columns.add(
        fmt::format("start {} {}", k < 3 ? "position" : "velocity", "RTN"[k % 3]), k < 3 ? 1.0 : 1e3,
        [k](OrbitParameters& p) -> double& { return k < 3 ? p.start.position_eci[k] : p.start.velocity_eci[k - 3]; });
    for (std::size_t position = 0; position < node_of_.size(); ++position)
      columns.last(position) = transition_.of_position(node_of_[position]).col(k);
  }
  const std::vector<CartesianState> states = dynamics_.propagate(parameters, nodes_s_);
  add_scale_columns(parameters, estimated, states, columns);
  add_empirical_columns(parameters, states, columns);
  add_burn_columns(parameters, estimated, columns);
  return columns;
}

/// Sets the last column to the answer to an acceleration at the nodes, during one of several intervals.
template <class Value>
void Batch::set_acceleration(const std::vector<Vector3>& direction, const Intervals<Value>& intervals,
                             std::size_t place, Columns& columns) const {
  const bool is_last = place + 1 == intervals.values.size();
  const std::vector<Vector6> at_epoch = transition_.of_acceleration(
      direction, static_cast<double>(place) * intervals.length_s,
      is_last ? std::numeric_limits<double>::infinity() : static_cast<double>(place + 1) * intervals.length_s);
  for (std::size_t position = 0; position < node_of_.size(); ++position)
    columns.last(position) = transition_.of_position(node_of_[position]) * at_epoch[node_of_[position]];
}

void Batch::add_scale_columns(const OrbitParameters& parameters, const Estimated& estimated,
                              const std::vector<CartesianState>& states, Columns& columns) const {
  if (!estimated.drag_scale && !estimated.radiation_scale) return;
  OrbitParameters unscaled = parameters;
  unscaled.radiation_scale = 1.0;
  std::ranges::fill(unscaled.drag_scale.values, 1.0);
  const auto forces = dynamics_.dynamics(unscaled);
  std::vector<Vector3> drag(nodes_s_.size(), Vector3::Zero()), radiation = drag;
  for (std::size_t node = 0; node < nodes_s_.size(); ++node) {
    for (const truth::ForceAcceleration& share : forces->accelerations(nodes_s_[node], states[node])) {
      if (share.force == "drag") drag[node] = share.acceleration_eci;
      if (share.force == "radiation_pressure") radiation[node] = share.acceleration_eci;
    }
  }
  const auto& scales = parameters.drag_scale;
  for (std::size_t place = 0; estimated.drag_scale && place < scales.values.size(); ++place) {
    columns.add(scales.values.size() > 1 ? fmt::format("drag scale {}", place + 1) : "drag scale", 1.0,
                [place](OrbitParameters& p) -> double& { return p.drag_scale.values[place]; });
    set_acceleration(drag, scales, place, columns);
  }
  if (!estimated.radiation_scale) return;
  columns.add("radiation scale", 1.0, [](OrbitParameters& p) -> double& { return p.radiation_scale; });
  set_acceleration(radiation, Intervals<double>{0.0, {1.0}}, 0, columns);
}

void Batch::add_empirical_columns(const OrbitParameters& parameters, const std::vector<CartesianState>& states,
                                  Columns& columns) const {
  constexpr const char* kTerms[] = {"T", "T cos u", "T sin u", "N cos u", "N sin u"};
  const auto& terms = parameters.empirical;
  for (int term = 0; term < Empirical::kCount && !terms.values.empty(); ++term) {
    std::vector<Vector3> direction;
    for (const CartesianState& state : states) direction.emplace_back(empirical_directions(state).col(term));
    for (std::size_t place = 0; place < terms.values.size(); ++place) {
      const std::string number = terms.values.size() > 1 ? fmt::format(" {}", place + 1) : "";
      columns.add(fmt::format("empirical {}{}", kTerms[term], number), 1e9,
                  [place, term](OrbitParameters& p) -> double& { return p.empirical.values[place].amplitude[term]; });
      set_acceleration(direction, terms, place, columns);
    }
  }
}

void Batch::add_burn_columns(const OrbitParameters& parameters, const Estimated& estimated, Columns& columns) const {
  std::vector<double> times;
  for (const Burn& burn : parameters.burns) times.push_back(burn.seconds);
  if (times.empty()) return;
  times.insert(times.begin(), 0.0);
  const std::vector<CartesianState> states = dynamics_.propagate(parameters, times);
  for (std::size_t index = 0; index < parameters.burns.size(); ++index) {
    const auto at_epoch = burn_at_epoch(transition_, parameters.burns[index], states[index + 1]);
    for (int k = 0; k < 4; ++k) {
      if (k > 0 && !estimated.burn_axes[static_cast<std::size_t>(k - 1)]) continue;
      columns.add(fmt::format("burn {} {}", index + 1, k == 0 ? "time" : std::string("dv ") + "RTN"[k - 1]),
                  k == 0 ? 1.0 : 1e3, [index, k](OrbitParameters& p) -> double& {
                    Burn& burn = p.burns[index];
                    return k == 0 ? burn.seconds : burn.dv_rtn[k - 1];
                  });
      for (std::size_t position = 0; position < node_of_.size(); ++position) {
        if (arc_.seconds[position] < parameters.burns[index].seconds)
          columns.last(position).setZero();
        else
          columns.last(position) = transition_.of_position(node_of_[position]) * at_epoch.col(k);
      }
    }
  }
}

namespace {

/// The residuals of a propagation: states, residuals, what is used of them, and their sums.
void weigh(const Arc& arc, bool edits, FittedOrbit& fitted) {
  fitted.residuals_rtn = residuals_rtn(arc.positions_eci, fitted.states);
  fitted.used = edits ? near_positions(fitted.residuals_rtn) : std::vector<bool>(arc.seconds.size(), true);
  Vector3 squares = Vector3::Zero();
  double used = 0.0;
  for (std::size_t k = 0; k < arc.seconds.size(); ++k) {
    if (!fitted.used[k]) continue;
    squares += fitted.residuals_rtn[k].cwiseAbs2();
    ++used;
  }
  fitted.rms_rtn = (squares / used).cwiseSqrt();
  fitted.rms_m = std::sqrt(squares.sum() / used);
  fitted.edited = arc.seconds.size() - static_cast<std::size_t>(used);
}

/// The rows of the positions that are used.
void take_rows(const Arc& arc, const Eigen::MatrixXd& design, FittedOrbit& fitted) {
  const auto rows = static_cast<Eigen::Index>(3 * (arc.seconds.size() - fitted.edited));
  fitted.design.resize(rows, design.cols());
  fitted.remainder.resize(rows);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < arc.seconds.size(); ++k) {
    if (!fitted.used[k]) continue;
    fitted.design.middleRows<3>(row) = design.middleRows<3>(static_cast<Eigen::Index>(3 * k));
    fitted.remainder.segment<3>(row) = arc.positions_eci[k] - fitted.states[k].position_eci;
    row += 3;
  }
}

struct Solution {
  Eigen::VectorXd step;
  Eigen::MatrixXd root;  ///< root root^T is the inverse of the normal matrix
};

/// Least squares by a QR decomposition with columns of unit length. Throws std::runtime_error naming a column that the
/// rows do not determine.
Solution solve(const FittedOrbit& fitted, const std::vector<std::string>& names, double arc_s) {
  const Eigen::Index unknowns = fitted.design.cols();
  const Eigen::VectorXd norms = fitted.design.colwise().norm();
  Eigen::Index least = 0;
  if (!(norms.minCoeff(&least) > 0.0))
    throw std::runtime_error(fmt::format("the positions do not depend on \"{}\": it cannot be estimated",
                                         names[static_cast<std::size_t>(least)]));
  const Eigen::VectorXd scale = norms.cwiseInverse();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(fitted.design * scale.asDiagonal());
  constexpr double kDetermined = 1e-9;
  qr.setThreshold(kDetermined);
  if (qr.rank() < unknowns)
    throw std::runtime_error(
        fmt::format("the positions over {:.0f} s do not determine \"{}\" beside the others; accepted: a longer arc or "
                    "fewer unknowns",
                    arc_s, names[static_cast<std::size_t>(qr.colsPermutation().indices()[unknowns - 1])]));
  const Eigen::MatrixXd R = qr.matrixQR().topRows(unknowns);
  const Eigen::MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  return {scale.asDiagonal() * qr.solve(fitted.remainder),
          scale.asDiagonal() * (qr.colsPermutation() * inverse).eval()};
}

}  // namespace

FittedOrbit Batch::fit(const OrbitParameters& first, const Estimated& estimated) const {
  constexpr int kMaxIterations = 20, kMinIterations = 3;
  constexpr double kFraction = 1e-3, kFloor_m = 1e-5;
  FittedOrbit fitted;
  fitted.parameters = first;
  for (fitted.iterations = 1;; ++fitted.iterations) {
    fitted.states = dynamics_.propagate(fitted.parameters, arc_.seconds);
    weigh(arc_, fitted.iterations >= kMinIterations, fitted);  // a start that is not fitted yet shows no gross errors
    const Columns columns = columns_of(fitted.parameters, estimated);
    take_rows(arc_, columns.design, fitted);
    const Solution solution = solve(fitted, columns.names, arc_.length_s());
    const double moved_m =
        (fitted.design * solution.step).norm() / std::sqrt(static_cast<double>(fitted.remainder.size()) / 3.0);
    if (!std::isfinite(moved_m)) throw std::runtime_error("the fit diverges");
    if (fitted.iterations > kMinIterations && moved_m < std::max(kFraction * fitted.rms_m, kFloor_m)) {
      state_estimates(columns, solution.root, fitted);
      return fitted;
    }
    if (fitted.iterations == kMaxIterations)
      throw std::runtime_error(
          fmt::format("the fit did not converge in {} iterations: the last one moves the orbit by {:.3g} m at "
                      "residuals of {:.3g} m",
                      kMaxIterations, moved_m, fitted.rms_m));
    for (std::size_t k = 0; k < columns.values.size(); ++k)
      columns.values[k](fitted.parameters) += solution.step[static_cast<Eigen::Index>(k)];
    for (const Burn& burn : fitted.parameters.burns)
      if (burn.seconds < 0.0 || burn.seconds > arc_.length_s())
        throw std::runtime_error("the time of a burn leaves the arc: the positions do not show it");
  }
}

void Batch::state_estimates(const Columns& columns, const Eigen::MatrixXd& root, FittedOrbit& fitted) const {
  const Eigen::Index unknowns = root.rows();
  const auto freedom = static_cast<double>(std::max<Eigen::Index>(fitted.remainder.size() - unknowns, 1));
  fitted.correlated = correlated_count(fitted.residuals_rtn);
  const double variance = fitted.remainder.squaredNorm() / freedom * fitted.correlated;
  const fsw::Matrix3 R_rtn_eci = fsw::orbit::R_rtn_eci(fitted.parameters.start);
  OrbitParameters stated = fitted.parameters;
  stated.start.position_eci = R_rtn_eci * (stated.start.position_eci - arc_.first.position_eci);
  stated.start.velocity_eci = R_rtn_eci * (stated.start.velocity_eci - arc_.first.velocity_eci);
  Eigen::MatrixXd rotated = root;
  rotated.topRows<3>() = R_rtn_eci * root.topRows<3>();
  rotated.middleRows<3>(3) = R_rtn_eci * root.middleRows<3>(3);
  for (std::size_t k = 0; k < columns.names.size(); ++k) {
    const double sigma = std::sqrt(variance) * rotated.row(static_cast<Eigen::Index>(k)).norm();
    const double unit = columns.per_si[k];
    fitted.estimates.push_back({columns.names[k], unit * columns.values[k](stated), unit * sigma});
  }
}

}  // namespace vbar::orbit_fit
