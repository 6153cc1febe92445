#include "host_sim/verification/page.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/files/output_file.h"
#include "host_sim/report/paper_results.h"

namespace vbar::verification {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNotFlown = "not flown";
constexpr std::string_view kBegin = "<!-- v:", kClose = " -->", kEnd = "<!-- v:end -->";

std::string text_or_lost(const std::string& key, const Json& value) {
  return value.is_number() ? campaign_report::value_text(key, value.get<double>()) : std::string("lost");
}

std::string row_line(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string paper_text(const Json& requirement) {
  if (!requirement.contains("paper")) return {};
  const Json& paper = requirement["paper"];
  return campaign_report::value_text(paper["cell"].get<std::string>(), paper["value"].get<double>());
}

/// A line for each requirement: the statistic that is limited, then how the cases scatter.
std::string table_of(const Json& row) {
  if (!is_flown(row)) return std::string(kNotFlown) + "\n";
  std::string text = row_line({"requirement", "value", "limit", "met", "paper", "median", "90 %", "worst", "its seed"});
  text += "|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& one : row["requirements"]) {
    std::string value = one.value("text", "none");
    if (one.contains("bound_text")) value += fmt::format(" (bound {})", one["bound_text"].get<std::string>());
    if (one.value("missing", 0) > 0) value += fmt::format(", {} lost", one["missing"].dump());
    std::vector<std::string> cells{one["subject"].get<std::string>(), value, one["limit"].get<std::string>(),
                                   one["met"].get<bool>() ? "yes" : "**no**", paper_text(one)};
    const std::string key = one.value("key", "");
    if (const Json* const quantity = quantity_of(row, key)) {
      for (const char* const statistic : {"median", "p90", "worst"})
        cells.push_back(text_or_lost(key, (*quantity)[statistic]));
      cells.push_back((*quantity)["worst_seed"].dump());
    } else {
      cells.insert(cells.end(), 4, "");
    }
    text += row_line(cells);
  }
  return text;
}

std::string flown_text(const Json& row) {
  std::string text = fmt::format("{} of {} seeds", row["seeds_flown"].dump(), row["seeds_asked"].dump());
  if (row["cases_per_seed"] != 1) text += fmt::format(", {} cases", row["cases_flown"].dump());
  return text;
}

std::string achieved_text(const Json& row) {
  const Json& share = row["achieved"];
  if (share["of"] == 0) return "no verdict";
  return fmt::format("{} of {}, at least {:.1f} %", share["count"].dump(), share["of"].dump(),
                     100.0 * share["lower"].get<double>());
}

/// The commands that repeat the worst case of each requirement that is not met, and the cases that were not achieved.
std::string commands_of(const Json& row) {
  std::set<std::string> commands;
  for (const Json& one : row["requirements"]) {
    if (one["met"].get<bool>()) continue;
    if (const Json* const quantity = quantity_of(row, one.value("key", "")))
      commands.insert(fmt::format("    {}    # {} {}\n", (*quantity)["worst_command"].get<std::string>(),
                                  (*quantity)["key"].get<std::string>(),
                                  text_or_lost((*quantity)["key"].get<std::string>(), (*quantity)["worst"])));
  }
  std::string text;
  for (const std::string& command : commands) text += command;
  for (const Json& one : row["not_achieved"])
    text += fmt::format("    {}    # {} {}\n", one["command"].get<std::string>(), one["state"].get<std::string>(),
                        one["verdict"].get<std::string>());
  return text.empty() ? text : "\nCases that need a look:\n\n" + text;
}

std::string section_of(const Json& row) {
  const std::string name = row["name"].get<std::string>();
  std::string text = fmt::format("\n## {}\n\n`missions/verification/{}.toml`: ", row["title"].get<std::string>(), name);
  if (!is_flown(row)) return text + fmt::format("not flown ({} seeds asked).\n", row["seeds_asked"].dump());
  text += fmt::format("{}, {:.3g} core-hours; achieved: {}", flown_text(row), row["core_hours"].get<double>(),
                      achieved_text(row));
  text += row["achieved"]["of"] == 0
              ? ", for want of waypoints.\n\n"
              : fmt::format(" at {:.0f} % confidence.\n\n", 100.0 * row["achieved"]["confidence"].get<double>());
  return text + table_of(row) + commands_of(row);
}

std::string overview_of(const Json& verification) {
  std::string text = row_line({"row", "flown", "achieved", "requirements met", "core-hours"});
  text += "|---|---|---|---|---|\n";
  for (const Json& row : verification["rows"]) {
    const std::string name = fmt::format("`{}`", row["name"].get<std::string>());
    if (!is_flown(row)) {
      text += row_line({name, kNotFlown, "", "", ""});
      continue;
    }
    const auto met = std::ranges::count_if(row["requirements"], [](const Json& one) { return one["met"] == true; });
    const std::string count = fmt::format("{} of {}", met, row["requirements"].size());
    text += row_line({name, flown_text(row), achieved_text(row), is_met(row) ? count : "**" + count + "**",
                      fmt::format("{:.3g}", row["core_hours"].get<double>())});
  }
  return text;
}

// Marked figures.

struct Marker {
  std::string row, key, statistic;
  double factor = 1.0;
  int decimals = 0;
};

class Figures {
 public:
  Figures(const std::string& text, const Json& verification, std::string file)
      : text_(text), verification_(verification), file_(std::move(file)) {}

  std::string replaced() {
    std::string out;
    std::size_t place = 0;
    for (std::size_t at = 0; (at = text_.find(kBegin, place)) != std::string::npos;) {
      at_ = at;
      const std::size_t close = text_.find(kClose, at);
      if (close == std::string::npos) fail("a marker that is not closed");
      const std::string content = text_.substr(at + kBegin.size(), close - at - kBegin.size());
      const std::size_t behind = close + kClose.size();
      out += text_.substr(place, at - place);
      if (content.starts_with("table ")) {
        const std::size_t end = text_.find(kEnd, behind);
        if (end == std::string::npos) fail("a table without <!-- v:end -->");
        out += text_.substr(at, behind - at) + "\n" + table_of(row(content.substr(6))) + std::string(kEnd);
        place = end + kEnd.size();
        continue;
      }
      remove_figure(out);
      out += figure(marker(content)) + text_.substr(at, behind - at);
      place = behind;
    }
    return out + text_.substr(place);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw std::runtime_error(fmt::format("{}:{}: {}", file_, line, what));
  }

  [[nodiscard]] const Json& row(const std::string& name) const {
    std::vector<std::string> names;
    for (const Json& one : verification_["rows"]) {
      if (one["name"] == name) return one;
      names.push_back(one["name"].get<std::string>());
    }
    fail(fmt::format("row \"{}\": unknown; accepted: {}", name, fmt::join(names, ", ")));
  }

  [[nodiscard]] Marker marker(const std::string& content) const {
    std::istringstream words(content);
    Marker marker;
    words >> marker.row >> marker.key >> marker.statistic;
    for (std::string word; words >> word;) {
      try {
        if (word.starts_with('x')) {
          marker.factor = std::stod(word.substr(1));
          continue;
        }
        if (word.starts_with('.')) {
          marker.decimals = std::stoi(word.substr(1));
          continue;
        }
      } catch (const std::logic_error&) {  // not a number
      }
      fail(fmt::format("marker \"{}\": \"{}\" is neither xFACTOR nor .DECIMALS", content, word));
    }
    if (marker.statistic.empty()) fail(fmt::format("marker \"{}\": accepted: ROW QUANTITY STATISTIC", content));
    return marker;
  }

  /// The number, or the words, that the marker is about stand before it.
  static void remove_figure(std::string& out) {
    if (out.ends_with(kNotFlown)) {
      out.resize(out.size() - std::string_view(kNotFlown).size());
      return;
    }
    for (const std::string_view word : {std::string_view("lost")})
      if (out.ends_with(word)) out.resize(out.size() - word.size());
    while (!out.empty() && (std::isdigit(static_cast<unsigned char>(out.back())) != 0 || out.back() == '.'))
      out.pop_back();
  }

  [[nodiscard]] std::string figure(const Marker& marker) const {
    if (marker.row == "paper") return paper_figure(marker);
    const Json& flown = row(marker.row);
    if (!is_flown(flown)) return kNotFlown;
    if (marker.statistic == "seeds") return flown["seeds_flown"].dump();
    const Json* const quantity = quantity_of(flown, marker.key);
    if (quantity == nullptr) fail(fmt::format("row {} has no quantity \"{}\"", marker.row, marker.key));
    if (!quantity->contains(marker.statistic))
      fail(fmt::format("statistic \"{}\": accepted: median, p90, worst, n, seeds", marker.statistic));
    return number((*quantity)[marker.statistic], marker);
  }

  [[nodiscard]] std::string paper_figure(const Marker& marker) const {
    const std::optional<double> cell = report::find_paper_cell(marker.key);
    if (!cell) fail(fmt::format("\"{}\" is not a cell of the paper (host_sim/report/paper_results.h)", marker.key));
    return number(*cell, marker);
  }

  [[nodiscard]] static std::string number(const Json& value, const Marker& marker) {
    return value.is_number() ? fmt::format("{:.{}f}", marker.factor * value.get<double>(), marker.decimals) : "lost";
  }

  const std::string& text_;
  const Json& verification_;
  std::string file_;
  std::size_t at_ = 0;
};

}  // namespace

std::string verification_page(const Json& verification) {
  std::string text = fmt::format(
      "# Verification of commit {}\n\nWritten by `vbar verify --page` from [verification.json](verification.json): "
      "vbar {}, {}, {}. All figures are of this commit; a row that was not flown with it says so. Seeds are drawn from "
      "the commit, so that no seed has been seen before. The Zynq and all benches are emulated; no hardware took "
      "part.\n\nStatistics are over the seeds of a row: the median, the value that nine of ten cases keep, the worst "
      "case with its seed. A case that lost its target, or was not flown to an end, counts as lost. Shares are stated "
      "with their lower Clopper-Pearson bound. Paper: [published_figures.h](../host_sim/report/published_figures.h). "
      "[campaigns.md](campaigns.md#verification) explains how rows are flown and commits compared.\n\n",
      verification["commit"].get<std::string>(), verification["vbar_version"].get<std::string>(),
      verification["date"].get<std::string>(), verification["processor"].get<std::string>());
  text += overview_of(verification);
  for (const Json& row : verification["rows"]) text += section_of(row);
  return text;
}

std::string with_figures(const std::string& text, const Json& verification, const std::string& file) {
  return Figures(text, verification, file).replaced();
}

std::vector<fs::path> write_pages(const Json& verification, const fs::path& docs) {
  std::vector<fs::path> pages{docs.parent_path() / "README.md"}, changed;
  for (const fs::directory_entry& entry : fs::directory_iterator(docs))
    if (entry.path().extension() == ".md" && entry.path().filename() != "verification.md")
      pages.push_back(entry.path());
  std::ranges::sort(pages);
  std::vector<std::pair<fs::path, std::string>> texts{{docs / "verification.md", verification_page(verification)}};
  for (const fs::path& page : pages)
    if (fs::is_regular_file(page))
      texts.emplace_back(page, with_figures(files::read_text_file(page), verification, page.string()));
  for (const auto& [page, text] : texts) {
    if (fs::is_regular_file(page) && files::read_text_file(page) == text) continue;
    files::replace_text_file(page, text);
    changed.push_back(page);
  }
  return changed;
}

}  // namespace vbar::verification
