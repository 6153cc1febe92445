// vbar keys: the reference of mission files.

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/key_reference.h"
#include "host_sim/mission/word_search.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {
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
  fmt::print(stderr, "vbar: no key of a mission has the word '{}'{}\n", word, mission::word_meant(word, names));
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

}  // namespace vbar::app
