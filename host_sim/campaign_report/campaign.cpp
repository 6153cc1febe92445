#include "host_sim/campaign_report/campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"

namespace vbar::campaign_report {

const Figure* Campaign::figure(std::string_view key) const {
  const auto found = std::ranges::find(figures, key, &Figure::key);
  return found == figures.end() ? nullptr : &*found;
}

std::string_view name_of(State state) {
  switch (state) {
    case State::kNotBegun:
      return "not begun";
    case State::kFlying:
      return "flying";
    case State::kComplete:
      return "complete";
    case State::kFailed:
      return "failed";
    case State::kOverTime:
      return "over time";
    case State::kKilled:
      return "killed";
    case State::kLost:
      return "lost";
    case State::kVoid:
      return "void";
  }
  return "unknown";
}

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

namespace {

constexpr std::array kStates{std::pair{"not_begun", State::kNotBegun}, std::pair{"flying", State::kFlying},
                             std::pair{"complete", State::kComplete},  std::pair{"failed", State::kFailed},
                             std::pair{"over_time", State::kOverTime}, std::pair{"killed", State::kKilled},
                             std::pair{"lost", State::kLost},          std::pair{"void", State::kVoid}};

/// Columns of the results that are neither inputs nor figures of the summaries. `folder` is the last before the
/// figures.
constexpr std::array<const char*, 15> kColumns{
    "case",      "seed",   "state", "passed",          "failed_limits",    "reason",           "attempts", "host",
    "processor", "wall_s", "cpu_s", "commands_sha256", "telemetry_sha256", "waypoints_sha256", "folder"};

/// The table with places for messages.
class Results {
 public:
  explicit Results(const std::filesystem::path& file) : file_(file.string()), lines_(report::read_lines(file)) {
    if (lines_.empty()) throw std::runtime_error(file_ + ": is empty");
    if (!report::split_cells(lines_.front(), names_)) fail("a quote is not closed");
    for (std::size_t k = 0; k < names_.size(); ++k)
      if (!places_.emplace(names_[k], k).second) fail(fmt::format("column \"{}\" occurs twice", names_[k]));
  }

  /// Returns false behind the last line.
  bool next() {
    if (++line_ >= lines_.size()) return false;
    if (!report::split_cells(lines_[line_], cells_)) fail("a quote is not closed");
    if (cells_.size() != names_.size())
      fail(fmt::format("{} cells, although there are {} columns", cells_.size(), names_.size()));
    return true;
  }

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] std::size_t place(const std::string& column) const {
    const auto found = places_.find(column);
    if (found == places_.end()) throw std::runtime_error(fmt::format("{}: no column \"{}\"", file_, column));
    return found->second;
  }
  [[nodiscard]] const std::string& cell(std::size_t place) const { return cells_[place]; }
  /// Returns an empty text without that column.
  [[nodiscard]] std::string optional_cell(const std::string& column) const {
    const auto found = places_.find(column);
    return found == places_.end() ? std::string() : cells_[found->second];
  }

  /// A number; NaN of an empty cell.
  [[nodiscard]] double number(std::size_t place) const {
    double value = 0.0;
    if (!report::read_value(cells_[place], value)) fail_cell(place, "a finite number or nothing");
    return value;
  }
  [[nodiscard]] std::uint64_t count(std::size_t place) const {
    std::uint64_t value = 0;
    if (!report::read_value(cells_[place], value)) fail_cell(place, "an integer");
    return value;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", file_, line_ + 1, what));
  }
  [[noreturn]] void fail_cell(std::size_t place, const std::string& accepted) const {
    fail(fmt::format("column \"{}\": \"{}\" is not {}", names_[place], cells_[place], accepted));
  }

 private:
  std::string file_;
  std::vector<std::string> lines_, names_, cells_;
  std::map<std::string, std::size_t> places_;
  std::size_t line_ = 0;
};

/// Places of the columns of a case.
struct Places {
  std::map<std::string, std::size_t> own;
  std::vector<std::size_t> inputs, figures;
};

Places places_of(const Results& results, const Campaign& campaign) {
  Places places;
  for (const char* const column : kColumns) places.own[column] = results.place(column);
  for (const std::string& key : campaign.keys) places.inputs.push_back(results.place(key));
  for (std::size_t k = places.own["folder"] + 1; k < results.names().size(); ++k) places.figures.push_back(k);
  return places;
}

State state_of(const Results& results, std::size_t place) {
  const auto* const found = std::ranges::find(kStates, results.cell(place), [](const auto& s) { return s.first; });
  if (found != kStates.end()) return found->second;
  std::string accepted;
  for (const auto& [word, state] : kStates) accepted.append(accepted.empty() ? "" : ", ").append(word);
  results.fail_cell(place, "a state; accepted: " + accepted);
}

std::optional<bool> passed_of(const Results& results, std::size_t place, State state) {
  const std::string& cell = results.cell(place);
  const bool is_known = cell == "0" || cell == "1";
  if (state == State::kComplete ? !is_known : !(cell.empty() || cell == "0"))
    results.fail_cell(place, state == State::kComplete ? "0 or 1" : "0 or nothing, as the case is not complete");
  return is_known ? std::optional(cell == "1") : std::nullopt;
}

Case case_of(const Results& results, const Places& places) {
  const auto at = [&](const char* column) { return places.own.at(column); };
  Case one;
  one.number = results.count(at("case"));
  one.seed = results.cell(at("seed"));
  for (const std::size_t place : places.inputs) one.inputs.push_back(results.cell(place));
  one.state = state_of(results, at("state"));
  one.passed = passed_of(results, at("passed"), one.state);
  one.failed_limits = results.cell(at("failed_limits"));
  one.reason = results.cell(at("reason"));
  one.verdict = results.optional_cell("verdict");
  one.host = results.cell(at("host"));
  one.processor = results.cell(at("processor"));
  one.folder = results.cell(at("folder"));
  one.attempts = results.cell(at("attempts")).empty() ? 0 : results.count(at("attempts"));
  one.wall_s = results.number(at("wall_s"));
  one.cpu_s = results.number(at("cpu_s"));
  return one;
}

/// A case that broke a limit has not passed, one that kept all has. Every limit is on one of the columns of figures.
void check_against_limits(const Results& results, const Case& one, const std::vector<Limit>& limits,
                          const std::vector<std::size_t>& places) {
  if (!one.is_complete()) return;
  bool keeps_all = true;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const double value = results.number(places[k]);
    const bool keeps = !(limits[k].max && !(value <= *limits[k].max)) && !(limits[k].min && !(value >= *limits[k].min));
    keeps_all = keeps_all && keeps;
    if (keeps || !*one.passed) continue;
    results.fail(fmt::format("case {} is marked as passed, although \"{}\" is {} (at most {}, at least {})", one.number,
                             limits[k].key, std::isnan(value) ? "missing" : fmt::format("{}", value),
                             limits[k].max ? fmt::format("{}", *limits[k].max) : "any",
                             limits[k].min ? fmt::format("{}", *limits[k].min) : "any"));
  }
  if (keeps_all && !*one.passed && one.reason.empty())
    results.fail(fmt::format("case {} is marked as not passed, although it is within all limits", one.number));
}

/// The cases of a file in order of their numbers, whatever the order of its lines.
void sort_by_number(const std::string& file, Campaign& campaign) {
  std::vector<std::size_t> order(campaign.cases.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::sort(order, {}, [&](std::size_t k) { return campaign.cases[k].number; });
  std::vector<Case> cases;
  for (const std::size_t k : order) cases.push_back(std::move(campaign.cases[k]));
  for (std::size_t k = 0; k + 1 < cases.size(); ++k)
    if (cases[k].number == cases[k + 1].number)
      throw std::runtime_error(fmt::format("{}: case {} occurs twice", file, cases[k].number));
  campaign.cases = std::move(cases);
  for (Figure& figure : campaign.figures) {
    std::vector<double> values;
    for (const std::size_t k : order) values.push_back(figure.values[k]);
    figure.values = std::move(values);
  }
}

}  // namespace

void read_results(const std::filesystem::path& file, std::size_t number_of_cases, Campaign& campaign) {
  Results results(file);
  const Places places = places_of(results, campaign);
  for (const std::size_t place : places.figures) campaign.figures.push_back({results.names()[place], {}});
  std::vector<std::size_t> limit_places;
  while (results.next()) {
    const Case one = case_of(results, places);
    if (one.is_complete() && limit_places.empty())
      for (const Limit& limit : campaign.limits) limit_places.push_back(results.place(limit.key));
    check_against_limits(results, one, campaign.limits, limit_places);
    campaign.cases.push_back(one);
    for (std::size_t k = 0; k < places.figures.size(); ++k)
      campaign.figures[k].values.push_back(results.number(places.figures[k]));
  }
  if (campaign.cases.size() != number_of_cases)
    throw std::runtime_error(fmt::format("{}: {} cases, although campaign.json says {}", file.string(),
                                         campaign.cases.size(), number_of_cases));
  sort_by_number(file.string(), campaign);
}

Campaign read_campaign(const std::filesystem::path& folder) {
  std::size_t number_of_cases = 0;
  Campaign campaign = read_campaign_json(folder / "campaign.json", number_of_cases);
  read_results(folder / "results.csv", number_of_cases, campaign);
  return campaign;
}

}  // namespace vbar::campaign_report
