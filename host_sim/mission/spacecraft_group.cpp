#include "host_sim/mission/spacecraft_group.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::mission {
namespace {

constexpr int kMaxSpacecraft = 255;  // range of the numbers in packet headers
constexpr double kTurn_deg = 360.0;

}  // namespace

SpacecraftGroup::SpacecraftGroup(const TableReader& section)
    : name_(section.name("name")),
      counted_(section.has("count")),
      count_(static_cast<int>(section.integer("count", 1, kMaxSpacecraft, 1))),
      spacing_(section.table("spacing")) {
  spacing_.rename("spacecraft." + name_ + ".spacing");
  if (section.has("spacing") && !counted_) section.refuse("count", "nothing", "how many spacecraft the spacing is for");
  if (count_ > 1 && section.has("relative"))
    section.refuse("relative", "one place for " + std::to_string(count_) + " spacecraft", "elements, with a spacing");
}

std::string SpacecraftGroup::member_name(int member) const {
  if (!counted_) return name_;
  return fmt::format("{}_{:0{}}", name_, member + 1, std::to_string(count_).size());
}

double SpacecraftGroup::shift(int member, std::string_view key) const {
  constexpr double kLargest = 1e6;
  return member * spacing_.number(key, from_to(-kLargest, kLargest), 0.0);
}

double SpacecraftGroup::number(const TableReader& section, int member, std::string_view key, Range range,
                               std::optional<double> default_value) const {
  const double value = section.number(key, range, default_value) + shift(member, key);
  const bool good = (range.above ? value > range.low : value >= range.low) && value <= range.high;
  if (!good)
    spacing_.refuse(key, fmt::format("{:.10g} for {}", value, member_name(member)), "a number " + text_of(range));
  return value;
}

double SpacecraftGroup::angle_deg(const TableReader& section, int member, std::string_view key) const {
  const double value = section.number(key, from_to(-kTurn_deg, kTurn_deg)) + shift(member, key);
  return std::abs(value) <= kTurn_deg ? value : std::remainder(value, kTurn_deg);
}

}  // namespace vbar::mission
