#include "host_sim/campaign_report/requirement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/statistics.h"
#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {

namespace {

constexpr std::array kStatistics{std::pair{Statistic::kMedian, std::string_view("median")},
                                 std::pair{Statistic::kMean, std::string_view("mean")},
                                 std::pair{Statistic::kWorst, std::string_view("worst")},
                                 std::pair{Statistic::kPercentile, std::string_view("percentile")},
                                 std::pair{Statistic::kShare, std::string_view("share")},
                                 std::pair{Statistic::kPassRate, std::string_view("pass_rate")}};

bool is_share(Statistic statistic) {
  return statistic == Statistic::kShare || statistic == Statistic::kPassRate;
}

bool keeps(const Requirement& requirement, double value) {
  return requirement.most ? value <= *requirement.most : value >= *requirement.least;
}

WorstCase worst_case(const Campaign& campaign, std::size_t place, std::optional<double> value,
                     const std::string& folder) {
  const Case& one = campaign.cases[place];
  return {one.number, one.seed, value, rerun_command(folder, one)};
}

/// The statistic of sorted values, of which there is one at least.
double statistic_of(const Requirement& requirement, const std::vector<double>& sorted) {
  switch (requirement.statistic) {
    case Statistic::kMedian:
      return report::quantile(sorted, 0.5);
    case Statistic::kMean:
      return std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
    case Statistic::kPercentile:
      return report::quantile(sorted, requirement.percentile / 100.0);
    case Statistic::kWorst:
    case Statistic::kShare:
    case Statistic::kPassRate:
      break;
  }
  return requirement.most ? sorted.back() : sorted.front();
}

std::string confidence_text(const Requirement& requirement) {
  return fmt::format("{:g} % confidence, two-sided", 100.0 * *requirement.confidence);
}

/// Why there is no bound of a percentile.
std::string no_bound_text(const Requirement& requirement, bool is_independent) {
  if (!is_independent) return "; the cases of a Latin hypercube have no bound, as they are not an independent sample";
  const double share = requirement.percentile / 100.0;
  return fmt::format("; too few cases for a bound at {}: {} are needed", confidence_text(requirement),
                     values_needed(requirement.most ? share : 1.0 - share, *requirement.confidence));
}

/// Fills all but the sentence. Returns what the sentence says of the statistic.
std::string judge_figure(const Campaign& campaign, const std::string& folder, JudgedRequirement& judged) {
  const Requirement& requirement = judged.requirement;
  const Figure* const figure = campaign.figure(requirement.key);
  std::vector<std::pair<double, std::size_t>> places;  // values with the places of their cases
  for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
    const bool has_value = figure != nullptr && campaign.cases[k].is_complete() && std::isfinite(figure->values[k]);
    if (has_value)
      places.emplace_back(figure->values[k], k);
    else
      judged.missing.push_back(campaign.cases[k].number);
  }
  judged.cases = places.size();
  if (places.empty())
    return (figure == nullptr ? "results.csv has no column " : "no case has a value of ") + requirement.key;
  std::ranges::stable_sort(places, {}, &std::pair<double, std::size_t>::first);
  std::vector<double> sorted;
  for (const auto& [value, place] : places) sorted.push_back(value);
  const auto& [worst, place] = requirement.most ? places.back() : places.front();
  judged.worst = worst_case(campaign, place, worst, folder);
  judged.value = statistic_of(requirement, sorted);

  std::string text = fmt::format("the {} over {} is {}", subject_of(requirement),
                                 count_text(judged.cases, "case", "cases"), value_of(requirement, *judged.value));
  if (requirement.confidence) {
    const Percentile bounds = percentile(sorted, requirement.percentile / 100.0, *requirement.confidence);
    if (campaign.is_independent) judged.bound = requirement.most ? bounds.upper : bounds.lower;
    text += judged.bound ? fmt::format(", at {} {} at {}", requirement.most ? "most" : "least",
                                       value_of(requirement, *judged.bound), confidence_text(requirement))
                         : no_bound_text(requirement, campaign.is_independent);
  }
  const std::optional<double> shown = requirement.confidence ? judged.bound : judged.value;
  judged.met = shown && keeps(requirement, *shown);
  return text + fmt::format("; {} required", limit_of(requirement));
}

/// Whether a case is one of the share; nothing if it was not flown to an end, or has no verdict.
std::optional<bool> is_counted(const Requirement& requirement, const Case& one) {
  if (!one.is_judged()) return std::nullopt;
  if (requirement.statistic == Statistic::kPassRate) return one.has_passed();
  if (!one.is_complete()) return false;
  if (one.verdict.empty()) return std::nullopt;
  return std::ranges::find(requirement.verdicts, one.verdict) != requirement.verdicts.end();
}

/// As judge_figure. A case without a verdict counts against the requirement: not as one of the share with `least`, as
/// one with `most`.
std::string judge_share(const Campaign& campaign, const std::string& folder, JudgedRequirement& judged) {
  const Requirement& requirement = judged.requirement;
  std::size_t counted = 0, against = 0;
  for (std::size_t k = 0; k < campaign.cases.size(); ++k) {
    const Case& one = campaign.cases[k];
    const std::optional<bool> is_one = is_counted(requirement, one);
    if (is_one.value_or(false)) ++counted;
    if (!is_one) judged.missing.push_back(one.number);
    const bool has_no_verdict = !is_one || !one.is_complete();
    const bool is_against = requirement.most ? has_no_verdict || *is_one : !is_one.value_or(false);
    if (!is_against) continue;
    ++against;
    if (!judged.worst) judged.worst = worst_case(campaign, k, std::nullopt, folder);
  }
  const std::size_t all = campaign.cases.size();
  judged.cases = all - judged.missing.size();
  judged.value = static_cast<double>(counted) / static_cast<double>(all);
  const std::string count = requirement.statistic == Statistic::kPassRate
                                ? fmt::format("{} of {} cases passed, a pass rate", counted, all)
                                : fmt::format("{} of {} cases have the verdict {}, a share", counted, all,
                                              fmt::join(requirement.verdicts, " or "));
  if (!campaign.is_independent)
    return count + " of which no bound is known: the cases of a Latin hypercube are not an independent sample";
  judged.bound = requirement.most ? pass_rate(against, all, *requirement.confidence).upper
                                  : pass_rate(all - against, all, *requirement.confidence).lower;
  judged.met = keeps(requirement, *judged.bound);
  return fmt::format("{} of at {} {} at {}; {} required", count, requirement.most ? "most" : "least",
                     value_of(requirement, *judged.bound), confidence_text(requirement),
                     value_of(requirement, requirement.most ? *requirement.most : *requirement.least));
}

std::string missing_text(const JudgedRequirement& judged, std::size_t all) {
  constexpr std::size_t kMaxNamed = 5;
  const std::vector<std::uint64_t> named(
      judged.missing.begin(),
      judged.missing.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxNamed, judged.missing.size())));
  const bool is_verdict = judged.requirement.statistic == Statistic::kShare;
  return fmt::format("; {} of {} cases {} no {} ({} {}{}), {} allowed", judged.missing.size(), all,
                     judged.missing.size() == 1 ? "has" : "have", is_verdict ? "verdict" : "value",
                     named.size() == 1 ? "case" : "cases", fmt::join(named, ", "),
                     named.size() < judged.missing.size() ? ", ..." : "", judged.requirement.allow_missing);
}

JudgedRequirement judged_by(const Campaign& campaign, const std::string& folder, const Requirement& requirement) {
  JudgedRequirement judged;
  judged.requirement = requirement;
  std::string text =
      is_share(requirement.statistic) ? judge_share(campaign, folder, judged) : judge_figure(campaign, folder, judged);
  // A pass rate counts such a case as not passed, whatever kept it from its end.
  if (requirement.statistic != Statistic::kPassRate && !judged.missing.empty()) {
    judged.met = judged.met && judged.missing.size() <= requirement.allow_missing;
    text += missing_text(judged, campaign.cases.size());
  }
  if (judged.worst && judged.worst->value && (!judged.met || requirement.statistic == Statistic::kWorst))
    text += fmt::format("; worst: case {} (seed {})", judged.worst->number, judged.worst->seed);
  judged.sentence = fmt::format("requirement {}: {}", judged.met ? "met" : "not met", text);
  return judged;
}

}  // namespace

std::vector<JudgedRequirement> judge_requirements(const Campaign& campaign, const std::string& folder) {
  std::vector<JudgedRequirement> all;
  for (const Requirement& requirement : campaign.requirements) all.push_back(judged_by(campaign, folder, requirement));
  return all;
}

bool all_met(const std::vector<JudgedRequirement>& judged) {
  return std::ranges::all_of(judged, &JudgedRequirement::met);
}

std::string_view name_of(Statistic statistic) {
  return std::ranges::find(kStatistics, statistic, &std::pair<Statistic, std::string_view>::first)->second;
}

std::string subject_of(const Requirement& requirement) {
  switch (requirement.statistic) {
    case Statistic::kShare:
      return fmt::format("share of verdict {}", fmt::join(requirement.verdicts, " or "));
    case Statistic::kPassRate:
      return "pass rate";
    case Statistic::kWorst:
      return fmt::format("{} {}", requirement.most ? "largest" : "smallest", requirement.key);
    case Statistic::kPercentile:
      return fmt::format("percentile {:g} of {}", requirement.percentile, requirement.key);
    case Statistic::kMedian:
    case Statistic::kMean:
      break;
  }
  return fmt::format("{} of {}", name_of(requirement.statistic), requirement.key);
}

std::string value_of(const Requirement& requirement, double value) {
  return is_share(requirement.statistic) ? percent(value) : value_text(requirement.key, value);
}

std::string limit_of(const Requirement& requirement) {
  std::string text = requirement.most ? "at most " + value_of(requirement, *requirement.most)
                                      : "at least " + value_of(requirement, *requirement.least);
  if (requirement.confidence) text += fmt::format(" with {:g} % confidence", 100.0 * *requirement.confidence);
  return text;
}

namespace {

using report::Json;
using report::JsonObject;

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Requirement requirement_of(const JsonObject& object) {
  Requirement requirement;
  const std::string name = object.text("statistic");
  const auto* const statistic = std::ranges::find(kStatistics, name, &std::pair<Statistic, std::string_view>::second);
  if (statistic == kStatistics.end()) object.fail("statistic", fmt::format("\"{}\" is not a statistic", name));
  requirement.statistic = statistic->first;
  requirement.key = object.text("key");
  requirement.verdicts = object.texts("verdict");
  requirement.most = object.number_or_null("most");
  requirement.least = object.number_or_null("least");
  if (requirement.most.has_value() == requirement.least.has_value())
    object.fail("most", "one of \"most\" and \"least\" is expected");
  requirement.percentile = object.number("percentile");
  if (requirement.statistic == Statistic::kPercentile &&
      !(requirement.percentile > 0.0 && requirement.percentile < 100.0))
    object.fail("percentile", fmt::format("{} is not between 0 and 100", requirement.percentile));
  if (is_share(requirement.statistic) || !object.at("confidence").is_null())
    requirement.confidence = object.probability("confidence");
  requirement.allow_missing = object.count("allow_missing");
  requirement.paper = object.text("paper");
  return requirement;
}

Json json_of(const std::optional<WorstCase>& worst) {
  if (!worst) return nullptr;
  return {
      {"case", worst->number}, {"seed", worst->seed}, {"value", or_null(worst->value)}, {"command", worst->command}};
}

Json json_of(const JudgedRequirement& judged) {
  Json json = json_of(judged.requirement);
  json.update({{"met", judged.met},
               {"value", or_null(judged.value)},
               {"bound", or_null(judged.bound)},
               {"cases", judged.cases},
               {"missing", judged.missing},
               {"worst", json_of(judged.worst)},
               {"sentence", judged.sentence}});
  return json;
}

/// Number of cases by a word for each.
template <class Word>
Json counts_of(const Campaign& campaign, const Word& word) {
  std::map<std::string, std::size_t> counts;
  for (const Case& one : campaign.cases)
    if (const std::string name(word(one)); !name.empty()) ++counts[name];
  return counts;
}

}  // namespace

Json json_of(const Requirement& requirement) {
  return {{"statistic", name_of(requirement.statistic)},
          {"key", requirement.key},
          {"percentile", requirement.percentile},
          {"verdict", requirement.verdicts},
          {"most", or_null(requirement.most)},
          {"least", or_null(requirement.least)},
          {"confidence", or_null(requirement.confidence)},
          {"allow_missing", requirement.allow_missing},
          {"paper", requirement.paper}};
}

std::vector<Requirement> requirements_of(const JsonObject& campaign) {
  const Json& require = campaign.at("require");
  if (require.is_null()) return {};
  if (require.is_object()) {
    const JsonObject rate = campaign.object("require");
    return {Requirement::pass_rate(rate.probability("pass_rate_at_least"), rate.probability("confidence"))};
  }
  std::vector<Requirement> all;
  for (const JsonObject& element : campaign.objects("require")) all.push_back(requirement_of(element));
  return all;
}

std::string results_json(const Campaign& campaign, const std::vector<JudgedRequirement>& judged) {
  double cpu_s = 0.0;
  for (const Case& one : campaign.cases) cpu_s += std::isfinite(one.cpu_s) ? one.cpu_s : 0.0;
  Json requirements = Json::array();
  for (const JudgedRequirement& one : judged) requirements.push_back(json_of(one));
  const Json json{{"format", 1},
                  {"name", campaign.name},
                  {"mission", campaign.mission},
                  {"vbar_version", campaign.vbar_version},
                  {"commit", campaign.commit},
                  {"program_sha256", campaign.program_sha256},
                  {"seeds_from", campaign.seeds_from},
                  {"cases", campaign.cases.size()},
                  {"states", counts_of(campaign, [](const Case& one) { return name_of(one.state); })},
                  {"verdicts", counts_of(campaign, [](const Case& one) { return one.verdict; })},
                  {"passed", count_cases(campaign, [](const Case& one) { return one.has_passed(); })},
                  {"cpu_s", cpu_s},
                  {"requirements_met", all_met(judged)},
                  {"requirements", std::move(requirements)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vbar::campaign_report
