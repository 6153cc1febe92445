#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vbar::campaign_report::test {
namespace {

constexpr int kStates = 6;         // of the NEES
constexpr double kLimit_m = 0.02;  // of the navigation error
constexpr double kFirstEpoch_h = 39.25;
constexpr std::array kLosses{0.0, 0.05, 0.2};

struct Source {
  std::mt19937_64 engine;
  std::normal_distribution<double> normal_distribution{};

  double normal(double mean, double sigma) { return mean + sigma * normal_distribution(engine); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  double chi_square(int degrees) {
    double sum = 0.0;
    for (int k = 0; k < degrees; ++k) {
      const double value = normal(0.0, 1.0);
      sum += value * value;
    }
    return sum;
  }
};

double epoch_h(std::size_t k) {
  return kFirstEpoch_h + 0.125 * static_cast<double>(k);
}

/// What a case ended in, and its reason.
struct End {
  std::string state = "complete", reason = "";
};

End end_of(double draw, double failed_share, Source& source) {
  if (draw < 0.5 * failed_share) {
    const bool is_collision = source.uniform(0.0, 1.0) < 0.3;
    return {"failed", is_collision
                          ? fmt::format("the spacecraft collided {:.1f} s after the epoch", source.uniform(1e5, 1.5e5))
                          : "the flight software reported \"never navigated\", and ended"};
  }
  const std::array<End, 5> others{
      End{"over_time", "600 s of processor time were used"}, End{"killed", "ended by signal 9"},
      End{"lost", "killed 3 times, the last time by signal 9"},
      End{"void", "the fault \"thruster sticks\" did not take effect"}, End{"not_begun", ""}};
  return draw < failed_share ? others[source.engine() % others.size()] : End{};
}

std::string json_of(const SyntheticCampaign& campaign) {
  std::vector<std::string> samples;
  for (std::size_t k = 0; k < campaign.epochs; ++k) samples.push_back(fmt::format("{}", epoch_h(k)));
  return fmt::format(
      R"({{"format": 1, "name": "experiment3_dispersed", "description": "Masses and noise figures dispersed",
 "mission": "experiment3", "vbar_version": "0.1.0", "program_sha256": "{}", "cases": {},
 "keys": ["links.crosslink.loss_probability", "spacecraft.servicer.mass_kg", "spacecraft.target.mass_kg",
          "spacecraft.servicer.sensors.gnss.link_budget.lna_noise_figure_db"],
 "swept": [{}],
 "pass": [{{"key": "waypoints.10.navigation_error_m", "most": {}, "least": null}}],
 "samples_h": [{}], "require": {{"pass_rate_at_least": 0.95, "confidence": 0.95}}, "independent": {}}})",
      std::string(64, 'a'), campaign.cases, campaign.is_swept ? R"("links.crosslink.loss_probability")" : "", kLimit_m,
      fmt::join(samples, ", "), campaign.is_independent);
}

std::string header(const SyntheticCampaign& campaign) {
  std::string line =
      "case,seed,links.crosslink.loss_probability,spacecraft.servicer.mass_kg,spacecraft.target.mass_kg,"
      "spacecraft.servicer.sensors.gnss.link_budget.lna_noise_figure_db,state,verdict,passed,failed_limits,reason,"
      "attempts,"
      "host,"
      "processor,wall_s,cpu_s,commands_sha256,telemetry_sha256,waypoints_sha256,folder,waypoints.10.navigation_error_m,"
      "waypoints.10.control_error_m,waypoints.10.control_error_r_m,waypoints.10.control_error_t_m,"
      "waypoints.10.control_error_n_m,dv_mps";
  for (std::size_t k = 0; k < campaign.epochs; ++k)
    for (const char* const name : {"nees", "nees_dimension", "nis", "nis_dimension"})
      line += fmt::format(",samples.{}h.{}", epoch_h(k), name);
  return line + "\n";
}

std::string figures(const SyntheticCampaign& campaign, double error_m, double loss, Source& source) {
  const std::array miss_m{source.normal(0.004, 0.01), source.normal(0.0, 0.03), source.normal(0.0, 0.006)};
  std::string cells = fmt::format("{},{},{},{},{},{}", error_m, std::hypot(miss_m[0], miss_m[1], miss_m[2]), miss_m[0],
                                  miss_m[1], miss_m[2], source.normal(0.0074, 0.0005) * (1.0 + loss));
  const double scale = 1.0 / (campaign.sigma_scale * campaign.sigma_scale);
  for (std::size_t k = 0; k < campaign.epochs; ++k) {
    const int measurements = 14 + static_cast<int>(source.engine() % 5);
    cells += fmt::format(",{},{},{},{}", scale * source.chi_square(kStates), kStates,
                         scale * source.chi_square(measurements), measurements);
  }
  return cells;
}

std::string row(const SyntheticCampaign& campaign, std::size_t number, Source& source) {
  const std::size_t seeds = campaign.is_swept ? (campaign.cases + kLosses.size() - 1) / kLosses.size() : campaign.cases;
  const double loss = kLosses[campaign.is_swept ? number / seeds : 0];
  const double servicer_kg = source.normal(154.0, 2.0), target_kg = source.normal(40.0, 1.0);
  const double noise_figure_db = source.uniform(1.0, 4.0);
  const End end = end_of(source.uniform(0.0, 1.0), campaign.failed_share, source);
  const double error_m = 0.0038 * std::exp(0.25 * (noise_figure_db - 2.0) + loss + source.normal(0.0, 0.35));
  const bool is_complete = end.state == "complete", was_flown = end.state != "not_begun";
  const bool has_passed = error_m <= kLimit_m;
  std::string line = fmt::format("{},{},{},{},{},{},{}", number, number % seeds + 1, loss, servicer_kg, target_kg,
                                 noise_figure_db, end.state);
  line += is_complete ? fmt::format(",{},{},{}", number % 2 == 0 ? "achieved" : "missed", has_passed ? 1 : 0,
                                    has_passed ? "" : "waypoints.10.navigation_error_m")
                      : ",,,";
  std::string reason = end.reason;
  for (std::size_t k = 0; (k = reason.find('"', k)) != std::string::npos; k += 2) reason.insert(k, 1, '"');
  line += fmt::format(",\"{}\",{}", reason, was_flown ? 1 + (source.engine() % 50 == 0 ? 1 : 0) : 0);
  const bool is_old = source.engine() % 3 == 0;
  const double cpu_s = (is_old ? 1.1 : 0.7) * std::exp(source.normal(0.0, 0.08));
  line += was_flown ? fmt::format(",node{},{},{:.4f},{:.4f}", source.engine() % 8 + 1,
                                  is_old ? "Intel Xeon E5-2680 v4" : "AMD EPYC 7543", 1.05 * cpu_s, cpu_s)
                    : ",,,,";
  line += is_complete ? fmt::format(",{0:064x},{0:064x},{0:064x},", number) : ",,,,";
  line += has_passed || !is_complete ? "" : fmt::format("runs/{:06}", number);
  const std::string cells = figures(campaign, error_m, loss, source);
  return line + "," +
         (is_complete ? cells : std::string(static_cast<std::size_t>(std::ranges::count(cells, ',')), ',')) + "\n";
}

}  // namespace

void write_synthetic_campaign(const std::filesystem::path& folder, const SyntheticCampaign& campaign) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "campaign.json", std::ios::binary) << json_of(campaign) << "\n";
  std::ofstream results(folder / "results.csv", std::ios::binary);
  results << header(campaign);
  Source source{std::mt19937_64(campaign.seed)};
  for (std::size_t number = 0; number < campaign.cases; ++number) results << row(campaign, number, source);
}

}  // namespace vbar::campaign_report::test
