#pragma once
// Values of mission keys as text: what stands after the '=' of --set and in a cell of cases.csv.

#include <cstdint>
#include <string>

#include <toml++/toml.h>

namespace vbar::campaign {

/// The shortest TOML number that is read as exactly this double, the same in every locale.
[[nodiscard]] std::string text_of(double value);

/// A TOML value that is read as `value`; a text that is a plain name stands without its quotes, as --set accepts it.
[[nodiscard]] std::string text_of(const toml::node& value);

}  // namespace vbar::campaign
