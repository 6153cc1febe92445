#pragma once
// The cases of a campaign: one flight each, a function of the campaign file and the case's number alone.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"

namespace vbar::campaign {

struct Case {
  std::size_t number = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> values;  ///< text of each key's value, in the order of CampaignFile::keys()
};

/// All sweep points of the first seed, then those of the next one. A draw belongs to the seed: a seed, a key or a sweep
/// value that is added leaves the draws of all others as they are.
[[nodiscard]] std::vector<Case> expand(const CampaignFile& campaign);

/// cases.csv: number, seed and the value of each key.
[[nodiscard]] std::string cases_text(const std::vector<std::string>& keys, const std::vector<Case>& cases);

/// Throws std::runtime_error that names file and line.
[[nodiscard]] std::vector<Case> read_cases(const std::filesystem::path& file, const std::vector<std::string>& keys);

/// "000417": the name of the case's folder.
[[nodiscard]] std::string name_of_case(std::size_t number);

// "0-99,417": numbers of cases on the command line.

/// Returns the numbers, sorted. Throws app::Refused unless all are below `cases`.
[[nodiscard]] std::vector<std::size_t> selected_cases(const std::string& text, std::size_t cases);

}  // namespace vbar::campaign
