#include "hil_drivers/tron/lights/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::tron {

namespace {

using fsw::Vector3;

/// Corners relative to the point, of the part above its horizon: Sutherland and Hodgman (1974).
std::vector<Vector3> above_horizon(const Vector3& point, const Vector3& normal, std::span<const Vector3> corners) {
  std::vector<Vector3> part;
  part.reserve(corners.size() + 1);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector3 here = corners[k] - point, next = corners[(k + 1) % corners.size()] - point;
    const double height = normal.dot(here), height_next = normal.dot(next);
    if (height >= 0.0) part.push_back(here);
    if ((height > 0.0 && height_next < 0.0) || (height < 0.0 && height_next > 0.0))
      part.push_back(here + height / (height - height_next) * (next - here));
  }
  return part;
}

}  // namespace

double form_factor(const Vector3& point, const Vector3& normal, std::span<const Vector3> corners) {
  if (corners.size() < 3) return 0.0;
  const Vector3 bright_side = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(bright_side.dot(point - corners[0]) > 0.0)) return 0.0;
  const std::vector<Vector3> part = above_horizon(point, normal, corners);
  double sum = 0.0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const Vector3 &here = part[k], &next = part[(k + 1) % part.size()];
    const Vector3 axis = next.cross(here);  // anticlockwise from the bright side is clockwise from the point
    const double sine = axis.norm();
    if (sine > 0.0) sum += std::atan2(sine, here.dot(next)) * normal.dot(axis) / sine;
  }
  return std::max(0.0, sum / (2.0 * std::numbers::pi));
}

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
