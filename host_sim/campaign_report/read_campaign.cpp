#include "host_sim/campaign_report/read_campaign.h"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/campaign_report/samples.h"

namespace vbar::campaign_report {

Campaign read_campaign(const std::filesystem::path& folder) {
  std::size_t number_of_cases = 0;
  Campaign campaign = read_campaign_json(folder / "campaign.json", number_of_cases);
  read_results(folder / "results.csv", number_of_cases, campaign);
  for (const double time_h : missing_samples(campaign))
    throw std::runtime_error(fmt::format("{}: no column \"samples.{}h. ...\", although campaign.json names that time",
                                         (folder / "results.csv").string(), time_h));
  return campaign;
}

}  // namespace vbar::campaign_report
