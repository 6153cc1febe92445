#include "hil_drivers/tron/lights/photometric_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::tron {
namespace {

/// y at x of the polyline through the points, whose ends are prolonged.
double interpolated(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto above = std::upper_bound(xs.begin() + 1, xs.end() - 1, x);
  const auto k = static_cast<std::size_t>(above - xs.begin());
  return ys[k - 1] + (x - xs[k - 1]) / (xs[k] - xs[k - 1]) * (ys[k] - ys[k - 1]);
}

}  // namespace

std::string light_source_name(std::size_t source) {
  return source == 0 ? "lamp" : fmt::format("box {}", source);
}

LightResponse::LightResponse(const LightTable& table) {
  const auto require = [&](bool is_met, const char* rule) {
    if (!is_met) throw std::invalid_argument(fmt::format("photometric table of '{}': {}", table.source, rule));
  };
  require(table.level.size() == table.light.size(), "levels and light differ in number");
  log_level_.clear();
  log_light_.clear();
  for (std::size_t k = 0; k < table.level.size(); ++k) {
    if (table.level[k] == 0.0) continue;
    require(table.level[k] > 0.0 && table.level[k] <= 1.0, "a level is not in 0 to 1");
    require(table.light[k] > 0.0 && std::isfinite(table.light[k]), "light of a level above zero is not positive");
    log_level_.push_back(std::log(table.level[k]));
    log_light_.push_back(std::log(table.light[k]));
  }
  require(log_level_.size() >= 2, "fewer than two levels above zero");
  const auto rises = [](const std::vector<double>& values) {
    return std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
  };
  require(rises(log_level_), "the levels do not rise");
  require(rises(log_light_), "the light does not rise with the level");
}

double LightResponse::light(double level) const {
  return level > 0.0 ? std::exp(interpolated(log_level_, log_light_, std::log(level))) : 0.0;
}

double LightResponse::level(double light) const {
  return light > 0.0 ? std::min(1.0, std::exp(interpolated(log_light_, log_level_, std::log(light)))) : 0.0;
}

PhotometricTable::PhotometricTable(const std::vector<LightTable>& tables) {
  std::array<bool, kLightSources> is_given{};
  for (const LightTable& table : tables) {
    std::size_t source = 0;
    while (source < kLightSources && light_source_name(source) != table.source) ++source;
    if (source == kLightSources)
      throw std::invalid_argument(
          fmt::format("photometric table of '{}', which is not a source of light", table.source));
    if (is_given[source]) throw std::invalid_argument(fmt::format("two photometric tables of '{}'", table.source));
    is_given[source] = true;
    responses_[source] = LightResponse(table);
  }
  for (std::size_t source = 0; source < kLightSources; ++source)
    if (!is_given[source])
      throw std::invalid_argument(fmt::format("the photometric table of '{}' is missing", light_source_name(source)));
}

}  // namespace vbar::tron
