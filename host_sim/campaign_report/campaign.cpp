#include "host_sim/campaign_report/campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/campaign_report/requirement.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/json_file.h"

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

using report::JsonObject;

constexpr int kFormat = 1;

void refuse_repeated(const JsonObject& object, const char* key, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) object.fail(key, fmt::format("\"{}\" occurs twice", name));
}

/// Limits of one key are one limit with both sides.
std::vector<Limit> limits_of(const JsonObject& object) {
  std::vector<Limit> limits;
  for (const JsonObject& pass : object.objects("pass")) {
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

}  // namespace

Campaign read_campaign_json(const std::filesystem::path& file, std::size_t& number_of_cases) {
  const report::Json json = report::read_json_file(file);
  const JsonObject object(json, file.string());
  const auto format = object.get<int>("format", "an integer");
  if (format != kFormat) object.fail("format", fmt::format("{} is not supported; accepted: {}", format, kFormat));
  number_of_cases = object.count("cases");

  Campaign campaign;
  campaign.name = object.text("name");
  campaign.description = object.text("description");
  campaign.mission = object.text("mission");
  campaign.vbar_version = object.text("vbar_version");
  campaign.program_sha256 = object.text("program_sha256");
  campaign.commit = object.text_or("commit", "");
  campaign.seeds_from = object.text_or("seeds_from", "");
  campaign.keys = object.texts("keys");
  refuse_repeated(object, "keys", campaign.keys);
  campaign.swept = object.texts("swept");
  refuse_repeated(object, "swept", campaign.swept);
  for (const std::string& key : campaign.swept)
    if (std::ranges::find(campaign.keys, key) == campaign.keys.end())
      object.fail("swept", fmt::format("\"{}\" is not in \"keys\"", key));
  campaign.limits = limits_of(object);
  campaign.samples_h = object.get<std::vector<double>>("samples_h", "a list of numbers");
  campaign.requirements = requirements_of(object);
  campaign.is_independent = object.flag("independent");
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
  Results(const std::filesystem::path& file, std::vector<std::string> lines)
      : file_(file.string()), lines_(std::move(lines)) {
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

void read_results(const std::filesystem::path& file, std::vector<std::string> lines, std::size_t number_of_cases,
                  Campaign& campaign) {
  Results results(file, std::move(lines));
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
  return read_campaign(folder, report::read_lines(folder / "results.csv"));
}

Campaign read_campaign(const std::filesystem::path& folder, std::vector<std::string> results) {
  std::size_t number_of_cases = 0;
  Campaign campaign = read_campaign_json(folder / "campaign.json", number_of_cases);
  read_results(folder / "results.csv", std::move(results), number_of_cases, campaign);
  return campaign;
}

}  // namespace vbar::campaign_report
