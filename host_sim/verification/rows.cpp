#include "host_sim/verification/rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "host_sim/simulation/exit_codes.h"

namespace vbar::verification {

namespace {

namespace fs = std::filesystem;

std::size_t points_of(const campaign::CampaignFile& campaign) {
  std::size_t points = 1;
  for (const campaign::Sweep& sweep : campaign.sweeps) points *= sweep.rows.size();
  return points;
}

/// "sample" of "sample/experiment3"; empty of a row in no folder.
std::string folder_of(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? std::string() : name.substr(0, slash);
}

}  // namespace

std::vector<Row> read_rows(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw app::Refused(folder.string() + ": is not a folder of campaign files");
  std::vector<Row> rows;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".toml") continue;
    Row row{entry.path().lexically_relative(folder).replace_extension().generic_string(),
            campaign::read_campaign_file(entry.path())};
    row.cases_per_seed = points_of(row.campaign);
    rows.push_back(std::move(row));
  }
  std::ranges::sort(rows, {}, &Row::name);
  return rows;
}

std::vector<Row> selected_rows(std::vector<Row> rows, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto is_meant = [&](const Row& row) { return row.name == name || folder_of(row.name) == name; };
    if (std::ranges::any_of(rows, is_meant)) continue;
    std::vector<std::string> accepted;
    for (const Row& row : rows) accepted.push_back(row.name);
    throw app::Refused(
        fmt::format("row \"{}\": unknown; accepted: {}, or a folder of them", name, fmt::join(accepted, ", ")));
  }
  const auto is_chosen = [&](const Row& row) {
    if (names.empty()) return folder_of(row.name) != "sample";
    return std::ranges::any_of(
        names, [&](const std::string& name) { return row.name == name || folder_of(row.name) == name; });
  };
  std::erase_if(rows, [&](const Row& row) { return !is_chosen(row); });
  return rows;
}

void order_by_value(std::vector<Row>& rows) {
  const auto key = [](const Row& row) {
    const bool is_flown = row.seeds_left() == 0;
    const double value = is_flown ? 0.0 : static_cast<double>(row.decisions()) / row.left_s();
    return std::tuple(is_flown, -value, row.name);
  };
  std::ranges::sort(rows, {}, key);
}

std::vector<std::size_t> seeds_within(const std::vector<Row>& rows, double budget_s) {
  // The level of the shares: rows that need less than it, in order of their need, leave the rest to the others.
  std::vector<double> needs;
  for (const Row& row : rows) needs.push_back(row.left_s());
  std::ranges::sort(needs);
  double level_s = 0.0, left_s = budget_s;
  for (std::size_t k = 0; k < needs.size(); ++k) {
    level_s = left_s / static_cast<double>(needs.size() - k);
    if (needs[k] > level_s) break;
    left_s -= needs[k];
    level_s = needs[k];
  }
  std::vector<std::size_t> seeds;
  double rest_s = budget_s;
  for (const Row& row : rows) {
    const auto affordable = static_cast<std::size_t>(std::floor(level_s / row.seed_s() * (1.0 + 1e-12)));
    seeds.push_back(std::min(affordable, row.seeds_left()));
    rest_s -= row.seed_s() * static_cast<double>(seeds.back());
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (seeds[k] > 0 || rows[k].seeds_left() == 0 || rows[k].seed_s() > rest_s) continue;
    seeds[k] = 1;
    rest_s -= rows[k].seed_s();
  }
  return seeds;
}

}  // namespace vbar::verification
