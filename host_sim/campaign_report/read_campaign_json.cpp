#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/campaign_report/read_campaign.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign_report {
namespace {

using Json = nlohmann::json;

constexpr int kFormat = 1;

/// An object of the file with its place, for messages.
class Object {
 public:
  Object(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
    if (!json.is_object()) throw std::runtime_error(place_ + ": a JSON object is expected");
  }

  [[noreturn]] void fail(const char* key, const std::string& what) const {
    throw std::runtime_error(fmt::format("{}: key \"{}\": {}", place_, key, what));
  }

  [[nodiscard]] const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(key, "is missing");
    return *found;
  }

  template <class Value>
  [[nodiscard]] Value get(const char* key, const char* accepted) const {
    const Json& value = at(key);
    try {
      return value.get<Value>();
    } catch (const Json::exception&) {
      fail(key, fmt::format("{} is not {}", value.dump(), accepted));
    }
  }

  [[nodiscard]] std::string text(const char* key) const { return get<std::string>(key, "a text"); }
  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    return get<std::vector<std::string>>(key, "a list of texts");
  }

  [[nodiscard]] double number(const char* key) const {
    const double value = get<double>(key, "a number");
    if (!std::isfinite(value)) fail(key, "is not finite");
    return value;
  }

  [[nodiscard]] std::optional<double> number_or_null(const char* key) const {
    return json_.contains(key) && !json_[key].is_null() ? std::optional(number(key)) : std::nullopt;
  }

  [[nodiscard]] double probability(const char* key) const {
    const double value = number(key);
    if (!(value > 0.0 && value < 1.0)) fail(key, fmt::format("{} is not between 0 and 1", value));
    return value;
  }

  [[nodiscard]] Object element(const char* key, std::size_t k) const {
    return {at(key)[k], fmt::format("{}: {}[{}]", place_, key, k)};
  }

 private:
  const Json& json_;
  std::string place_;
};

void refuse_repeated(const Object& object, const char* key, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) object.fail(key, fmt::format("\"{}\" occurs twice", name));
}

/// Limits of one key are one limit with both sides.
std::vector<Limit> limits_of(const Object& object) {
  if (!object.at("pass").is_array()) object.fail("pass", "a list is expected");
  std::vector<Limit> limits;
  for (std::size_t k = 0; k < object.at("pass").size(); ++k) {
    const Object pass = object.element("pass", k);
    const Limit limit{pass.text("key"), pass.number_or_null("most"), pass.number_or_null("least")};
    if (!limit.max && !limit.min) pass.fail("most", "neither \"most\" nor \"least\" is given");
    Limit* same = nullptr;
    for (Limit& other : limits)
      if (other.key == limit.key) same = &other;
    if (same == nullptr) same = &limits.emplace_back(Limit{limit.key, std::nullopt, std::nullopt});
    if (limit.max) same->max = same->max ? std::min(*same->max, *limit.max) : *limit.max;
    if (limit.min) same->min = same->min ? std::max(*same->min, *limit.min) : *limit.min;
  }
  return limits;
}

std::optional<Requirement> requirement_of(const Object& object, const std::string& place) {
  const Json& require = object.at("require");
  if (require.is_null()) return std::nullopt;
  const Object given(require, place + ": require");
  return Requirement{given.probability("pass_rate_at_least"), given.probability("confidence")};
}

Json parsed(const std::filesystem::path& file) {
  try {
    return Json::parse(files::read_text_file(file));
  } catch (const Json::exception& error) {
    throw std::runtime_error(fmt::format("{}: not a JSON file: {}", file.string(), error.what()));
  }
}

}  // namespace

Campaign read_campaign_json(const std::filesystem::path& file, std::size_t& number_of_cases) {
  const Json json = parsed(file);
  const Object object(json, file.string());
  const auto format = object.get<int>("format", "an integer");
  if (format != kFormat) object.fail("format", fmt::format("{} is not supported; accepted: {}", format, kFormat));
  number_of_cases = object.get<std::size_t>("cases", "a number of cases");

  Campaign campaign;
  campaign.name = object.text("name");
  campaign.description = object.text("description");
  campaign.mission = object.text("mission");
  campaign.vbar_version = object.text("vbar_version");
  campaign.program_sha256 = object.text("program_sha256");
  campaign.keys = object.texts("keys");
  refuse_repeated(object, "keys", campaign.keys);
  campaign.swept = object.texts("swept");
  refuse_repeated(object, "swept", campaign.swept);
  for (const std::string& key : campaign.swept)
    if (std::ranges::find(campaign.keys, key) == campaign.keys.end())
      object.fail("swept", fmt::format("\"{}\" is not in \"keys\"", key));
  campaign.limits = limits_of(object);
  campaign.samples_h = object.get<std::vector<double>>("samples_h", "a list of numbers");
  campaign.requirement = requirement_of(object, file.string());
  campaign.is_independent = object.get<bool>("independent", "true or false");
  return campaign;
}

}  // namespace vbar::campaign_report
