#pragma once
// The name under which sources note packets that were not accepted.

#include <string_view>

namespace vbar::twins {

/// Name of a note of a measurement, and of a figure of a source's statistics: number of its packets that were not
/// accepted.
inline constexpr std::string_view kPacketsRejected = "packets_rejected";

}  // namespace vbar::twins
