// The page of a campaign: from campaign.json and results.csv on disk to campaign.html on disk, by number of cases.

#include <cstddef>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "host_sim/campaign_report/write_page.h"
#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"

namespace {

void write_page(benchmark::State& state) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("vbar_campaign_page_" + std::to_string(::getpid()));
  vbar::campaign_report::test::write_synthetic_campaign(
      folder, {.cases = static_cast<std::size_t>(state.range(0)), .failed_share = 0.02});
  for (auto _ : state) vbar::campaign::write_page(folder);
  state.counters["page_bytes"] = static_cast<double>(std::filesystem::file_size(folder / "campaign.html"));
  std::filesystem::remove_all(folder);
}
BENCHMARK(write_page)->Name("campaign_report/page")->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
