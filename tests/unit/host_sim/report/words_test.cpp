// Every word that can be printed is explained.

#include "host_sim/report/words.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <vbar/fields.h>

#include "host_sim/report/run_record.h"

namespace vbar::report::test {
namespace {

/// All words of codes of a message, nested ones excluded.
template <class Message>
void collect(std::set<std::string>& words) {
  const Message message{};
  visit_fields(message, [&](const Field& field, const auto& /*value*/) {
    for (int k = 0; k < field.codes.count; ++k) words.insert(field.codes.codes[k].word);
  });
}

template <class... Rows>
std::set<std::string> words_of_telemetry(const std::tuple<std::vector<TelemetryRow<Rows>>...>&) {
  std::set<std::string> words;
  (collect<Rows>(words), ...);
  return words;
}

TEST(Words, EveryCodeOfTelemetryIsExplained) {
  std::set<std::string> printed = words_of_telemetry(TelemetryTables{});
  collect<mode_command>(printed);
  collect<waypoint>(printed);
  collect<maneuver_command>(printed);
  EXPECT_GT(printed.size(), 90U);
  EXPECT_TRUE(printed.contains("navigation_timeout"));
  const std::vector<ExplainedWord> explained = explained_words();
  for (const std::string& word : printed) {
    const auto found = std::ranges::find(explained, word, &ExplainedWord::word);
    ASSERT_NE(found, explained.end()) << word;
    EXPECT_GE(found->meaning.size(), 8U) << word;
  }
}

TEST(Words, EveryFaultHasAResponse) {
  int faults = 0;
  for (const ExplainedWord& word : explained_words()) {
    if (word.quantity != "fault") continue;
    ++faults;
    EXPECT_FALSE(word.response.empty()) << word.word;
  }
  EXPECT_EQ(faults, 31);
}

// The table of faults in fsw/faults says: retreat, at two of three checks.
TEST(Words, ResponseIsThatOfTheTableOfFaults) {
  const std::vector<ExplainedWord> explained = explained_words();
  const auto drift = std::ranges::find(explained, "drift_unsafe", &ExplainedWord::word);
  ASSERT_NE(drift, explained.end());
  EXPECT_EQ(drift->response, "retreats, in a mission with [safety], once 2 of 3 checks detect it");
  const auto unsafe = std::ranges::find(explained, "navigation_lost", &ExplainedWord::word);
  ASSERT_NE(unsafe, explained.end());
  EXPECT_EQ(unsafe->quantity, "verdict");
}

}  // namespace
}  // namespace vbar::report::test
