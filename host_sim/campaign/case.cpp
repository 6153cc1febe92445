#include "host_sim/campaign/case.h"

#include <charconv>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

namespace {

using Row = std::vector<std::string>;

/// The product of all sweeps, the last one fastest.
std::vector<Row> sweep_points(const std::vector<Sweep>& sweeps) {
  std::vector<Row> points{{}};
  for (const Sweep& sweep : sweeps) {
    std::vector<Row> longer;
    for (const Row& point : points) {
      for (const Row& row : sweep.rows) {
        longer.push_back(point);
        longer.back().insert(longer.back().end(), row.begin(), row.end());
      }
    }
    points = std::move(longer);
  }
  return points;
}

std::string name_of_point(const Row& keys, const Row& values) {
  std::string name;
  for (std::size_t k = 0; k < keys.size(); ++k) name += fmt::format("{}{}={}", k == 0 ? "@" : ",", keys[k], values[k]);
  return name;
}

/// Returns for each seed the values of all dispersed keys.
std::vector<Row> draws_of(const CampaignFile& campaign, const std::string& suffix) {
  std::vector<Row> rows(campaign.seeds.size());
  const DrawSource source(campaign.seed, campaign.sampling, campaign.seeds);
  for (const Dispersion& dispersion : campaign.dispersions) {
    const std::vector<Row> drawn = draw(dispersion, source, suffix);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].insert(rows[k].end(), drawn[k].begin(), drawn[k].end());
  }
  return rows;
}

[[noreturn]] void refuse_line(const std::filesystem::path& file, std::size_t line, const std::string& accepted) {
  throw std::runtime_error(
      fmt::format("{}:{}: not the table of this campaign's cases; accepted: {}", file.string(), line, accepted));
}

}  // namespace

std::vector<Case> expand(const CampaignFile& campaign) {
  const std::vector<Row> points = sweep_points(campaign.sweeps);
  const Row swept = campaign.swept_keys();
  std::vector<std::vector<Row>> draws;  // draws of each sweep point, or once for all
  for (std::size_t point = 0; point < (campaign.common_draws ? 1 : points.size()); ++point)
    draws.push_back(draws_of(campaign, campaign.common_draws ? "" : name_of_point(swept, points[point])));
  std::vector<Case> cases;
  for (std::size_t place = 0; place < campaign.seeds.size(); ++place) {
    for (std::size_t point = 0; point < points.size(); ++point) {
      Case& one = cases.emplace_back(Case{cases.size(), campaign.seeds[place], points[point]});
      const Row& drawn = draws[campaign.common_draws ? 0 : point][place];
      one.values.insert(one.values.end(), drawn.begin(), drawn.end());
    }
  }
  return cases;
}

std::string cases_text(const std::vector<std::string>& keys, const std::vector<Case>& cases) {
  std::string text = "case,seed";
  for (const std::string& key : keys) {
    text += ',';
    report::append_text(text, key);
  }
  text += '\n';
  for (const Case& one : cases) {
    text += fmt::format("{},{}", one.number, one.seed);
    for (const std::string& value : one.values) {
      text += ',';
      report::append_text(text, value);
    }
    text += '\n';
  }
  return text;
}

std::vector<Case> read_cases(const std::filesystem::path& file, const std::vector<std::string>& keys) {
  const std::vector<std::string> lines = report::read_lines(file);
  std::vector<std::string> head{"case", "seed"};
  head.insert(head.end(), keys.begin(), keys.end());
  std::vector<Case> cases;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    if (lines[line].empty()) continue;
    std::vector<std::string> cells;
    if (!report::split_cells(lines[line], cells) || cells.size() != head.size())
      refuse_line(file, line + 1, fmt::format("{} cells", head.size()));
    if (line == 0 && cells != head) refuse_line(file, 1, fmt::format("the columns {}", fmt::join(head, ", ")));
    if (line == 0) continue;
    Case& one = cases.emplace_back();
    if (!report::read_value(cells[0], one.number) || !report::read_value(cells[1], one.seed) ||
        one.number + 1 != cases.size())
      refuse_line(file, line + 1, "the cases in order, with their seeds");
    one.values.assign(cells.begin() + 2, cells.end());
  }
  return cases;
}

std::string name_of_case(std::size_t number) {
  return fmt::format("{:06}", number);
}

namespace {

bool read_number(std::string_view digits, std::size_t& number) {
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc{} && end == digits.data() + digits.size();
}

}  // namespace

std::vector<std::size_t> selected_cases(const std::string& text, std::size_t cases) {
  std::set<std::size_t> selected;
  for (std::size_t place = 0; place <= text.size();) {
    const std::size_t comma = std::min(text.find(',', place), text.size());
    const std::string_view part = std::string_view(text).substr(place, comma - place);
    const std::size_t dash = std::min(part.find('-'), part.size());
    std::size_t first = 0, last = 0;
    const bool is_good = read_number(part.substr(0, dash), first) &&
                         read_number(dash == part.size() ? part : part.substr(dash + 1), last) && first <= last &&
                         last < cases;
    if (!is_good)
      throw app::Refused(fmt::format("--cases: found \"{}\"; accepted: numbers and ranges from 0 to {}, e.g. 0-9,17",
                                     part, cases - 1));
    for (std::size_t number = first; number <= last; ++number) selected.insert(number);
    place = comma + 1;
  }
  return {selected.begin(), selected.end()};
}

}  // namespace vbar::campaign
