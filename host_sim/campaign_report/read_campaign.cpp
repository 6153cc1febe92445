#include "host_sim/campaign_report/read_campaign.h"

namespace vbar::campaign_report {

Campaign read_campaign(const std::filesystem::path& folder) {
  std::size_t number_of_cases = 0;
  Campaign campaign = read_campaign_json(folder / "campaign.json", number_of_cases);
  read_results(folder / "results.csv", number_of_cases, campaign);
  return campaign;
}

}  // namespace vbar::campaign_report
