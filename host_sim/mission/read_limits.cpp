#include <set>

#include "host_sim/mission/extends.h"
#include "host_sim/mission/limit.h"
#include "host_sim/mission/overrides.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

constexpr double kLargest = 1e300;

std::vector<Limit> limits_of(const TableReader& document) {
  std::vector<Limit> limits;
  std::set<std::string> keys;
  for (const TableReader& section : document.tables("limit")) {
    limits.push_back(read_limit(section));
    if (!keys.insert(limits.back().key).second)
      section.refuse_value("key", "a key that no other limit has: one limit holds both most and least");
  }
  return limits;
}

}  // namespace

Limit read_limit(const TableReader& section) {
  Limit limit;
  limit.key = section.text("key");
  if (section.has("most")) limit.most = section.number("most", from_to(-kLargest, kLargest));
  if (section.has("least")) limit.least = section.number("least", from_to(-kLargest, kLargest));
  if (!limit.most && !limit.least) section.refuse("", "neither most nor least", "at least one of them");
  section.finish();
  if (limit.most && limit.least && *limit.least > *limit.most)
    section.refuse_value("least", "a number that is not above most");
  return limit;
}

void read_limits(const TableReader& document, Mission& mission) {
  mission.limits = limits_of(document);
}

std::vector<Limit> load_limits(const std::filesystem::path& file, std::span<const std::string> overrides) {
  toml::table table = parse_toml(read_text_file(file, "a mission file (TOML)"), file.string());
  put_over_extended(table, file);
  for (const std::string& assignment : overrides) apply_override(table, assignment);
  return limits_of(TableReader(table, file.string()));
}

}  // namespace vbar::mission
