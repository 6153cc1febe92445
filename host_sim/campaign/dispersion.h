#pragma once
// The random numbers of a campaign. Each is a function of the campaign's seed, the mission key, the index and its place
// alone, so that no worker, no order and no other key or case moves it.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/table_reader.h"

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

// Dispersed keys: distributions by name. A distribution is one function and one line of the list in dispersion.cpp.

struct Dispersion {
  std::vector<std::string> keys;  ///< keys of the mission; more than one if they are correlated
  std::size_t uniforms = 1;       ///< numbers that each key takes
  /// The text of each key's value; `u` holds the numbers of the keys in order.
  std::function<std::vector<std::string>(std::span<const double> u)> values;
};

/// An element of [[disperse]]; `table` is the one that `section` reads. Throws MissionError.
[[nodiscard]] Dispersion read_dispersion(const mission::TableReader& section, const toml::table& table);

/// A row of texts for each index of the source: a text of each key. Stream names are the key followed by `suffix`.
[[nodiscard]] std::vector<std::vector<std::string>> draw(const Dispersion& dispersion, const DrawSource& source,
                                                         const std::string& suffix);

}  // namespace vbar::campaign
