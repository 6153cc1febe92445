#pragma once
// The random numbers of a campaign. Each is a function of the campaign's seed, the mission key, the index and its place
// alone, so that no worker, no order and no other key or case moves it.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::campaign {

/// `count` numbers, uniform on (0, 1), that belong to `key` at `index`.
[[nodiscard]] std::vector<double> uniforms_of(std::uint64_t campaign_seed, const std::string& key, std::uint64_t index,
                                              std::size_t count);

/// The uniform numbers of a key for each index of a campaign. Latin hypercube (McKay, Beckman, Conover 1979): of each
/// place exactly one index lies in each of `indices.size()` equal strata.
class DrawSource {
 public:
  enum class Sampling { kIndependent, kLatin };

  DrawSource(std::uint64_t campaign_seed, Sampling sampling, std::vector<std::uint64_t> indices);

  /// `count` numbers for each index, in the order of the indices.
  [[nodiscard]] std::vector<std::vector<double>> all_of(const std::string& key, std::size_t count) const;

 private:
  std::uint64_t seed_;
  Sampling sampling_;
  std::vector<std::uint64_t> indices_;
};

}  // namespace vbar::campaign
