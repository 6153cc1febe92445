#include "host_sim/simulation/limit_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "host_sim/mission/name_search.h"

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

namespace {

long long failures_of(const JunitSuite& suite) {
  return std::ranges::count_if(suite.cases, [](const JunitCase& one) { return !one.failure.empty(); });
}

void add(pugi::xml_node& parent, const JunitCase& one, const std::string& suite) {
  pugi::xml_node node = parent.append_child("testcase");
  node.append_attribute("classname") = suite.c_str();
  node.append_attribute("name") = one.name.c_str();
  if (!one.failure.empty()) node.append_child("failure").append_attribute("message") = one.failure.c_str();
}

void add(pugi::xml_node& parent, const JunitSuite& suite) {
  pugi::xml_node node = parent.append_child("testsuite");
  node.append_attribute("name") = suite.name.c_str();
  node.append_attribute("tests") = static_cast<unsigned long long>(suite.cases.size());
  node.append_attribute("failures") = failures_of(suite);
  node.append_attribute("errors") = 0;
  node.append_attribute("time") = fmt::format("{:.3f}", suite.duration_s).c_str();
  for (const JunitCase& one : suite.cases) add(node, one, suite.name);
}

}  // namespace

std::string junit_xml(const std::vector<JunitSuite>& suites) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "utf-8";
  pugi::xml_node all = document.append_child("testsuites");
  for (const JunitSuite& suite : suites) add(all, suite);
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace vbar::check
