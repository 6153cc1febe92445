#include "host_sim/campaign/campaign_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/files/data_stream.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/verdict.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

namespace {

/// A text that --set takes for a text without its quotes.
bool is_plain(const std::string& text) {
  const bool is_word = text == "true" || text == "false" || text == "inf" || text == "nan";
  const bool begins_with_letter = !text.empty() && ((text[0] | 0x20) >= 'a' && (text[0] | 0x20) <= 'z');
  return mission::is_name(text) && begins_with_letter && !is_word;
}

/// TOML's basic strings have the escapes of JSON.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string inner_text(const toml::node& value) {
  return value.is_string() ? quoted(value.as_string()->get()) : text_of(value);
}

std::string text_of_array(const toml::array& array) {
  std::string text;
  for (const toml::node& element : array) text += (text.empty() ? "" : ", ") + inner_text(element);
  return "[" + text + "]";
}

std::string text_of_table(const toml::table& table) {
  std::string text;
  for (const auto& [key, element] : table)
    text += (text.empty() ? " " : ", ") + quoted(std::string(key.str())) + " = " + inner_text(element);
  return text.empty() ? "{}" : "{" + text + " }";
}

template <class Value>
std::string streamed(const Value& value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << value;
  return out.str();
}

}  // namespace

std::string text_of(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  std::string text(digits.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";  // else TOML reads an integer
  return text;
}

std::string text_of(const toml::node& value) {
  switch (value.type()) {
    case toml::node_type::string: {
      const std::string& text = value.as_string()->get();
      return is_plain(text) ? text : quoted(text);
    }
    case toml::node_type::integer:
      return fmt::format("{}", value.as_integer()->get());
    case toml::node_type::floating_point:
      return text_of(value.as_floating_point()->get());
    case toml::node_type::boolean:
      return value.as_boolean()->get() ? "true" : "false";
    case toml::node_type::array:
      return text_of_array(*value.as_array());
    case toml::node_type::table:
      return text_of_table(*value.as_table());
    case toml::node_type::date:
      return streamed(*value.as_date());
    case toml::node_type::time:
      return streamed(*value.as_time());
    case toml::node_type::date_time:
      return streamed(*value.as_date_time());
    case toml::node_type::none:
      break;
  }
  return {};
}

Sweep read_sweep_table(const mission::TableReader& section, std::string_view key, const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    section.refuse_value(key, "a CSV file, seen from the campaign file");
  Sweep sweep;
  const std::vector<std::string> lines = report::read_lines(file);
  for (std::size_t number = 0; number < lines.size(); ++number) {
    if (lines[number].empty()) continue;
    std::vector<std::string> cells;
    const bool is_row = report::split_cells(lines[number], cells);
    if (!is_row || (!sweep.keys.empty() && cells.size() != sweep.keys.size()))
      throw mission::MissionError(fmt::format("{}:{}", file.string(), number + 1), "",
                                  fmt::format("{} cells", is_row ? cells.size() : 0),
                                  fmt::format("a row of {} cells", sweep.keys.empty() ? 1 : sweep.keys.size()));
    if (sweep.keys.empty())
      sweep.keys = cells;
    else
      sweep.rows.push_back(cells);
  }
  if (sweep.rows.empty()) section.refuse_value(key, "a table of mission keys in the first line and at least one row");
  return sweep;
}

namespace {

using mission::above_to;
using mission::from_to;
using mission::TableReader;

constexpr std::size_t kMaxSeeds = 1'000'000;
constexpr double kMaxHours = 1e6;

constexpr const char* kSeedsRule =
    "\"FIRST..LAST\", an array of different integers from 0 on, or { count = N, from = \"commit\" }; at most a million";

std::vector<std::uint64_t> seeds_of_range(const TableReader& section, const std::string& text) {
  const std::size_t dots = text.find("..");
  std::uint64_t first = 0, last = 0;
  const auto is_number = [](std::string_view digits, std::uint64_t& number) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  const bool is_range = dots != std::string::npos && is_number(std::string_view(text).substr(0, dots), first) &&
                        is_number(std::string_view(text).substr(dots + 2), last) && first <= last &&
                        last - first < kMaxSeeds && last <= std::numeric_limits<std::int64_t>::max();
  if (!is_range) section.refuse_value("seeds", kSeedsRule);
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
  return seeds;
}

SeedDraw read_seed_draw(const TableReader& section) {
  const TableReader draw = section.table("seeds");
  SeedDraw read;
  read.count = static_cast<std::size_t>(draw.integer("count", 1, kMaxSeeds));
  static_cast<void>(draw.choice("from", std::array{std::pair{std::string_view("commit"), true}}));
  read.where = draw.where("from");
  draw.finish();
  return read;
}

std::vector<std::uint64_t> read_seeds(const TableReader& section, const toml::table& table) {
  if (!section.is_array("seeds")) return seeds_of_range(section, section.text("seeds"));
  std::vector<std::uint64_t> seeds;
  for (const toml::node& node : *table["seeds"].as_array()) {
    const auto* const integer = node.as_integer();
    if (integer == nullptr || integer->get() < 0) section.refuse_value("seeds", kSeedsRule);
    seeds.push_back(static_cast<std::uint64_t>(integer->get()));
  }
  if (seeds.empty() || seeds.size() > kMaxSeeds || std::set(seeds.begin(), seeds.end()).size() != seeds.size())
    section.refuse_value("seeds", kSeedsRule);
  return seeds;
}

Keep read_keep(const TableReader& section) {
  constexpr const char* kRule = "\"summary\", \"failed\", \"worst:N\" or \"all\"";
  const std::string text = section.text("keep", "summary");
  if (text == "summary") return {};
  if (text == "failed") return {Keep::Kind::kFailed};
  if (text == "all") return {Keep::Kind::kAll};
  constexpr std::string_view kWorst = "worst:";
  std::size_t count = 0;
  const char* const end = text.data() + text.size();
  if (!text.starts_with(kWorst) || std::from_chars(text.data() + kWorst.size(), end, count).ptr != end || count == 0 ||
      count > kMaxSeeds)
    section.refuse_value("keep", kRule);
  return {Keep::Kind::kWorst, count};
}

void read_general(const TableReader& section, const toml::table& table, CampaignFile& campaign) {
  campaign.name = section.name("name", campaign.file.stem().string());
  campaign.description = section.text("description", "");
  campaign.mission = section.text("mission");
  if (table["seeds"].is_table())
    campaign.seed_draw = read_seed_draw(section);
  else
    campaign.seeds = read_seeds(section, table);
  campaign.seed = static_cast<std::uint64_t>(section.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  campaign.set = section.texts("set");
  campaign.keep = read_keep(section);
  if (section.has("samples_h")) campaign.samples_h = section.numbers("samples_h", 0, 1000, from_to(0.0, kMaxHours));
  campaign.case_time_limit_s = section.number("case_time_limit_s", from_to(0.0, 1e7), 0.0);
  campaign.expected_case_s = section.number("expected_case_s", above_to(0.0, 1e7), 60.0);
  campaign.retries = section.integer("retries", 0, 1000, 2);
  campaign.stop_after_failures = section.integer("stop_after_failures", 0, 1'000'000'000, 0);
  campaign.common_draws = section.flag("common_draws", true);
  const std::string sampling = section.choice("sampling", {"independent", "latin"}, "independent");
  if (sampling == "latin") campaign.sampling = DrawSource::Sampling::kLatin;
  section.finish();
}

Sweep sweep_of_values(const TableReader& section, const toml::table& table) {
  static_cast<void>(section.is_array("values"));
  const toml::array* const values = table["values"].as_array();
  if (values == nullptr || values->empty()) section.refuse_value("values", "an array of at least one value");
  Sweep sweep{{section.text("key")}, {}};
  for (const toml::node& value : *values) sweep.rows.push_back({text_of(value)});
  return sweep;
}

Sweep sweep_of_rows(const TableReader& section, const toml::table& table) {
  Sweep sweep{section.texts("keys"), {}};
  const std::string rule = fmt::format("an array of rows of {} values", sweep.keys.size());
  static_cast<void>(section.is_array("rows"));
  const toml::array* const rows = table["rows"].as_array();
  if (rows == nullptr || rows->empty()) section.refuse_value("rows", rule);
  for (const toml::node& row : *rows) {
    const toml::array* const cells = row.as_array();
    if (cells == nullptr || cells->size() != sweep.keys.size()) section.refuse_value("rows", rule);
    std::vector<std::string>& texts = sweep.rows.emplace_back();
    for (const toml::node& cell : *cells) texts.push_back(text_of(cell));
  }
  return sweep;
}

Sweep read_sweep(const TableReader& section, const toml::table& table, const std::filesystem::path& file) {
  Sweep sweep;
  if (section.has("table")) {
    sweep = read_sweep_table(section, "table", file.parent_path() / section.text("table"));
  } else if (section.has("keys")) {
    sweep = sweep_of_rows(section, table);
  } else {
    sweep = sweep_of_values(section, table);
  }
  if (sweep.keys.empty()) section.refuse_value("keys", "at least one key of the mission");
  for (std::size_t k = 0; k < sweep.rows.size(); ++k)
    if (std::find(sweep.rows.begin(), sweep.rows.begin() + static_cast<std::ptrdiff_t>(k), sweep.rows[k]) !=
        sweep.rows.begin() + static_cast<std::ptrdiff_t>(k))
      section.refuse("", fmt::format("the values {} twice", fmt::join(sweep.rows[k], ", ")), "different values");
  section.finish();
  return sweep;
}

constexpr double kLargest = 1e15;  // of a figure
constexpr std::array kFileStatistics{std::pair{std::string_view("median"), campaign_report::Statistic::kMedian},
                                     std::pair{std::string_view("mean"), campaign_report::Statistic::kMean},
                                     std::pair{std::string_view("worst"), campaign_report::Statistic::kWorst},
                                     std::pair{std::string_view("percentile"), campaign_report::Statistic::kPercentile},
                                     std::pair{std::string_view("share"), campaign_report::Statistic::kShare}};

/// A key that belongs to other statistics is refused by name, as the requirement would not mean what it says.
void refuse_key(const TableReader& section, const char* key, const char* statistics) {
  if (section.has(key))
    section.refuse(key, fmt::format("this key with statistic = \"{}\"", section.text("statistic")),
                   fmt::format("{} with statistic = {} only", key, statistics));
}

std::vector<std::string> read_verdicts(const TableReader& section) {
  std::vector<std::string_view> words;
  for (int k = 0; k < static_cast<int>(report::Outcome::kIncomplete); ++k)
    words.push_back(report::word_of(static_cast<report::Outcome>(k)));
  const std::string rule = fmt::format("{}, or an array of different ones", mission::listing_of(words));
  std::vector<std::string> verdicts =
      section.is_array("verdict") ? section.texts("verdict") : std::vector{section.text("verdict")};
  const bool are_known = std::ranges::all_of(
      verdicts, [&](const std::string& one) { return std::ranges::find(words, one) != words.end(); });
  if (verdicts.empty() || !are_known || std::set(verdicts.begin(), verdicts.end()).size() != verdicts.size())
    section.refuse_value("verdict", rule);
  return verdicts;
}

void read_requirement_limit(const TableReader& section, mission::Range range, Requirement& requirement) {
  if (section.has("most") == section.has("least"))
    section.refuse("", section.has("most") ? "both most and least" : "neither most nor least", "one of them");
  if (section.has("most"))
    requirement.most = section.number("most", range);
  else
    requirement.least = section.number("least", range);
}

/// An element of [[require]], or the table [require] with pass_rate_at_least.
Requirement read_requirement(const TableReader& section) {
  using campaign_report::Statistic;
  constexpr double kDefaultConfidence = 0.95;
  const mission::Range confidences = from_to(0.5, 0.9999);
  Requirement requirement;
  if (section.has("pass_rate_at_least")) {
    requirement = Requirement::pass_rate(section.number("pass_rate_at_least", above_to(0.0, 1.0)),
                                         section.number("confidence", confidences, kDefaultConfidence));
  } else {
    requirement.statistic = section.choice<Statistic>("statistic", kFileStatistics);
    const bool is_share = requirement.statistic == Statistic::kShare;
    const bool is_percentile = requirement.statistic == Statistic::kPercentile;
    if (is_share) {
      refuse_key(section, "key", "\"median\", \"mean\", \"worst\" or \"percentile\"");
      requirement.verdicts = read_verdicts(section);
    } else {
      refuse_key(section, "verdict", "\"share\"");
      requirement.key = section.text("key");
      if (requirement.key.empty()) section.refuse_value("key", "a number of summary.json by its path");
    }
    if (is_percentile)
      requirement.percentile = section.number("percentile", above_to(0.0, 99.9999));
    else
      refuse_key(section, "percentile", "\"percentile\"");
    if (!is_share && !is_percentile) refuse_key(section, "confidence", "\"percentile\" or \"share\"");
    read_requirement_limit(section, is_share ? from_to(0.0, 1.0) : from_to(-kLargest, kLargest), requirement);
    if (is_share || section.has("confidence"))
      requirement.confidence = section.number("confidence", confidences, kDefaultConfidence);
    requirement.allow_missing = static_cast<std::size_t>(section.integer("allow_missing", 0, kMaxSeeds, 0));
  }
  requirement.paper = section.text("paper", "");
  section.finish();
  return requirement;
}

void refuse_repeated_keys(const CampaignFile& campaign) {
  std::set<std::string> seen;
  const auto once = [&](const std::string& key) {
    const char* const reason = key == "mission.seed" ? "a key that the seeds set" : "a key that is varied twice";
    if (key == "mission.seed" || key.empty() || key.find('=') != std::string::npos || !seen.insert(key).second)
      throw mission::MissionError(campaign.file.string(), key, key.empty() ? "an empty key" : reason,
                                  "each key of the mission once, in sweep or disperse");
  };
  for (const std::string& key : campaign.keys()) once(key);
  for (const std::string& assignment : campaign.set)
    if (seen.contains(assignment.substr(0, assignment.find('='))))
      throw mission::MissionError(campaign.file.string(), "campaign.set", "a key that is varied too: " + assignment,
                                  "keys that are neither swept nor dispersed");
}

template <class Read>
void for_each_table(const TableReader& document, const toml::table& table, const char* key, const Read& read) {
  const std::vector<TableReader> sections = document.tables(key);
  for (std::size_t k = 0; k < sections.size(); ++k) read(sections[k], *table[key].as_array()->get(k)->as_table());
}

}  // namespace

std::vector<std::string> CampaignFile::swept_keys() const {
  std::vector<std::string> all;
  for (const Sweep& sweep : sweeps) all.insert(all.end(), sweep.keys.begin(), sweep.keys.end());
  return all;
}

std::vector<std::string> CampaignFile::keys() const {
  std::vector<std::string> all = swept_keys();
  for (const Dispersion& dispersion : dispersions)
    all.insert(all.end(), dispersion.keys.begin(), dispersion.keys.end());
  return all;
}

CampaignFile parse_campaign(std::string_view text, const std::filesystem::path& file) {
  const toml::table table = mission::parse_toml(text, file.string());
  const TableReader document(table, file.string());
  for (const char* const known : {"campaign", "sweep", "disperse", "pass", "require"})
    static_cast<void>(document.has(known));
  document.refuse_unknown_keys();
  CampaignFile campaign;
  campaign.file = file;
  const toml::table* const general = table["campaign"].as_table();
  const toml::table empty;
  read_general(document.table("campaign"), general == nullptr ? empty : *general, campaign);
  for_each_table(document, table, "sweep", [&](const TableReader& section, const toml::table& raw) {
    campaign.sweeps.push_back(read_sweep(section, raw, file));
  });
  for_each_table(document, table, "disperse", [&](const TableReader& section, const toml::table& raw) {
    campaign.dispersions.push_back(read_dispersion(section, raw));
  });
  for (const TableReader& section : document.tables("pass")) campaign.passes.push_back(mission::read_limit(section));
  if (table["require"].is_table()) {
    campaign.requirements.push_back(read_requirement(document.table("require")));
  } else {
    for (const TableReader& section : document.tables("require"))
      campaign.requirements.push_back(read_requirement(section));
  }
  document.finish();
  refuse_repeated_keys(campaign);
  return campaign;
}

CampaignFile read_campaign_file(const std::filesystem::path& file) {
  return parse_campaign(mission::read_text_file(file, "a campaign file (TOML)"), file);
}

std::string seed_origin(std::string_view commit) {
  constexpr std::size_t kDigits = 12, kMinDigits = 7, kMaxDigits = 64;
  const bool is_changed = commit.ends_with('+');
  const std::string_view digits = commit.substr(0, commit.size() - (is_changed ? 1 : 0));
  if (digits.size() < kMinDigits || digits.size() > kMaxDigits) return {};
  std::string origin;
  for (const char c : digits.substr(0, kDigits)) origin += static_cast<char>(c >= 'A' && c <= 'F' ? c | 0x20 : c);
  if (digits.find_first_not_of("0123456789abcdefABCDEF") != std::string_view::npos) return {};
  return origin + (is_changed ? "+" : "");
}

void draw_seeds(CampaignFile& campaign, const std::string& commit, const std::string& seeds_from) {
  if (!campaign.seed_draw) {
    if (!seeds_from.empty())
      throw app::Refused(
          fmt::format("--seeds-from: found {}, although {} states its seeds; accepted: with seeds = {{ count = N, from "
                      "= \"commit\" }}",
                      seeds_from, campaign.file.string()));
    return;
  }
  campaign.seeds_from = seed_origin(seeds_from.empty() ? commit : seeds_from);
  if (campaign.seeds_from.empty() && !seeds_from.empty())
    throw app::Refused(
        "--seeds-from: found " + seeds_from +
        "; accepted: 7 to 64 hexadecimal digits of a commit, with a + behind them if files were changed");
  if (campaign.seeds_from.empty())
    throw mission::MissionError(campaign.seed_draw->where, "campaign.seeds.from",
                                "\"commit\" in a program whose commit is " + commit,
                                "a program built in a git work tree, or --seeds-from HEX");
  // 32 bits: short enough to type, and two of a million that are equal are drawn again.
  constexpr std::size_t kHexDigits = 8;
  std::set<std::uint64_t> drawn;
  for (std::uint64_t k = 0; drawn.size() < campaign.seed_draw->count; ++k) {
    const std::string hash = files::sha256_of(fmt::format("{}\n{}\n{}", campaign.seeds_from, campaign.name, k));
    std::uint64_t seed = 0;
    std::from_chars(hash.data(), hash.data() + kHexDigits, seed, 16);
    if (drawn.insert(seed).second) campaign.seeds.push_back(seed);
  }
}

}  // namespace vbar::campaign
