#include "host_sim/campaign_report/drivers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"

namespace vbar::campaign_report {
namespace {

std::string_view without_spaces(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> number_of(std::string_view text) {
  text = without_spaces(text);
  if (text == "true" || text == "false") return text == "true" ? 1.0 : 0.0;
  double value = 0.0;
  return !text.empty() && report::read_value(text, value) ? std::optional(value) : std::nullopt;
}

/// The numbers of "0.5" or "[1.0, 2.0, 3.0]"; none if one is not a number.
std::vector<double> numbers_of(std::string_view text) {
  text = without_spaces(text);
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::optional<double> number = number_of(text.substr(start, end - start));
    if (!number) return {};
    numbers.push_back(*number);
    start = end + 1;
  }
  return numbers;
}

bool is_constant(const std::vector<double>& values) {
  return std::ranges::all_of(values, [&](double v) { return v == values.front(); });
}

}  // namespace

std::vector<Driver> drivers(const Campaign& campaign, std::vector<std::string>& others) {
  std::vector<Driver> all;
  for (std::size_t key = 0; key < campaign.keys.size(); ++key) {
    std::vector<std::vector<double>> components;
    for (const Case& one : campaign.cases) {
      const std::vector<double> numbers = numbers_of(one.inputs[key]);
      if (components.empty()) components.resize(numbers.size());
      if (numbers.empty() || numbers.size() != components.size()) {
        components.clear();
        break;
      }
      for (std::size_t k = 0; k < numbers.size(); ++k) components[k].push_back(numbers[k]);
    }
    const std::size_t before = all.size();
    for (std::size_t k = 0; k < components.size(); ++k) {
      if (is_constant(components[k])) continue;
      all.push_back({components.size() == 1 ? campaign.keys[key] : fmt::format("{}[{}]", campaign.keys[key], k),
                     std::move(components[k])});
    }
    if (all.size() == before) others.push_back(campaign.keys[key]);
  }
  return all;
}

std::vector<Response> responses(const Campaign& campaign, const std::vector<Quantity>& quantities) {
  std::vector<Response> all;
  for (const Quantity& quantity : quantities) all.push_back({quantity.key, quantity.values, &quantity});
  Response failure{"not passed", {}, nullptr};
  for (const Case& one : campaign.cases)
    failure.values.push_back(!one.is_judged()   ? std::numeric_limits<double>::quiet_NaN()
                             : one.has_passed() ? 0.0
                                                : 1.0);
  all.push_back(std::move(failure));
  return all;
}

std::vector<Dependence> dependences(const std::vector<Driver>& drivers, const std::vector<Response>& responses) {
  std::vector<Dependence> all;
  std::vector<double> p_values;
  for (const Driver& driver : drivers) {
    for (const Response& response : responses) {
      const auto correlation = spearman(driver.values, response.values);
      if (!correlation) continue;
      all.push_back({&driver, &response, *correlation, 1.0});
      p_values.push_back(correlation->p_value);
    }
  }
  const std::vector<double> adjusted = holm(p_values);
  for (std::size_t k = 0; k < all.size(); ++k) all[k].adjusted_p = adjusted[k];
  std::ranges::stable_sort(all, std::greater{}, [](const Dependence& d) { return std::abs(d.correlation.rho); });
  return all;
}

}  // namespace vbar::campaign_report
