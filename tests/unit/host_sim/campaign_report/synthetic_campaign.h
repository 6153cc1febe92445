#pragma once
// A campaign that was never flown, with known distributions: what drives its figures and how often it fails is known.

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace vbar::campaign_report::test {

struct SyntheticCampaign {
  std::size_t cases = 100;
  bool is_swept = false;      ///< three values of the loss probability, the same seeds for each
  double sigma_scale = 1.0;   ///< of the filter's claims: 0.5 is a filter that claims half of its errors
  double failed_share = 0.0;  ///< of the cases: half of it failed, the rest over time, killed, lost, void, not begun
  std::size_t epochs = 20;    ///< of NEES and NIS
  bool is_independent = true;
  std::uint64_t seed = 1;
};

/// Writes campaign.json and results.csv. Navigation errors rise with the noise figure of the receiver's amplifier, and
/// do not depend on the masses.
void write_synthetic_campaign(const std::filesystem::path& folder, const SyntheticCampaign& campaign);

}  // namespace vbar::campaign_report::test
