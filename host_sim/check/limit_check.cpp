#include "host_sim/check/limit_check.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/mission/nearest_name.h"

namespace vbar::check {
namespace {

using Number = std::pair<std::string, double>;

std::string missing(const std::string& key, std::span<const Number> numbers) {
  std::vector<std::string_view> keys;
  for (const Number& number : numbers) keys.push_back(number.first);
  const auto nearest = mission::nearest_name(key, keys);
  return fmt::format("the summary has no number {}{}", key,
                     nearest ? fmt::format("; did you mean {}?", *nearest) : std::string());
}

}  // namespace

bool meets(const mission::Limit& limit, const std::optional<double>& value) {
  return value && std::isfinite(*value) && (!limit.most || *value <= *limit.most) &&
         (!limit.least || *value >= *limit.least);
}

std::vector<LimitResult> check_limits(std::span<const mission::Limit> limits, std::span<const Number> numbers) {
  std::vector<LimitResult> results;
  for (const mission::Limit& limit : limits) {
    const auto found = std::ranges::find(numbers, limit.key, &Number::first);
    LimitResult result{.limit = limit, .value = std::nullopt, .met = false, .missed = {}};
    if (found != numbers.end()) result.value = found->second;
    result.met = meets(limit, result.value);
    if (!result.met)
      result.missed = result.value ? fmt::format("{} is {:g}, not {}", limit.key, *result.value, text_of(limit))
                                   : missing(limit.key, numbers);
    results.push_back(std::move(result));
  }
  return results;
}

std::string text_of(const mission::Limit& limit) {
  if (limit.most && limit.least) return fmt::format("{:g} to {:g}", *limit.least, *limit.most);
  return limit.most ? fmt::format("at most {:g}", *limit.most) : fmt::format("at least {:g}", *limit.least);
}

}  // namespace vbar::check
