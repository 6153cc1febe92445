// vbar columns: the columns of the tables of a run folder.

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/word_search.h"
#include "host_sim/report/run_tables.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {
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
  fmt::print(stderr, "vbar: no column of a table has the word '{}'{}\n", word,
             is_value ? fmt::format("; it is a value: vbar explain {}", word) : mission::word_meant(word, names));
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

}  // namespace vbar::app
