// vbar explain: the words that a run prints.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/nearest_name.h"
#include "host_sim/report/words.h"

namespace vbar::app {
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
  fmt::print(stderr, "vbar: a run prints no word '{}'{}; vbar explain lists them\n", name,
             nearest ? fmt::format(", did you mean {}?", *nearest) : "");
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
