#include "host_sim/flown_gnss/ephemeris_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <fmt/format.h>

#include "fsw/gnss/constants.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::flown_gnss {
namespace {

using fsw::GpsTime;
using fsw::Vector3;
using orbit_files::TimedState;
using twins::gnss::Ephemeris;

/// The fifteen parameters of the orbit, and how far each may be from its first value: positions, known to centimetres,
/// outweigh that by far where they determine it.
struct Parameter {
  double Ephemeris::*value;
  double step;  ///< of the numerical derivative
  double sigma;
};
constexpr std::array<Parameter, 15> kParameters{{
    {&Ephemeris::sqrt_a, 1e-3, 1.0},
    {&Ephemeris::e, 1e-7, 1e-3},
    {&Ephemeris::m0, 1e-7, 1.0},
    {&Ephemeris::delta_n, 1e-12, 5e-9},
    {&Ephemeris::node_at_toe, 1e-7, 1e-3},
    {&Ephemeris::omega_dot, 1e-12, 1e-9},
    {&Ephemeris::i0, 1e-7, 1e-3},
    {&Ephemeris::i_dot, 1e-12, 5e-10},
    {&Ephemeris::omega, 1e-7, 1.0},
    {&Ephemeris::cuc, 1e-8, 1e-5},
    {&Ephemeris::cus, 1e-8, 1e-5},
    {&Ephemeris::cic, 1e-8, 5e-7},
    {&Ephemeris::cis, 1e-8, 5e-7},
    {&Ephemeris::crc, 1e-1, 300.0},
    {&Ephemeris::crs, 1e-1, 100.0},
}};
using Normal = Eigen::Matrix<double, kParameters.size(), kParameters.size()>;
using Unknowns = Eigen::Matrix<double, kParameters.size(), 1>;

constexpr double kPositionSigma_m = 0.01;
constexpr std::size_t kMinPositions = 7;

/// A position of the antenna.
struct Point {
  double after_s = 0.0;  ///< the reference time
  Vector3 position_ecef = Vector3::Zero();
};

Vector3 inertial(const Point& point) {
  return Eigen::AngleAxisd(fsw::gnss::kEarthRateGps * point.after_s, Vector3::UnitZ()) * point.position_ecef;
}

/// Position and velocity at the reference time: the polynomial of degree 5 through the positions nearest to it, in
/// axes that do not rotate.
std::pair<Vector3, Vector3> state_of(std::vector<Point> points) {
  constexpr int kDegree = 5;
  std::ranges::sort(points, {}, [](const Point& p) { return std::abs(p.after_s); });
  points.resize(std::min(points.size(), std::size_t{kDegree + 2}));
  const auto rows = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd powers(rows, kDegree + 1), positions(rows, 3);
  constexpr double kUnit_s = 1000.0;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Point& point = points[static_cast<std::size_t>(k)];
    for (int n = 0; n <= kDegree; ++n) powers(k, n) = std::pow(point.after_s / kUnit_s, n);
    positions.row(k) = inertial(point).transpose();
  }
  const Eigen::MatrixXd c = powers.colPivHouseholderQr().solve(positions);
  return {c.row(0).transpose(), c.row(1).transpose() / kUnit_s};
}

/// Elements of the conic section of a state; the model's secular and harmonic terms are zero.
void set_conic(const Vector3& r, const Vector3& v, Ephemeris& set) {
  constexpr double kMu = fsw::gnss::kGmGps;
  const Vector3 h = r.cross(v);
  const double a = 1.0 / (2.0 / r.norm() - v.squaredNorm() / kMu);
  const Vector3 e = v.cross(h) / kMu - r.normalized();
  const Vector3 node = Vector3::UnitZ().cross(h).normalized();
  const Vector3 across = h.normalized().cross(node);
  set.sqrt_a = std::sqrt(a);
  set.e = e.norm();
  set.i0 = std::atan2(std::hypot(h.x(), h.y()), h.z());
  set.node_at_toe = std::atan2(node.y(), node.x());
  set.omega = std::atan2(e.dot(across), e.dot(node));
  const double latitude = std::atan2(r.dot(across), r.dot(node));
  const double half = 0.5 * (latitude - set.omega);
  const double eccentric =
      2.0 * std::atan2(std::sqrt(1.0 - set.e) * std::sin(half), std::sqrt(1.0 + set.e) * std::cos(half));
  set.m0 = eccentric - set.e * std::sin(eccentric);
  // What J2 makes of a GPS orbit, in rad/s.
  set.omega_dot = -8e-9;
  set.delta_n = 4.5e-9;
}

Vector3 residual(const Ephemeris& set, const Point& point) {
  return point.position_ecef - satellite_state(set, set.toe, point.after_s).position_ecef;
}

/// Gauss-Newton from the conic section; false if it does not converge.
bool fit_orbit(const std::vector<Point>& points, Ephemeris& set) {
  const Ephemeris first = set;
  constexpr int kMaxIterations = 20;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    // In units of sigma.
    Normal normal = Normal::Identity();
    Unknowns right;
    for (std::size_t k = 0; k < kParameters.size(); ++k)
      right(static_cast<Eigen::Index>(k)) =
          (first.*kParameters[k].value - set.*kParameters[k].value) / kParameters[k].sigma;
    for (const Point& point : points) {
      const Vector3 misfit = residual(set, point);
      Eigen::Matrix<double, 3, kParameters.size()> design;
      for (std::size_t k = 0; k < kParameters.size(); ++k) {
        Ephemeris above = set, below = set;
        above.*kParameters[k].value += kParameters[k].step;
        below.*kParameters[k].value -= kParameters[k].step;
        design.col(static_cast<Eigen::Index>(k)) =
            (residual(below, point) - residual(above, point)) / (2.0 * kParameters[k].step) * kParameters[k].sigma;
      }
      normal += design.transpose() * design / (kPositionSigma_m * kPositionSigma_m);
      right += design.transpose() * misfit / (kPositionSigma_m * kPositionSigma_m);
    }
    const Unknowns step = normal.ldlt().solve(right);
    if (!step.allFinite()) return false;
    for (std::size_t k = 0; k < kParameters.size(); ++k)
      set.*kParameters[k].value += step(static_cast<Eigen::Index>(k)) * kParameters[k].sigma;
    if (!(set.e >= 0.0 && set.e < 0.1 && set.sqrt_a > 4000.0 && set.sqrt_a < 6000.0)) return false;
    double largest_m = 0.0;
    for (const Point& point : points) largest_m = std::max(largest_m, (residual(set, point)).norm());
    if (iteration > 2 && step.norm() < 1e-4) return largest_m < 10.0;
  }
  return false;
}

struct Clock {
  double after_s = 0.0, clock_s = 0.0;
};

/// A polynomial of the second degree, of the first through two clocks. Polynomials do not extrapolate: clocks on both
/// sides are required.
bool fit_clock(const std::vector<Clock>& clocks, FittedSet& fitted) {
  const bool is_around = std::ranges::any_of(clocks, [](const Clock& c) { return c.after_s <= 0.0; }) &&
                         std::ranges::any_of(clocks, [](const Clock& c) { return c.after_s >= 0.0; });
  if (clocks.size() < 2 || !is_around) return false;
  const auto rows = static_cast<Eigen::Index>(clocks.size());
  const int terms = clocks.size() > 2 ? 3 : 2;
  constexpr double kUnit_s = 1000.0;
  Eigen::MatrixXd powers(rows, terms);
  Eigen::VectorXd values(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Clock& clock = clocks[static_cast<std::size_t>(k)];
    for (int n = 0; n < terms; ++n) powers(k, n) = std::pow(clock.after_s / kUnit_s, n);
    values(k) = clock.clock_s;
  }
  const Eigen::VectorXd c = powers.colPivHouseholderQr().solve(values);
  const Eigen::VectorXd misfit_m = fsw::gnss::kSpeedOfLight * (values - powers * c);
  fitted.elements.af0 = c(0);
  fitted.elements.af1 = c(1) / kUnit_s;
  fitted.elements.af2 = terms > 2 ? c(2) / (kUnit_s * kUnit_s) : 0.0;
  fitted.clock_rms_m = std::sqrt(misfit_m.squaredNorm() / static_cast<double>(rows));
  fitted.clock_max_m = misfit_m.cwiseAbs().maxCoeff();
  return true;
}

/// The states of a satellite in all files, in order of time and each once.
std::map<int, std::vector<TimedState>> states_of(const std::vector<orbit_files::OrbitFile>& files) {
  std::map<int, std::map<std::int64_t, TimedState>> by_time;
  for (const orbit_files::OrbitFile& file : files) {
    for (const orbit_files::Track& track : file.tracks) {
      const auto number = track.object.size() == 3 && track.object.front() == 'G'
                              ? files::integer_of(std::string_view(track.object).substr(1))
                              : std::nullopt;
      if (!number || track.frame != orbit_files::Frame::kItrf) continue;
      for (const TimedState& state : track.states) by_time[*number].insert_or_assign(state.time.ns, state);
    }
  }
  std::map<int, std::vector<TimedState>> states;
  for (const auto& [number, one] : by_time)
    for (const auto& [time, state] : one) states[number].push_back(state);
  return states;
}

/// Fits a set; the reason if it cannot be.
std::string fit_set(const std::vector<TimedState>& states, GpsTime toe, const FitSettings& settings, double offset_m,
                    FittedSet& fitted) {
  std::vector<Point> points;
  std::vector<Clock> clocks;
  for (const TimedState& state : states) {
    const double after_s = fsw::seconds(state.time - toe);
    const Vector3& centre = state.state.position_eci;
    if (std::abs(after_s) <= 0.5 * settings.orbit_arc_s)
      points.push_back({after_s, centre - offset_m * centre.normalized()});
    if (state.clock_s && std::abs(after_s) <= 0.5 * settings.clock_arc_s) clocks.push_back({after_s, *state.clock_s});
  }
  if (points.size() < kMinPositions) return fmt::format("{} positions in its arc", points.size());
  if (!fit_clock(clocks, fitted)) return fmt::format("{} clocks in its arc", clocks.size());
  const auto [position, velocity] = state_of(points);
  set_conic(position, velocity, fitted.elements);
  if (!fit_orbit(points, fitted.elements)) return "the fit does not converge";
  double squares = 0.0;
  for (const Point& point : points) {
    const double distance_m = residual(fitted.elements, point).norm();
    squares += distance_m * distance_m;
    fitted.orbit_max_m = std::max(fitted.orbit_max_m, distance_m);
  }
  fitted.orbit_rms_m = std::sqrt(squares / static_cast<double>(points.size()));
  return {};
}

}  // namespace

Fit fit_ephemerides(const std::vector<orbit_files::OrbitFile>& files, const FitSettings& settings,
                    const PhaseCentres& phase_centres) {
  const auto states = states_of(files);
  if (states.empty()) throw std::runtime_error("the orbit files hold no GPS satellite (G01 to G32)");
  GpsTime first{std::numeric_limits<std::int64_t>::max()}, last{0};
  for (const auto& [number, one] : states) {
    first = std::min(first, one.front().time);
    last = std::max(last, one.back().time);
  }
  const std::int64_t period_ns = fsw::nearest_duration(settings.period_s).ns;
  Fit fit;
  for (GpsTime toe{(first.ns + period_ns - 1) / period_ns * period_ns}; toe <= last; toe.ns += period_ns) {
    for (const auto& [number, one] : states) {
      FittedSet fitted;
      fitted.elements.satellite = {twins::gnss::System::kGps, number};
      fitted.elements.toe = toe;
      const auto offset = phase_centres.find(number);
      const std::string reason =
          fit_set(one, toe, settings, offset == phase_centres.end() ? 0.0 : offset->second, fitted);
      if (reason.empty()) {
        fit.sets.push_back(fitted);
      } else {
        fit.left_out.push_back(fmt::format("G{:02d} at {} s of the week: {}", number,
                                           week_time(twins::gnss::System::kGps, toe).seconds_of_week(), reason));
      }
    }
  }
  return fit;
}

}  // namespace vbar::flown_gnss
