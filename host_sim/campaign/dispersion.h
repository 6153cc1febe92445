#pragma once
// Dispersed keys: distributions by name. A distribution is one function and one line of the list in dispersion.cpp.

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/campaign/draws.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::campaign {

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
