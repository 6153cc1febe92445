// vbar keys: the reference of mission files.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "hil_drivers/testbeds.h"
#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/key_reference.h"
#include "host_sim/mission/nearest_name.h"
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
      "repository; meanings are the comments of the first mission that shows a key. `vbar keys WORD` prints those that "
      "contain "
      "a word.\n");
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

int print_lines(const std::vector<DescribedKey>& keys, const std::string& word) {
  int printed = 0;
  std::vector<std::string_view> names;
  for (const DescribedKey& entry : keys) {
    if (entry.key.accepted == mission::kTable) continue;
    names.push_back(entry.key.name);
    const std::string name = name_of(entry);
    if (name.find(word) == std::string::npos && entry.meaning.find(word) == std::string::npos) continue;
    fmt::print("{}\n    {}{}{}\n", name, entry.key.accepted,
               entry.key.default_value.empty() ? "" : "; default " + entry.key.default_value,
               entry.meaning.empty() ? "" : "\n    " + entry.meaning);
    ++printed;
  }
  if (printed > 0) return kDone;
  const auto nearest = mission::nearest_name(word, names);
  fmt::print(stderr, "vbar: no key of a mission contains '{}'{}\n", word,
             nearest ? fmt::format(" (did you mean {}?)", *nearest) : "");
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
