#pragma once
// One [[spacecraft]] section for many spacecraft: `count` of them, each offset by `spacing` from the previous one.
//
//   [[spacecraft]]
//   name = "swarm"                     swarm_01, swarm_02, ... swarm_50
//   count = 50
//   spacing = { raan_deg = 7.2, mean_argument_of_latitude_deg = 136.8, mass_kg = 0.5 }
//   [spacecraft.elements]              of the first one
//   ...

#include <optional>
#include <string>
#include <string_view>

#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

class SpacecraftGroup {
 public:
  /// Reads `name`, `count` and `spacing` of a [[spacecraft]] section, which must outlive the group. Throws
  /// MissionError.
  explicit SpacecraftGroup(const TableReader& section);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int count() const { return count_; }

  /// Returns the name of a member: `<name>_<member>`, counted from 1 with as many digits as the last has; the name
  /// alone without a `count`.
  [[nodiscard]] std::string member_name(int member) const;

  /// Reads a number as section.number() does, plus `member` (0, 1, ...) times the spacing of that key. The sum must lie
  /// in the range too.
  [[nodiscard]] double number(const TableReader& section, int member, std::string_view key, Range range,
                              std::optional<double> default_value = std::nullopt) const;

  /// Returns an angle in degrees as number() does; the sum is wrapped to -180 ... 180.
  [[nodiscard]] double angle_deg(const TableReader& section, int member, std::string_view key) const;

 private:
  [[nodiscard]] double shift(int member, std::string_view key) const;

  std::string name_;
  bool counted_;
  int count_;
  TableReader spacing_;
};

}  // namespace vbar::mission
