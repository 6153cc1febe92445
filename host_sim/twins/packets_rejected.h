#pragma once

#include <string_view>

namespace vbar::twins {

/// A note of a measurement, and of a source's statistics a figure: number of its packets that were not accepted.
inline constexpr std::string_view kPacketsRejected = "packets_rejected";

}  // namespace vbar::twins
