#pragma once
// Shares of work under a sanitizer, where statistics take twenty times as long.

#include "host_sim/io/address_sanitizer.h"

namespace vbar::test {

using io::kAddressSanitizer;

/// Number of cases of `all` that a statistical test runs: a sanitizer examines the code, not the statistics.
constexpr int share_under_sanitizers(int all) {
  return kAddressSanitizer ? (all + 9) / 10 : all;
}

}  // namespace vbar::test
