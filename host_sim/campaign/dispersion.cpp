#include "host_sim/campaign/dispersion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::campaign {

std::vector<double> uniforms_of(std::uint64_t campaign_seed, const std::string& key, std::uint64_t index,
                                std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t block = 0; numbers.size() < count; ++block) {
    const std::string name = block == 0 ? key : key + "#" + std::to_string(block);
    const auto four = engine::RandomStream(campaign_seed, name).uniforms_of(index);
    numbers.insert(numbers.end(), four.begin(), four.begin() + std::min<std::ptrdiff_t>(4, count - numbers.size()));
  }
  return numbers;
}

DrawSource::DrawSource(std::uint64_t campaign_seed, Sampling sampling, std::vector<std::uint64_t> indices)
    : seed_(campaign_seed), sampling_(sampling), indices_(std::move(indices)) {}

std::vector<std::vector<double>> DrawSource::all_of(const std::string& key, std::size_t count) const {
  std::vector<std::vector<double>> all;
  for (const std::uint64_t index : indices_) all.push_back(uniforms_of(seed_, key, index, count));
  if (sampling_ == Sampling::kIndependent) return all;
  std::vector<std::vector<double>> order;
  for (const std::uint64_t index : indices_) order.push_back(uniforms_of(seed_, key + "#stratum", index, count));
  const auto strata = static_cast<double>(all.size());
  for (std::size_t place = 0; place < count; ++place) {
    std::vector<std::size_t> ranked(all.size());
    std::iota(ranked.begin(), ranked.end(), std::size_t{0});
    std::ranges::sort(ranked, {}, [&](std::size_t k) { return order[k][place]; });
    for (std::size_t stratum = 0; stratum < ranked.size(); ++stratum) {
      double& number = all[ranked[stratum]][place];
      number = (static_cast<double>(stratum) + number) / strata;
    }
  }
  return all;
}

namespace {

using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr double kLargest = 1e300;
constexpr Range kAny = from_to(-kLargest, kLargest);
constexpr Range kPositive = mission::above_to(0.0, kLargest);
constexpr std::size_t kMaxNumbers = 1000;

struct Limits {
  double low = 0.0, high = 0.0;
};

Limits read_limits(const TableReader& section, Range range) {
  const Limits limits{section.number("low", range), section.number("high", range)};
  if (limits.high <= limits.low) section.refuse_value("high", "a number above low");
  return limits;
}

Dispersion read_uniform(const TableReader& section, const toml::table& /*table*/) {
  const Limits l = read_limits(section, kAny);
  return {{}, 1, [l](std::span<const double> u) {
            return std::vector{text_of(std::clamp(l.low + (l.high - l.low) * u[0], l.low, l.high))};
          }};
}

Dispersion read_log_uniform(const TableReader& section, const toml::table& /*table*/) {
  const Limits l = read_limits(section, kPositive);
  return {{}, 1, [l](std::span<const double> u) {
            return std::vector{text_of(std::clamp(l.low * std::pow(l.high / l.low, u[0]), l.low, l.high))};
          }};
}

Dispersion read_integer(const TableReader& section, const toml::table& /*table*/) {
  constexpr std::int64_t kMax = std::int64_t{1} << 53;
  const std::int64_t low = section.integer("low", -kMax, kMax), high = section.integer("high", -kMax, kMax);
  if (high < low) section.refuse_value("high", "an integer that is not below low");
  return {{}, 1, [low, high](std::span<const double> u) {
            const double count = static_cast<double>(high - low) + 1.0;
            const auto place = static_cast<std::int64_t>(std::floor(count * u[0]));
            return std::vector{fmt::format("{}", std::min(low + place, high))};
          }};
}

Dispersion read_choice(const TableReader& section, const toml::table& table) {
  static_cast<void>(section.is_array("values"));
  const toml::array* const array = table["values"].as_array();
  if (array == nullptr || array->empty()) section.refuse_value("values", "an array of at least one value");
  std::vector<std::string> values;
  for (const toml::node& value : *array) values.push_back(text_of(value));
  std::vector<double> weights(values.size(), 1.0);
  if (section.has("weights"))
    weights = section.numbers("weights", values.size(), values.size(), from_to(0.0, kLargest));
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  if (!(sum > 0.0)) section.refuse_value("weights", "a number above 0 for at least one value");
  return {{}, 1, [values, weights, sum](std::span<const double> u) {
            double below = 0.0;
            std::size_t last = 0;
            for (std::size_t k = 0; k < values.size(); ++k) {
              if (weights[k] <= 0.0) continue;
              last = k;
              below += weights[k] / sum;
              if (u[0] < below) break;
            }
            return std::vector{values[last]};
          }};
}

std::string text_of_vector(const std::vector<double>& vector) {
  std::vector<std::string> texts;
  for (const double component : vector) texts.push_back(text_of(component));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// Uniform on the sphere of that radius about the mean.
Dispersion read_direction(const TableReader& section, const toml::table& /*table*/) {
  const double length = section.number("length", kPositive, 1.0);
  const auto mean = section.three_numbers("mean", kAny, std::array{0.0, 0.0, 0.0});
  return {{}, 2, [length, mean](std::span<const double> u) {
            const double z = 2.0 * u[0] - 1.0, angle = 2.0 * M_PI * u[1];
            const double across = std::sqrt(1.0 - z * z);
            return std::vector{text_of_vector({mean[0] + length * across * std::cos(angle),
                                               mean[1] + length * across * std::sin(angle), mean[2] + length * z})};
          }};
}

/// Cut off below `low` and above `high`, which may be missing.
Dispersion read_scalar_normal(const TableReader& section) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double mean = section.number("mean", kAny), sigma = section.number("sigma", kPositive);
  const bool is_cut = section.has("low") || section.has("high");
  const double low = section.has("low") ? section.number("low", kAny) : -kInfinity;
  const double high = section.has("high") ? section.number("high", kAny) : kInfinity;
  if (high <= low) section.refuse_value("high", "a number above low");
  return {{}, 1, [=](std::span<const double> u) {
            const double normal =
                is_cut ? engine::truncated_normal_quantile(u[0], (low - mean) / sigma, (high - mean) / sigma)
                       : engine::normal_quantile(u[0]);
            return std::vector{text_of(std::clamp(mean + sigma * normal, low, high))};
          }};
}

/// Independent components of a vector.
Dispersion read_vector_normal(const TableReader& section) {
  const std::vector<double> mean = section.numbers("mean", 1, kMaxNumbers, kAny);
  const std::vector<double> sigma = section.is_array("sigma")
                                        ? section.numbers("sigma", mean.size(), mean.size(), from_to(0.0, kLargest))
                                        : std::vector<double>(mean.size(), section.number("sigma", kPositive));
  return {{}, mean.size(), [mean, sigma](std::span<const double> u) {
            std::vector<double> vector;
            for (std::size_t k = 0; k < mean.size(); ++k)
              vector.push_back(mean[k] + sigma[k] * engine::normal_quantile(u[k]));
            return std::vector{text_of_vector(vector)};
          }};
}

Dispersion read_normal(const TableReader& section, const toml::table& /*table*/) {
  return section.is_array("mean") ? read_vector_normal(section) : read_scalar_normal(section);
}

/// Lower triangle with L L' = covariance.
Eigen::MatrixXd read_factor(const TableReader& section, const toml::table& table, std::size_t size) {
  const std::string accepted = fmt::format("a symmetric, positive definite matrix of {0} rows of {0} numbers", size);
  static_cast<void>(section.is_array("covariance"));
  const toml::array* const rows = table["covariance"].as_array();
  if (rows == nullptr || rows->size() != size) section.refuse_value("covariance", accepted);
  Eigen::MatrixXd covariance(size, size);
  for (std::size_t row = 0; row < size; ++row) {
    const toml::array* const cells = rows->get(row)->as_array();
    if (cells == nullptr || cells->size() != size) section.refuse_value("covariance", accepted);
    for (std::size_t column = 0; column < size; ++column) {
      const auto number = cells->get(column)->value<double>();
      if (!number) section.refuse_value("covariance", accepted);
      covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = *number;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (!covariance.allFinite() || covariance != covariance.transpose() || factor.info() != Eigen::Success)
    section.refuse_value("covariance", accepted);
  return factor.matrixL();
}

/// The first key takes its own number alone, the next one its own and those before it: a key that is added at the end
/// moves no other.
Dispersion read_correlated(const TableReader& section, const toml::table& table, std::size_t keys) {
  const std::vector<double> mean = section.numbers("mean", keys, keys, kAny);
  const Eigen::MatrixXd factor = read_factor(section, table, keys);
  return {{}, 1, [mean, factor](std::span<const double> u) {
            std::vector<std::string> texts;
            for (std::size_t row = 0; row < mean.size(); ++row) {
              double value = mean[row];
              for (std::size_t k = 0; k <= row; ++k)
                value += factor(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) *
                         engine::normal_quantile(u[k]);
              texts.push_back(text_of(value));
            }
            return texts;
          }};
}

struct Distribution {
  std::string_view name;
  Dispersion (*read)(const TableReader& section, const toml::table& table);
};
constexpr std::array<Distribution, 6> kDistributions{{{"uniform", read_uniform},
                                                      {"log_uniform", read_log_uniform},
                                                      {"normal", read_normal},
                                                      {"integer", read_integer},
                                                      {"choice", read_choice},
                                                      {"direction", read_direction}}};

}  // namespace

Dispersion read_dispersion(const TableReader& section, const toml::table& table) {
  std::vector<std::string_view> names;
  for (const Distribution& distribution : kDistributions) names.push_back(distribution.name);
  if (section.has("key") == section.has("keys"))
    section.refuse("", section.has("key") ? "both key and keys" : "neither key nor keys", "exactly one of them");
  Dispersion dispersion;
  if (section.has("keys")) {
    const std::vector<std::string> keys = section.texts("keys");
    if (keys.empty()) section.refuse_value("keys", "at least one key of the mission");
    if (section.choice("distribution", names, "normal") != "normal")
      section.refuse_value("distribution", "normal, of correlated keys");
    dispersion = read_correlated(section, table, keys.size());
    dispersion.keys = keys;
  } else {
    const std::string key = section.text("key");
    const std::string name = section.choice("distribution", names, "");
    const auto* const found = std::ranges::find(kDistributions, name, &Distribution::name);
    if (found == kDistributions.end()) section.refuse("distribution", "nothing", mission::listing_of(names));
    dispersion = found->read(section, table);
    dispersion.keys = {key};
  }
  section.finish();
  return dispersion;
}

std::vector<std::vector<std::string>> draw(const Dispersion& dispersion, const DrawSource& source,
                                           const std::string& suffix) {
  std::vector<std::vector<double>> numbers;
  for (const std::string& key : dispersion.keys) {
    const std::vector<std::vector<double>> of_key = source.all_of(key + suffix, dispersion.uniforms);
    numbers.resize(of_key.size());
    for (std::size_t k = 0; k < of_key.size(); ++k)
      numbers[k].insert(numbers[k].end(), of_key[k].begin(), of_key[k].end());
  }
  std::vector<std::vector<std::string>> rows;
  for (const std::vector<double>& u : numbers) rows.push_back(dispersion.values(u));
  return rows;
}

}  // namespace vbar::campaign
