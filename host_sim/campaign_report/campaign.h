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

/// Statistic of all cases that a requirement limits. kWorst: the largest with `most`, the smallest with `least`.
/// kShare: of the cases with one of the verdicts. kPassRate: share of the cases that keep all limits.
enum class Statistic { kMedian, kMean, kWorst, kPercentile, kShare, kPassRate };

/// Requirement on the campaign as a whole: a statistic and one limit, `most` or `least`.
struct Requirement {
  Statistic statistic = Statistic::kPassRate;
  std::string key;                    ///< figure of a summary; empty of shares
  double percentile = 0.0;            ///< of kPercentile, 0 to 100, exclusive
  std::vector<std::string> verdicts;  ///< of kShare
  std::optional<double> most, least;
  std::optional<double> confidence;  ///< the bound of this confidence keeps the limit; never empty of shares
  std::size_t allow_missing = 0;     ///< cases that may lack the figure or the verdict
  std::string paper = {};            ///< cell of a published table that the limit is about, for the reader

  /// A rate that is to be shown by the lower Clopper-Pearson bound.
  [[nodiscard]] static Requirement pass_rate(double least, double confidence) {
    return {Statistic::kPassRate, {}, 0.0, {}, {}, least, confidence};
  }
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
  std::string commit;              ///< of the program; empty in campaigns of an older version
  std::string seeds_from;          ///< commit of which the seeds were drawn; empty if they were stated
  std::vector<std::string> keys;   ///< swept and dispersed keys of the mission
  std::vector<std::string> swept;  ///< those keys that are swept
  std::vector<Limit> limits;       ///< one for each key
  std::vector<double> samples_h;
  std::vector<Requirement> requirements;
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

/// The same with `results` as the lines of results.csv.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& folder, std::vector<std::string> results);

/// The parts of it.
[[nodiscard]] Campaign read_campaign_json(const std::filesystem::path& file, std::size_t& number_of_cases);
void read_results(const std::filesystem::path& file, std::vector<std::string> lines, std::size_t number_of_cases,
                  Campaign& campaign);

}  // namespace vbar::campaign_report
