#pragma once
// A campaign and its cases as the page shows them: the content of campaign.json and results.csv.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::campaign_report {

enum class State { kNotBegun, kFlying, kComplete, kFailed, kOverTime, kKilled, kLost, kVoid };

/// A pass criterion on a figure of the summary. At least one of the limits is given.
struct Limit {
  std::string key;
  std::optional<double> max, min;
};

/// Requirement on the campaign as a whole.
struct Requirement {
  double pass_rate_min = 0.0, confidence = 0.0;  ///< 0 to 1, exclusive
};

struct Case {
  std::uint64_t number = 0;
  std::string seed;
  std::vector<std::string> inputs;  ///< values of the swept and dispersed keys, in the order of Campaign::keys
  State state = State::kNotBegun;
  std::optional<bool> passed;  ///< never empty for a complete case
  std::string failed_limits, reason, host, processor, folder;
  std::string verdict;  ///< on the mission of a complete case; empty in results of an older version
  std::uint64_t attempts = 0;
  double wall_s = 0.0, cpu_s = 0.0;  ///< NaN if it was not flown

  [[nodiscard]] bool is_complete() const { return state == State::kComplete; }
  /// Flown to an end that says whether it passed. A killed, lost or void case shows nothing of the system under test.
  [[nodiscard]] bool is_judged() const {
    return state == State::kComplete || state == State::kFailed || state == State::kOverTime;
  }
  [[nodiscard]] bool has_passed() const { return is_complete() && passed.value_or(false); }
};

/// A figure of the summaries: a value for each case, in the order of Campaign::cases; NaN where there is none.
struct Figure {
  std::string key;
  std::vector<double> values;
};

struct Campaign {
  std::string name, description, mission, vbar_version, program_sha256;
  std::vector<std::string> keys;   ///< swept and dispersed keys of the mission
  std::vector<std::string> swept;  ///< those keys that are swept
  std::vector<Limit> limits;       ///< one for each key
  std::vector<double> samples_h;
  std::optional<Requirement> requirement;
  bool is_independent = true;  ///< cases are independent draws: bounds hold
  std::vector<Case> cases;     ///< by number
  std::vector<Figure> figures;

  /// Returns null if no case has the figure.
  [[nodiscard]] const Figure* figure(std::string_view key) const;
};

/// "over time"
[[nodiscard]] std::string_view name_of(State state);

// Reads what the page is made of.

/// Reads campaign.json and results.csv. Throws std::runtime_error that names file, line, column or key and the accepted
/// values: for a missing file, column or case, a case that occurs twice, a number that is not finite, and a case whose
/// result contradicts the limits.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& folder);

/// The parts of it.
[[nodiscard]] Campaign read_campaign_json(const std::filesystem::path& file, std::size_t& number_of_cases);
void read_results(const std::filesystem::path& file, std::size_t number_of_cases, Campaign& campaign);

}  // namespace vbar::campaign_report
