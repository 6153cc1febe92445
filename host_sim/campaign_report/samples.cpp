#include "host_sim/campaign_report/samples.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::campaign_report {
namespace {

constexpr double kSameTime_h = 1e-6;

/// The time of "samples.<time>h.<rest>", and the rest.
std::optional<std::pair<double, std::string_view>> sample_of(std::string_view key) {
  constexpr std::string_view kPrefix = "samples.", kUnit = "h.";
  if (!key.starts_with(kPrefix)) return std::nullopt;
  double time_h = 0.0;
  const char* const end = key.data() + key.size();
  const auto [after, error] = std::from_chars(key.data() + kPrefix.size(), end, time_h);
  const std::string_view rest(after, static_cast<std::size_t>(end - after));
  if (error != std::errc{} || !rest.starts_with(kUnit)) return std::nullopt;
  return std::pair{time_h, rest.substr(kUnit.size())};
}

std::vector<NormalisedError> errors_of(const Campaign& campaign, const Figure& values, const Figure& dimensions,
                                       const std::vector<std::size_t>& places) {
  std::vector<NormalisedError> errors;
  for (const std::size_t place : places) {
    const double value = values.values[place], dimension = dimensions.values[place];
    if (!campaign.cases[place].is_complete() || std::isnan(value)) continue;
    if (value == 0.0 && dimension == 0.0) continue;  // nothing was measured
    if (!(value >= 0.0) || !(dimension > 0.0))
      throw std::runtime_error(
          fmt::format("results.csv: case {}: \"{}\" is {} with \"{}\" {}; neither can be negative, "
                      "and one requires the other",
                      campaign.cases[place].number, values.key, value, dimensions.key,
                      std::isnan(dimension) ? "missing" : fmt::format("{}", dimension)));
    errors.push_back({value, dimension});
  }
  return errors;
}

}  // namespace

std::vector<Epoch> epochs_of(const Campaign& campaign, std::string_view name, const std::vector<std::size_t>& places) {
  std::vector<Epoch> epochs;
  for (const Figure& values : campaign.figures) {
    const auto sample = sample_of(values.key);
    if (!sample || sample->second != name) continue;
    const Figure* const dimensions = campaign.figure(values.key + "_dimension");
    if (dimensions == nullptr)
      throw std::runtime_error(fmt::format("results.csv: no column \"{}_dimension\"", values.key));
    const std::vector<NormalisedError> errors = errors_of(campaign, values, *dimensions, places);
    if (!errors.empty()) epochs.push_back(epoch_of(sample->first, errors));
  }
  std::ranges::sort(epochs, {}, &Epoch::time_h);
  return epochs;
}

std::vector<double> missing_samples(const Campaign& campaign) {
  std::vector<double> missing;
  if (std::ranges::none_of(campaign.cases, &Case::is_complete)) return missing;
  std::ranges::copy_if(campaign.samples_h, std::back_inserter(missing), [&](double time_h) {
    return std::ranges::none_of(campaign.figures, [&](const Figure& figure) {
      const auto sample = sample_of(figure.key);
      return sample && std::abs(sample->first - time_h) < kSameTime_h;
    });
  });
  return missing;
}

}  // namespace vbar::campaign_report
