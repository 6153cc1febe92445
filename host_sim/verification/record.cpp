#include "host_sim/verification/record.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "host_sim/campaign/status.h"
#include "host_sim/campaign/worker.h"
#include "host_sim/campaign_report/requirement.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/own_program.h"
#include "host_sim/report/paper_results.h"
#include "host_sim/report/statistics.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::verification {

namespace {

namespace fs = std::filesystem;
using campaign_report::Campaign;
using campaign_report::Statistic;

constexpr int kFormat = 1;
constexpr double kConfidence = 0.95;
constexpr int kDigits = 6;  // of the values of cases: less than their scatter, enough for ranks

bool is_campaign(const fs::path& folder) {
  return fs::is_regular_file(campaign::Folder(folder).plan());
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(std::stod(fmt::format("{:.{}g}", value, kDigits))) : Json(nullptr);
}

/// Leaves out the cases that are still to be flown: beyond the budget, or interrupted.
Campaign with_flown_cases(Campaign campaign) {
  using campaign_report::State;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
    const State state = campaign.cases[k].state;
    if (state != State::kNotBegun && state != State::kFlying && state != State::kKilled) kept.push_back(k);
  }
  const auto select = [&kept](auto& all) {
    std::remove_reference_t<decltype(all)> some;
    for (const std::size_t k : kept) some.push_back(all[k]);
    all = std::move(some);
  };
  select(campaign.cases);
  for (campaign_report::Figure& figure : campaign.figures) select(figure.values);
  return campaign;
}

/// "vbar run experiment3 --seed 7 --set 'truth.threads=2'"
std::string command_of(const campaign::Plan& plan, const campaign::Case& one) {
  std::string command = fmt::format("vbar run {} --seed {}", plan.mission, one.seed);
  const auto set = [&command](const std::string& assignment) { command += fmt::format(" --set '{}'", assignment); };
  for (const std::string& assignment : plan.set) set(assignment);
  for (std::size_t k = 0; k < plan.keys.size(); ++k) set(plan.keys[k] + "=" + one.values[k]);
  return command;
}

/// Values of a figure with their cases; a case without it, or not flown to an end, has none.
std::vector<double> values_of(const Campaign& campaign, const std::string& key) {
  const campaign_report::Figure* const figure = campaign.figure(key);
  std::vector<double> values;
  for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
    const bool is_known = figure != nullptr && campaign.cases[k].is_complete();
    values.push_back(is_known ? figure->values[k] : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

Json quantity(const Campaign& campaign, const std::string& key, bool is_smaller_worse,
              const campaign::Standing& standing) {
  // By badness, so that a case without the figure is the worst.
  std::vector<std::pair<double, std::size_t>> order;
  const std::vector<double> values = values_of(campaign, key);
  Json all = Json::array();
  std::size_t missing = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const bool is_missing = std::isnan(values[k]);
    missing += is_missing ? 1 : 0;
    const double badness = is_smaller_worse ? -values[k] : values[k];
    order.emplace_back(is_missing ? std::numeric_limits<double>::infinity() : badness, k);
    all.push_back(number_or_null(values[k]));
  }
  std::ranges::sort(order);
  std::vector<double> sorted;
  for (const auto& [badness, k] : order) sorted.push_back(is_smaller_worse ? -badness : badness);
  Json json{{"key", key},
            {"worse", is_smaller_worse ? "smaller" : "larger"},
            {"n", values.size()},
            {"missing", missing},
            {"median", number_or_null(report::quantile(sorted, 0.5))},
            {"p90", number_or_null(report::quantile(sorted, 0.9))},
            {"worst", number_or_null(sorted.back())}};
  const campaign::Case& worst = standing.cases[campaign.cases[order.back().second].number];
  json["worst_seed"] = worst.seed;
  json["worst_command"] = command_of(standing.plan, worst);
  json["values"] = all;
  return json;
}

/// Quantities of the requirements and criteria, each once.
Json quantities(const Campaign& campaign, const campaign::Standing& standing) {
  Json all = Json::array();
  std::set<std::string> seen;
  const auto add = [&](const std::string& key, bool is_smaller_worse) {
    if (!key.empty() && seen.insert(key).second) all.push_back(quantity(campaign, key, is_smaller_worse, standing));
  };
  for (const campaign_report::Requirement& one : campaign.requirements) add(one.key, !one.most.has_value());
  for (const campaign_report::Limit& limit : campaign.limits) add(limit.key, !limit.max.has_value());
  return all;
}

/// The requirement that all cases pass, of a campaign with criteria but without a requirement on a share of them.
void add_criteria(const Campaign& campaign, Json& requirements) {
  const auto is_share = [](const campaign_report::Requirement& one) { return one.statistic == Statistic::kPassRate; };
  if (campaign.limits.empty() || std::ranges::any_of(campaign.requirements, is_share)) return;
  const auto passed = std::ranges::count_if(campaign.cases, &campaign_report::Case::has_passed);
  const auto all = static_cast<std::ptrdiff_t>(campaign.cases.size());
  requirements.push_back({{"subject", "cases that keep all limits"},
                          {"limit", fmt::format("{}", all)},
                          {"value", passed},
                          {"text", fmt::format("{}", passed)},
                          {"met", passed == all}});
}

/// The requirement that flight computers give the same bits, of a campaign that sweeps them.
void add_same_bits(const campaign::Standing& standing, Json& requirements) {
  const auto names_computer = [](const std::string& key) { return key.find("flight_computer.target") != key.npos; };
  if (std::ranges::none_of(standing.plan.swept, names_computer)) return;
  std::map<std::uint64_t, std::vector<const campaign::Result*>> of_seed;
  for (const auto& [number, result] : standing.results.of_case) of_seed[standing.cases[number].seed].push_back(&result);
  std::size_t same = 0, all = 0;
  for (const auto& [seed, results] : of_seed) {
    for (const campaign::Result* const result : results) {
      ++all;
      same += result->state == campaign::State::kComplete && result->has_same_outputs(*results.front()) ? 1 : 0;
    }
  }
  requirements.push_back({{"subject", "cases with the commands and telemetry of the first computer"},
                          {"limit", fmt::format("{}", all)},
                          {"value", same},
                          {"text", fmt::format("{}", same)},
                          {"met", same == all}});
}

Json requirement_json(const campaign_report::JudgedRequirement& judged) {
  const campaign_report::Requirement& one = judged.requirement;
  Json json{{"subject", campaign_report::subject_of(one)}, {"statistic", campaign_report::name_of(one.statistic)}};
  if (!one.key.empty()) json["key"] = one.key;
  json["limit"] = campaign_report::limit_of(one);
  if (judged.value) {
    json["value"] = *judged.value;
    json["text"] = campaign_report::value_of(one, *judged.value);
  }
  if (judged.bound) {
    json["bound"] = *judged.bound;
    json["bound_text"] = campaign_report::value_of(one, *judged.bound);
  }
  json["missing"] = judged.missing.size();
  json["met"] = judged.met;
  if (!one.paper.empty()) {
    const std::optional<double> cell = report::find_paper_cell(one.paper);
    if (!cell)
      throw std::runtime_error(
          fmt::format("requirement on {}: paper = \"{}\" is not a cell of the paper (host_sim/report/paper_results.h)",
                      one.key, one.paper));
    json["paper"] = {{"cell", one.paper}, {"value", *cell}};
  }
  return json;
}

Json head_of(const Row& row, std::size_t flown) {
  return {{"name", row.name},
          {"title", row.campaign.description.empty() ? row.name : row.campaign.description},
          {"seeds_asked", row.seeds()},
          {"seeds_flown", flown},
          {"cases_per_seed", row.cases_per_seed}};
}

/// "achieved", or "achieved with faults"
bool is_achieved(const campaign_report::Case& one) {
  return one.is_complete() && one.verdict.starts_with("achieved");
}

/// A flight to its end without waypoints, safety or limits: there is nothing to achieve.
bool is_without_verdict(const campaign_report::Case& one) {
  return one.is_complete() && one.verdict == "not judged";
}

Json share_of(const Campaign& campaign) {
  const auto achieved = std::ranges::count_if(campaign.cases, is_achieved);
  const auto judged =
      campaign.cases.size() - static_cast<std::size_t>(std::ranges::count_if(campaign.cases, is_without_verdict));
  const campaign_report::PassRate rate =
      campaign_report::pass_rate(static_cast<std::size_t>(achieved), judged, kConfidence);
  return {{"count", achieved}, {"of", judged}, {"confidence", kConfidence}, {"lower", rate.lower}};
}

Json failures_of(const Campaign& campaign, const campaign::Standing& standing) {
  Json all = Json::array();
  for (const campaign_report::Case& one : campaign.cases)
    if (!one.has_passed() || (!is_achieved(one) && !is_without_verdict(one)))
      all.push_back({{"command", command_of(standing.plan, standing.cases[one.number])},
                     {"state", campaign_report::name_of(one.state)},
                     {"verdict", one.verdict},
                     {"reason", one.reason.empty() ? one.failed_limits : one.reason}});
  return all;
}

std::string date_now() {
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

std::size_t seeds_flown(const Row& row, const fs::path& folder) {
  if (!is_campaign(folder)) return 0;
  const campaign::Standing standing = campaign::read_standing(campaign::Folder(folder));
  static const std::optional<std::string> own_program_sha256 = files::sha256_of_file(files::own_program_bytes());
  if (standing.plan.program_sha256 != own_program_sha256)
    throw app::Refused(folder.string() + ": was flown by another program; name another folder with --to");
  std::map<std::uint64_t, std::size_t> of_seed;
  for (const auto& [number, result] : standing.results.of_case) ++of_seed[standing.cases[number].seed];
  return static_cast<std::size_t>(
      std::ranges::count_if(of_seed, [&](const auto& one) { return one.second >= row.cases_per_seed; }));
}

Json record_of(const Row& row, const fs::path& folder) {
  const std::size_t flown = seeds_flown(row, folder);
  Json json = head_of(row, flown);
  if (!is_campaign(folder)) return json;
  const campaign::Folder campaign_folder(folder);
  const campaign::Standing standing = campaign::read_standing(campaign_folder);
  campaign::write_results(campaign_folder, standing);
  const Campaign campaign = with_flown_cases(campaign_report::read_campaign(folder));
  json["cases_flown"] = campaign.cases.size();
  if (campaign.cases.empty()) return json;
  double cpu_s = 0.0;
  std::map<std::string, std::size_t> verdicts, states;
  for (const campaign_report::Case& one : campaign.cases) {
    if (std::isfinite(one.cpu_s)) cpu_s += one.cpu_s;
    ++states[std::string(campaign_report::name_of(one.state))];
    if (one.is_complete()) ++verdicts[one.verdict];
  }
  json["mission"] = campaign.mission;
  json["core_hours"] = cpu_s / 3600.0;
  json["states"] = states;
  json["verdicts"] = verdicts;
  json["achieved"] = share_of(campaign);
  Json requirements = Json::array();
  for (const auto& judged : campaign_report::judge_requirements(campaign, folder.string()))
    requirements.push_back(requirement_json(judged));
  add_criteria(campaign, requirements);
  add_same_bits(standing, requirements);
  json["requirements"] = requirements;
  json["quantities"] = quantities(campaign, standing);
  json["not_achieved"] = failures_of(campaign, standing);
  return json;
}

std::string verification_json(const std::vector<Row>& rows, const fs::path& folder, const campaign::Build& build) {
  const campaign::Computer computer = campaign::this_computer();
  Json json{{"format", kFormat},
            {"vbar_version", build.version},
            {"commit", build.commit},
            {"date", date_now()},
            {"processor", computer.processor}};
  Json all = Json::array();
  for (const Row& row : rows) all.push_back(record_of(row, folder / row.name));
  json["rows"] = all;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json read_verification(const fs::path& file) {
  Json json = report::read_json_file(file);
  const report::JsonObject object(json, file.string());
  if (const auto format = object.get<int>("format", "an integer"); format != kFormat)
    object.fail("format", fmt::format("{} is not supported; accepted: {}", format, kFormat));
  for (const char* const key : {"vbar_version", "commit", "date", "processor"}) static_cast<void>(object.text(key));
  for (const report::JsonObject& row : object.objects("rows")) {
    for (const char* const key : {"name", "title"}) static_cast<void>(row.text(key));
    for (const char* const key : {"seeds_asked", "seeds_flown", "cases_per_seed"}) static_cast<void>(row.count(key));
    if (!row.has("requirements")) continue;
    static_cast<void>(row.number("core_hours"));
    if (row.count("cases_per_seed") == 0) row.fail("cases_per_seed", "0 is not a number from 1 on");
    for (const report::JsonObject& one : row.objects("requirements")) {
      static_cast<void>(one.text("subject"));
      static_cast<void>(one.text("limit"));
      static_cast<void>(one.flag("met"));
    }
    for (const report::JsonObject& one : row.objects("quantities")) {
      static_cast<void>(one.text("key"));
      static_cast<void>(one.text("worse"));
      static_cast<void>(one.get<std::vector<Json>>("values", "a list of numbers"));
    }
  }
  return json;
}

bool is_flown(const Json& row) {
  return row.contains("requirements");
}

bool is_met(const Json& row) {
  return is_flown(row) &&
         std::ranges::all_of(row["requirements"], [](const Json& one) { return one["met"].get<bool>(); });
}

double value_or_lost(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

bool is_smaller_worse(const Json& quantity) {
  return quantity["worse"] == "smaller";
}

const Json* quantity_of(const Json& row, const std::string& key) {
  if (!row.contains("quantities")) return nullptr;
  for (const Json& one : row["quantities"])
    if (one["key"] == key) return &one;
  return nullptr;
}

}  // namespace vbar::verification
