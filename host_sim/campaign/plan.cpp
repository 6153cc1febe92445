#include "host_sim/campaign/plan.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/campaign/record_file.h"
#include "host_sim/campaign/value_text.h"
#include "host_sim/files/sha256.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign {
namespace {

constexpr int kFormat = 1;
constexpr std::array<std::pair<std::string_view, Keep::Kind>, 4> kKeepKinds{{{"summary", Keep::Kind::kSummary},
                                                                             {"failed", Keep::Kind::kFailed},
                                                                             {"worst", Keep::Kind::kWorst},
                                                                             {"all", Keep::Kind::kAll}}};

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const PassCriterion& pass) {
  return {{"key", pass.key}, {"most", json_of(pass.most)}, {"least", json_of(pass.least)}};
}

Json json_of(const std::optional<Requirement>& require) {
  if (!require) return nullptr;
  return {{"pass_rate_at_least", require->pass_rate}, {"confidence", require->confidence}};
}

Json json_of(const Keep& keep) {
  for (const auto& [name, kind] : kKeepKinds)
    if (kind == keep.kind) return {{"runs", name}, {"worst", keep.worst}};
  return nullptr;
}

std::optional<double> number(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Keep keep_of(const Json& json) {
  for (const auto& [name, kind] : kKeepKinds)
    if (json.at("runs") == name) return {kind, json.at("worst").get<std::size_t>()};
  throw std::runtime_error("an unknown value of keep");
}

Plan plan_of_json(const Json& json) {
  if (json.at("format") != kFormat) throw std::runtime_error(fmt::format("format {} is expected", kFormat));
  Plan plan;
  json.at("name").get_to(plan.name);
  json.at("description").get_to(plan.description);
  json.at("mission").get_to(plan.mission);
  json.at("vbar_version").get_to(plan.vbar_version);
  json.at("program_sha256").get_to(plan.program_sha256);
  json.at("cases").get_to(plan.cases);
  json.at("cases_sha256").get_to(plan.cases_sha256);
  json.at("keys").get_to(plan.keys);
  json.at("swept").get_to(plan.swept);
  for (const Json& pass : json.at("pass"))
    plan.passes.push_back({pass.at("key").get<std::string>(), number(pass.at("most")), number(pass.at("least"))});
  json.at("samples_h").get_to(plan.samples_h);
  if (const Json& require = json.at("require"); !require.is_null())
    plan.require = Requirement{require.at("pass_rate_at_least").get<double>(), require.at("confidence").get<double>()};
  json.at("independent").get_to(plan.independent);
  json.at("mission_file").get_to(plan.mission_file);
  json.at("set").get_to(plan.set);
  plan.keep = keep_of(json.at("keep"));
  json.at("case_time_limit_s").get_to(plan.case_time_limit_s);
  json.at("expected_case_s").get_to(plan.expected_case_s);
  json.at("retries").get_to(plan.retries);
  json.at("stop_after_failures").get_to(plan.stop_after_failures);
  return plan;
}

}  // namespace

Plan plan_of(const CampaignFile& campaign) {
  Plan plan;
  plan.name = campaign.name;
  plan.description = campaign.description;
  plan.keys = campaign.keys();
  plan.swept = campaign.swept_keys();
  plan.passes = campaign.passes;
  plan.samples_h = campaign.samples_h;
  plan.require = campaign.require;
  plan.independent = campaign.sampling == DrawSource::Sampling::kIndependent;
  plan.set = campaign.set;
  plan.keep = campaign.keep;
  plan.case_time_limit_s = campaign.case_time_limit_s;
  plan.expected_case_s = campaign.expected_case_s;
  plan.retries = campaign.retries;
  plan.stop_after_failures = campaign.stop_after_failures;
  return plan;
}

std::string plan_json(const Plan& plan) {
  Json passes = Json::array();
  for (const PassCriterion& pass : plan.passes) passes.push_back(json_of(pass));
  const Json json{{"format", kFormat},
                  {"name", plan.name},
                  {"description", plan.description},
                  {"mission", plan.mission},
                  {"vbar_version", plan.vbar_version},
                  {"program_sha256", plan.program_sha256},
                  {"cases", plan.cases},
                  {"cases_sha256", plan.cases_sha256},
                  {"keys", plan.keys},
                  {"swept", plan.swept},
                  {"pass", passes},
                  {"samples_h", plan.samples_h},
                  {"require", json_of(plan.require)},
                  {"independent", plan.independent},
                  {"mission_file", plan.mission_file},
                  {"set", plan.set},
                  {"keep", json_of(plan.keep)},
                  {"case_time_limit_s", plan.case_time_limit_s},
                  {"expected_case_s", plan.expected_case_s},
                  {"retries", plan.retries},
                  {"stop_after_failures", plan.stop_after_failures}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Plan read_plan(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  try {
    return plan_of_json(Json::parse(text));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: not the plan of a campaign: {}", file.string(), error.what()));
  }
}

std::string identity_of(const Plan& plan, const Case& one) {
  return files::sha256_of(fmt::format("{}", fmt::join(overrides_of(plan, one, false), "\n")));
}

std::vector<std::string> overrides_of(const Plan& plan, const Case& one, bool full_record) {
  std::vector<std::string> overrides = plan.set;
  for (std::size_t k = 0; k < plan.keys.size(); ++k) overrides.push_back(plan.keys[k] + "=" + one.values[k]);
  overrides.push_back(fmt::format("mission.seed={}", one.seed));
  if (!plan.samples_h.empty()) {
    std::vector<std::string> hours;
    for (const double hour : plan.samples_h) hours.push_back(text_of(hour));
    overrides.push_back(fmt::format("record.samples_h=[{}]", fmt::join(hours, ", ")));
  }
  if (!full_record) overrides.insert(overrides.end(), {"record.packets=false", "record.tables=false"});
  return overrides;
}

}  // namespace vbar::campaign
