#include "host_sim/campaign/draws.h"

#include <algorithm>
#include <numeric>

#include "host_sim/engine/random_stream.h"

namespace vbar::campaign {

std::vector<double> uniforms_of(std::uint64_t campaign_seed, const std::string& key, std::uint64_t index,
                                std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t block = 0; numbers.size() < count; ++block) {
    const std::string name = block == 0 ? key : key + "#" + std::to_string(block);
    const auto four = engine::RandomStream(campaign_seed, name).uniforms_of(index);
    numbers.insert(numbers.end(), four.begin(), four.begin() + std::min<std::ptrdiff_t>(4, count - numbers.size()));
  }
  return numbers;
}

DrawSource::DrawSource(std::uint64_t campaign_seed, Sampling sampling, std::vector<std::uint64_t> indices)
    : seed_(campaign_seed), sampling_(sampling), indices_(std::move(indices)) {}

std::vector<std::vector<double>> DrawSource::all_of(const std::string& key, std::size_t count) const {
  std::vector<std::vector<double>> all;
  for (const std::uint64_t index : indices_) all.push_back(uniforms_of(seed_, key, index, count));
  if (sampling_ == Sampling::kIndependent) return all;
  std::vector<std::vector<double>> order;
  for (const std::uint64_t index : indices_) order.push_back(uniforms_of(seed_, key + "#stratum", index, count));
  const auto strata = static_cast<double>(all.size());
  for (std::size_t place = 0; place < count; ++place) {
    std::vector<std::size_t> ranked(all.size());
    std::iota(ranked.begin(), ranked.end(), std::size_t{0});
    std::ranges::sort(ranked, {}, [&](std::size_t k) { return order[k][place]; });
    for (std::size_t stratum = 0; stratum < ranked.size(); ++stratum) {
      double& number = all[ranked[stratum]][place];
      number = (static_cast<double>(stratum) + number) / strata;
    }
  }
  return all;
}

}  // namespace vbar::campaign
