#pragma once
// Values of mission keys as text: what stands after the '=' of --set and in a cell of cases.csv.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "host_sim/campaign/dispersion.h"
#include "host_sim/campaign_report/campaign.h"
#include "host_sim/mission/mission.h"

namespace vbar::campaign {

/// The shortest TOML number that is read as exactly this double, the same in every locale.
[[nodiscard]] std::string text_of(double value);

/// A TOML value that is read as `value`; a text that is a plain name stands without its quotes, as --set accepts it.
[[nodiscard]] std::string text_of(const toml::node& value);

// A campaign file (TOML): a mission, seeds, sweeps, dispersions, pass criteria, what is kept, limits. docs/campaigns.md
// explains its keys.

/// Keys that take the values of a row together; the rows are swept one after the other.
struct Sweep {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> rows;  ///< text of each key's value
};

using PassCriterion = mission::Limit;

using Requirement = campaign_report::Requirement;

/// Seeds that are drawn when the campaign is made: seeds = { count = 100, from = "commit" }.
struct SeedDraw {
  std::size_t count = 0;
  std::string where;  ///< "file:line" of the key
};

/// Selection of the run folders that stay.
struct Keep {
  enum class Kind { kSummary, kFailed, kWorst, kAll };
  Kind kind = Kind::kSummary;
  std::size_t worst = 0;  ///< number of the worst cases by each pass criterion
};

struct CampaignFile {
  std::filesystem::path file;
  std::string name, description;
  std::string mission;                ///< as in the file: a path relative to it, or a name of the catalogue
  std::vector<std::uint64_t> seeds;   ///< empty until they are drawn
  std::optional<SeedDraw> seed_draw;  ///< none of stated seeds
  std::string seeds_from;             ///< commit of which the seeds were drawn
  std::uint64_t seed = 1;             ///< seed of the draws
  std::vector<std::string> set;       ///< "path=value", for all cases
  Keep keep;
  std::vector<double> samples_h;
  double case_time_limit_s = 0.0;        ///< 0: no limit
  double expected_case_s = 0.0;          ///< processor time, for the number of workers
  std::int64_t retries = 2;              ///< further flights of a case that was killed
  std::int64_t stop_after_failures = 0;  ///< 0: never
  bool common_draws = true;              ///< the sweep points share their draws
  DrawSource::Sampling sampling = DrawSource::Sampling::kIndependent;
  std::vector<Sweep> sweeps;
  std::vector<Dispersion> dispersions;
  std::vector<PassCriterion> passes;
  std::vector<Requirement> requirements;

  /// Swept keys, then dispersed ones, in the order of the file.
  [[nodiscard]] std::vector<std::string> swept_keys() const;
  [[nodiscard]] std::vector<std::string> keys() const;
};

/// Throws MissionError that names place, key and what is accepted.
[[nodiscard]] CampaignFile read_campaign_file(const std::filesystem::path& file);
[[nodiscard]] CampaignFile parse_campaign(std::string_view text, const std::filesystem::path& file);

// Seeds that were never used before: drawn from the commit of the program and the campaign's name, so that every commit
// flies others, and the same commit the same ones.

/// Draws the seeds of a campaign that asks for it. `commit`: of the program as `vbar --version` prints it;
/// `seeds_from`: the commit to draw from instead, 7 to 64 hexadecimal digits of which the first twelve count, with a
/// "+" behind them for changed files; empty: `commit`. Throws MissionError that names the key if there is none,
/// app::Refused for an invalid `seeds_from` or one without effect.
void draw_seeds(CampaignFile& campaign, const std::string& commit, const std::string& seeds_from);

/// Returns what seeds are drawn from: the twelve digits, with the mark of changed files; empty if `commit` is not one.
[[nodiscard]] std::string seed_origin(std::string_view commit);

// A sweep of a CSV table: a head of mission keys, then a row of values for each sweep point.

/// `key` of `section` names the file. Throws MissionError that names file, line and what is accepted.
[[nodiscard]] Sweep read_sweep_table(const mission::TableReader& section, std::string_view key,
                                     const std::filesystem::path& file);

}  // namespace vbar::campaign
