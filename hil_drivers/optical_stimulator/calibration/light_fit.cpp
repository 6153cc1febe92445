#include "hil_drivers/optical_stimulator/calibration/light_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "hil_drivers/optical_stimulator/optics/display_map.h"

namespace vbar::optical_stimulator::calibrate {

namespace {

constexpr double kQuantisation_dn2 = 1.0 / 12.0;

/// Mean of the values within four standard deviations of their median.
Figure clipped_mean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  const double median = values[count / 2], spread = 0.5 * (values[count * 84 / 100] - values[count * 16 / 100]) + 1e-9;
  double sum = 0.0, kept = 0.0;
  for (const double value : values)
    if (std::abs(value - median) <= 4.0 * spread) sum += value, kept += 1.0;
  return {sum / kept, spread / std::sqrt(kept)};
}

}  // namespace

MeanVariance mean_variance(const FramePair& pair, int width, int height) {
  std::vector<double> differences, means;
  constexpr double kLow = 0.5 * (1.0 - kNoiseShare), kHigh = 0.5 * (1.0 + kNoiseShare);
  for (int y = static_cast<int>(kLow * height); y < static_cast<int>(kHigh * height); ++y)
    for (int x = static_cast<int>(kLow * width); x < static_cast<int>(kHigh * width); ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const double first = pair.first[at], second = pair.second[at];
      differences.push_back(first - second);
      means.push_back(0.5 * (first + second));
    }
  MeanVariance result;
  const Figure mean = clipped_mean(means), difference = clipped_mean(differences);
  const auto count = static_cast<double>(differences.size());
  double sum = 0.0, kept = 0.0;
  // Beyond six standard deviations lie only defects: of Gaussian noise nothing is lost.
  const double limit = 6.0 * difference.sigma * std::sqrt(count) + 3.0;
  for (const double d : differences)
    if (std::abs(d - difference.value) <= limit) sum += (d - difference.value) * (d - difference.value), kept += 1.0;
  result.mean_dn = mean.value;
  result.mean_sigma_dn = mean.sigma;
  result.variance_dn2 = 0.5 * sum / kept - kQuantisation_dn2;
  result.variance_sigma_dn2 = (result.variance_dn2 + kQuantisation_dn2) * std::sqrt(2.0 / kept);
  return result;
}

GainFit fit_gain(const MeanVariance& black, const std::vector<MeanVariance>& grey) {
  // Slope through the black point, weighted by the variances' own uncertainties.
  double weights = 0.0, sum = 0.0;
  for (const MeanVariance& level : grey) {
    const double signal = level.mean_dn - black.mean_dn;
    if (!(signal > 10.0)) continue;
    const double sigma = std::hypot(level.variance_sigma_dn2, black.variance_sigma_dn2) / signal;
    sum += (level.variance_dn2 - black.variance_dn2) / signal / (sigma * sigma);
    weights += 1.0 / (sigma * sigma);
  }
  if (!(sum > 0.0)) throw std::runtime_error("noise: the variance of grey frames does not grow with their mean");
  const double gain = sum / weights, gain_sigma = 1.0 / std::sqrt(weights);
  if (!(black.variance_dn2 > 0.0)) throw std::runtime_error("noise: black frames have no noise");
  const double noise = std::sqrt(black.variance_dn2) / gain;
  return {{gain, gain_sigma},
          {noise, noise * std::hypot(0.5 * black.variance_sigma_dn2 / black.variance_dn2, gain_sigma / gain)}};
}

BlackFit fit_black(const CameraPicture& short_exposure, double short_s, const CameraPicture& long_exposure,
                   double long_s, double noise_dn) {
  const double span_s = long_s - short_s;
  std::vector<double> rates(short_exposure.dn.size()), values(short_exposure.dn.begin(), short_exposure.dn.end());
  for (std::size_t k = 0; k < rates.size(); ++k)
    rates[k] = (static_cast<double>(long_exposure.dn[k]) - static_cast<double>(short_exposure.dn[k])) / span_s;
  const Figure level = clipped_mean(values), rate = clipped_mean(rates);
  BlackFit fit;
  fit.background_dn_per_s = rate;
  fit.offset_dn = {level.value - rate.value * short_s, std::hypot(level.sigma, rate.sigma * short_s)};
  const double limit = 8.0 * noise_dn / span_s;
  for (std::size_t k = 0; k < rates.size(); ++k)
    if (rates[k] - rate.value > limit)
      fit.hot_pixels.push_back(
          {static_cast<int>(k) % short_exposure.width, static_cast<int>(k) / short_exposure.width, rates[k]});
  return fit;
}

void repair(CameraPicture& picture, const std::vector<HotPixel>& hot_pixels) {
  for (const HotPixel& hot : hot_pixels) {
    float* const row = picture.dn.data() + static_cast<std::ptrdiff_t>(hot.y) * picture.width;
    const int left = hot.x > 0 ? hot.x - 1 : hot.x + 1, right = hot.x + 1 < picture.width ? hot.x + 1 : hot.x - 1;
    row[hot.x] = 0.5F * (row[left] + row[right]);
  }
}

namespace {

constexpr double kModelFloor = 2e-3;  // relative: light that no noise explains, e.g. of drift

struct LinearPart {
  double chi2 = 0.0;
  Eigen::VectorXd solution;  // log full light by place, then gamma
  double gamma_sigma = 0.0;
};

/// The linear least squares for one first count.
LinearPart solve_linear(const std::vector<SquareLight>& squares, int places, double first_count) {
  const Eigen::Index unknowns = places + 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(unknowns, unknowns) * 1e-12;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  const auto visit = [&](auto&& use) {
    for (const SquareLight& square : squares) {
      const double relative = std::hypot(square.sigma / square.electrons_per_s, kModelFloor);
      const double exponent = std::log((square.count - first_count) / (255.0 - first_count));
      use(square.place, exponent, std::log(square.electrons_per_s), 1.0 / (relative * relative));
    }
  };
  visit([&](int place, double exponent, double light, double weight) {
    normal(place, place) += weight;
    normal(place, places) += weight * exponent;
    normal(places, place) += weight * exponent;
    normal(places, places) += weight * exponent * exponent;
    right(place) += weight * light;
    right(places) += weight * exponent * light;
  });
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  LinearPart part;
  part.solution = solver.solve(right);
  part.gamma_sigma = std::sqrt(solver.solve(Eigen::VectorXd::Unit(unknowns, places))(places));
  visit([&](int place, double exponent, double light, double weight) {
    const double miss = light - part.solution(place) - part.solution(places) * exponent;
    part.chi2 += weight * miss * miss;
  });
  return part;
}

double golden_section(double low, double high, const auto& value_at) {
  constexpr double kShare = 0.6180339887498949;
  double a = high - kShare * (high - low), b = low + kShare * (high - low);
  double value_a = value_at(a), value_b = value_at(b);
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (value_a < value_b) {
      high = b, b = a, value_b = value_a;
      value_a = value_at(a = high - kShare * (high - low));
    } else {
      low = a, a = b, value_a = value_b;
      value_b = value_at(b = low + kShare * (high - low));
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

ResponseFit fit_response(const std::vector<SquareLight>& squares, int places) {
  std::vector<SquareLight> used;
  std::set<double> levels;
  for (const SquareLight& square : squares)
    if (square.electrons_per_s > 10.0 * square.sigma) used.push_back(square), levels.insert(square.count);
  if (levels.size() < 4)
    throw std::runtime_error("counts to light: fewer than four levels of the display were measured");
  const auto chi2_at = [&](double first_count) { return solve_linear(used, places, first_count).chi2; };
  const double first_count = golden_section(-20.0, *levels.begin() - 1e-3, chi2_at);
  const LinearPart part = solve_linear(used, places, first_count);
  const double freedoms = std::max(1.0, static_cast<double>(used.size()) - places - 2.0);
  const double scale = std::sqrt(std::max(1.0, part.chi2 / freedoms));
  constexpr double kStep = 0.02;
  const double curvature =
      (chi2_at(first_count + kStep) - 2.0 * part.chi2 + chi2_at(first_count - kStep)) / (kStep * kStep);
  ResponseFit fit;
  fit.first_count = {first_count, curvature > 0.0 ? scale * std::sqrt(2.0 / curvature) : 1.0};
  // gamma moves with the first count: the part along that valley is added.
  const double gamma_by_count =
      (solve_linear(used, places, first_count + kStep).solution(places) - part.solution(places)) / kStep;
  fit.gamma = {part.solution(places), std::hypot(scale * part.gamma_sigma, gamma_by_count * fit.first_count.sigma)};
  for (int place = 0; place < places; ++place) fit.full_electrons_per_s.push_back(std::exp(part.solution(place)));
  double sum = 0.0;
  for (const SquareLight& square : used) {
    const double model = fit.full_electrons_per_s[static_cast<std::size_t>(square.place)] *
                         std::pow((square.count - first_count) / (255.0 - first_count), fit.gamma.value);
    sum += std::pow(square.electrons_per_s / model - 1.0, 2.0);
  }
  fit.residual = std::sqrt(sum / static_cast<double>(used.size()));
  return fit;
}

UniformityFit fit_uniformity(const std::vector<PlaceLight>& places, int width_px, int height_px, int degree) {
  ChebyshevField basis;
  basis.degree = degree;
  basis.high_px = {width_px - 1.0, height_px - 1.0};
  const auto terms = static_cast<Eigen::Index>(ChebyshevField::term_count(degree));
  if (static_cast<Eigen::Index>(places.size()) < 2 * terms)
    throw std::runtime_error("uniformity: too few dots were found");
  Eigen::MatrixXd design(static_cast<Eigen::Index>(places.size()), terms);
  Eigen::VectorXd light(design.rows());
  for (Eigen::Index k = 0; k < design.rows(); ++k) {
    const PlaceLight& place = places[static_cast<std::size_t>(k)];
    const ChebyshevTerms values = chebyshev_terms(basis, place.display_px);
    design.row(k) = Eigen::Map<const Eigen::RowVectorXd>(values.value.data(), terms);
    light(k) = place.electrons_per_s;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(design.transpose() * design);
  const Eigen::VectorXd solution = solver.solve(design.transpose() * light);
  UniformityFit fit;
  fit.grid.columns = 17;
  fit.grid.rows = 11;
  fit.grid.step_px = {(width_px - 1.0) / 16.0, (height_px - 1.0) / 10.0};
  for (int row = 0; row < fit.grid.rows; ++row)
    for (int column = 0; column < fit.grid.columns; ++column) {
      const ChebyshevTerms values = chebyshev_terms(basis, {fit.grid.step_px.x() * column, fit.grid.step_px.y() * row});
      fit.grid.values.push_back(Eigen::Map<const Eigen::VectorXd>(values.value.data(), terms).dot(solution));
    }
  const double mean = std::accumulate(fit.grid.values.begin(), fit.grid.values.end(), 0.0) /
                      static_cast<double>(fit.grid.values.size());
  for (double& value : fit.grid.values) value = std::max(0.01, value / mean);
  fit.mean_electrons_per_s = mean;
  const double freedoms = static_cast<double>(design.rows() - terms);
  fit.grid.sigma = std::sqrt((design * solution - light).squaredNorm() / freedoms * static_cast<double>(terms) /
                             static_cast<double>(design.rows())) /
                   mean;
  return fit;
}

}  // namespace vbar::optical_stimulator::calibrate
