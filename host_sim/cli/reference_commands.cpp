#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <fmt/format.h>

#include "host_sim/cli/commands.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/report/run_tables.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::app {

int missions_command(const std::filesystem::path& folder_or_mission) {
  std::error_code error;
  std::vector<mission::CatalogueEntry> entries;
  if (folder_or_mission.empty() || std::filesystem::is_directory(folder_or_mission, error)) {
    entries = mission::list_missions(folder_or_mission.empty() ? mission::missions_directory() : folder_or_mission,
                                     sensors::installation());
  } else {
    const mission::Installation installation = sensors::installation();
    entries = {mission::entry_of(mission::find_mission(folder_or_mission, installation), installation)};
  }
  std::size_t width = 0;
  for (const mission::CatalogueEntry& entry : entries) width = std::max(width, entry.name.size());
  for (const mission::CatalogueEntry& entry : entries) fmt::print("{}\n", mission::line_of(entry, width));
  return std::ranges::all_of(entries, &mission::CatalogueEntry::good) ? kDone : kFailed;
}

// vbar keys: the reference of mission files.

namespace {

using mission::DescribedKey;

/// A cell of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t k = 0; (k = text.find('|', k)) != std::string::npos; k += 2) text.insert(k, 1, '\\');
  return text;
}

void print_markdown(const std::vector<DescribedKey>& keys) {
  fmt::print(
      "# Keys of mission files\n\nWritten by `vbar keys --markdown` from the readers of mission files, for the "
      "missions of this "
      "repository, and from data/mission_keys.toml, which has the meaning of each. `vbar keys WORD` prints those with "
      "a "
      "word.\n");
  const std::string* table = nullptr;
  for (const DescribedKey& entry : keys) {
    if (entry.key.accepted == mission::kTable) continue;  // it has its own heading
    if (table == nullptr || *table != entry.table) {
      fmt::print("\n## {}\n\n| key | accepted | default | meaning |\n|---|---|---|---|\n",
                 entry.table.empty() ? "top of the file" : "[" + entry.table + "]");
      table = &entry.table;
    }
    fmt::print("| `{}` | {} | {} | {} |\n", entry.key.name, cell(entry.key.accepted), cell(entry.key.default_value),
               cell(entry.meaning));
  }
}

std::string name_of(const DescribedKey& entry) {
  return entry.table.empty() ? entry.key.name : entry.table + "." + entry.key.name;
}

void print_entry(const DescribedKey& entry) {
  std::string accepted = entry.key.accepted;
  if (!entry.key.default_value.empty()) accepted += "; default " + entry.key.default_value;
  fmt::print("{}\n", name_of(entry));
  if (!accepted.empty()) fmt::print("    {}\n", accepted);
  fmt::print("    {}\n", entry.meaning);
}

/// Names before meanings, and whole words before beginnings of words.
int rank_of(const DescribedKey& entry, const std::string& word) {
  const auto by_name = static_cast<int>(mission::match_of(word, name_of(entry)));
  const auto by_meaning = static_cast<int>(mission::match_of(word, entry.meaning));
  return std::max(2 * by_name, by_meaning);
}

int print_lines(std::vector<DescribedKey> keys, const std::string& word) {
  std::erase_if(keys, [](const DescribedKey& entry) { return entry.key.accepted == mission::kTable; });
  std::vector<std::string> names;
  for (const DescribedKey& entry : keys) names.push_back(name_of(entry));
  std::erase_if(keys, [&](const DescribedKey& entry) { return rank_of(entry, word) == 0; });
  std::ranges::stable_sort(keys, std::ranges::greater(),
                           [&](const DescribedKey& entry) { return rank_of(entry, word); });
  std::ranges::for_each(keys, print_entry);
  if (!keys.empty()) return kDone;
  files::print_error("vbar",
                     fmt::format("no key of a mission has the word '{}'{}", word, mission::word_meant(word, names)));
  return kRefused;
}

}  // namespace

int keys_command(const std::string& word, bool markdown) {
  testbeds::require_all_drivers();
  const std::vector<DescribedKey> keys = mission::key_reference(mission::missions_directory(), sensors::installation());
  if (!markdown) return print_lines(keys, word);
  print_markdown(keys);
  return kDone;
}

// vbar columns: the columns of the tables of a run folder.

namespace {

using report::DescribedTable;
using report::TableColumn;

/// The names of the columns from `first` to before `last`, elements of one array: all of a few, else the outermost.
std::string names_of(const std::vector<TableColumn>& columns, std::size_t first, std::size_t last) {
  constexpr std::size_t kFew = 6;
  if (last - first > kFew)
    return fmt::format("`{}` ... `{}` ({})", columns[first].name, columns[last - 1].name, last - first);
  std::string names;
  for (std::size_t k = first; k < last; ++k) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", columns[k].name);
  return names;
}

void print_markdown(const std::vector<DescribedTable>& tables) {
  fmt::print(
      "# Columns of the tables of a run\n\nWritten by `vbar columns --markdown`. [run_folder.md](run_folder.md) states "
      "what a row of each table is. A name ends in its unit, unless the meaning states it: `mps` m/s, `radps` rad/s. "
      "`vbar columns WORD` prints those with a word.\n");
  for (const DescribedTable& table : tables) {
    fmt::print("\n## {}\n\n| column | meaning |\n|---|---|\n", table.file);
    const std::vector<TableColumn>& columns = table.columns;
    for (std::size_t first = 0; first < columns.size();) {
      std::size_t last = first + 1;
      while (last < columns.size() && columns[last].stem == columns[first].stem &&
             columns[last].meaning == columns[first].meaning)
        ++last;
      fmt::print("| {} | {} |\n", names_of(columns, first, last), columns[first].meaning);
      first = last;
    }
  }
}

int print_lines(const std::vector<DescribedTable>& tables, const std::string& word) {
  bool has_printed = false;
  std::vector<std::string> names;
  // Whole words before beginnings of words.
  for (const mission::Match match : {mission::Match::kWord, mission::Match::kWordStart})
    for (const DescribedTable& table : tables)
      for (const TableColumn& column : table.columns) {
        const std::string name = table.file + " " + column.name;
        if (std::max(mission::match_of(word, name), mission::match_of(word, column.meaning)) == match) {
          fmt::print("{}: {}\n", name, column.meaning);
          has_printed = true;
        }
        names.push_back(name);
      }
  if (has_printed) return kDone;
  const std::vector<report::ExplainedWord> values = report::explained_words();
  const bool is_value = std::ranges::find(values, word, &report::ExplainedWord::word) != values.end();
  files::print_error("vbar", fmt::format("no column of a table has the word '{}'{}", word,
                                         is_value ? fmt::format("; it is a value: vbar explain {}", word)
                                                  : mission::word_meant(word, names)));
  return kRefused;
}

}  // namespace

int columns_command(const std::string& word, bool markdown) {
  testbeds::require_all_drivers();
  const std::vector<DescribedTable> tables = report::described_tables(sensors::extensions());
  if (!markdown) return print_lines(tables, word);
  print_markdown(tables);
  return kDone;
}

// vbar explain: the words that a run prints.

namespace {

using report::ExplainedWord;

std::string of_what(const ExplainedWord& word) {
  return word.owner.empty() ? word.quantity : fmt::format("{} in {}", word.quantity, word.owner);
}

void print_word(const ExplainedWord& word) {
  fmt::print("{}: {}\n    meaning   {}\n", word.word, of_what(word), word.meaning);
  if (!word.response.empty()) fmt::print("    response  the flight software {}\n", word.response);
  if (!word.turn.empty()) fmt::print("    change    {}\n", word.turn);
}

void print_names(const std::vector<ExplainedWord>& words) {
  std::string before;
  for (const ExplainedWord& word : words) {
    const std::string heading = of_what(word);
    if (heading != before) fmt::print("{}{}:", before.empty() ? "" : "\n", heading);
    fmt::print(" {}", word.word);
    before = heading;
  }
  fmt::print("\n");
}

void print_markdown(const std::vector<ExplainedWord>& words) {
  fmt::print(
      "# Words of a run\n\nWritten by `vbar explain --markdown`: every word that terminal, tables and report print for "
      "a "
      "fault, a count, a verdict or another code. `vbar explain WORD` prints one of them. Counts and faults of the "
      "flight software stand in `summary.json` under `health`; [faults.md](faults.md) describes how faults are "
      "detected, [evidence.md](evidence.md#verdict) how the verdict is reached.\n");
  std::string before;
  for (const ExplainedWord& word : words) {
    const std::string heading = of_what(word);
    const bool is_fault = !word.response.empty();
    if (heading != before) {
      fmt::print("\n## `{}`\n\n| word | meaning |{} change |\n|---|---|{}---|\n", heading,
                 is_fault ? " the flight software |" : "", is_fault ? "---|" : "");
      before = heading;
    }
    fmt::print("| `{}` | {} |{} {} |\n", word.word, word.meaning, is_fault ? " " + word.response + " |" : "",
               word.turn);
  }
}

int print_explanation(const std::vector<ExplainedWord>& words, std::string name) {
  std::ranges::replace(name, ' ', '_');
  int printed = 0;
  std::vector<std::string_view> names;
  for (const ExplainedWord& word : words) {
    names.push_back(word.word);
    if (word.word != name) continue;
    print_word(word);
    ++printed;
  }
  if (printed > 0) return kDone;
  const auto nearest = mission::nearest_name(name, names);
  files::print_error("vbar", fmt::format("a run prints no word '{}'{}; vbar explain lists them", name,
                                         nearest ? fmt::format(", did you mean {}?", *nearest) : ""));
  return kRefused;
}

}  // namespace

int explain_command(const std::vector<std::string>& word, bool markdown) {
  const std::vector<ExplainedWord> words = report::explained_words();
  if (markdown) {
    print_markdown(words);
    return kDone;
  }
  if (word.empty()) {
    print_names(words);
    return kDone;
  }
  return print_explanation(words, fmt::format("{}", fmt::join(word, "_")));
}

}  // namespace vbar::app
