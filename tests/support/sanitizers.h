#pragma once
// Whether this program was built with a sanitizer, under which statistics take twenty times as long.

namespace vbar::test {

// GCC defines a macro; Clang 14 answers a question.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#else
inline constexpr bool kAddressSanitizer = false;
#endif

/// Number of cases of `all` that a statistical test runs: a sanitizer examines the code, not the statistics.
constexpr int share_under_sanitizers(int all) {
  return kAddressSanitizer ? (all + 9) / 10 : all;
}

}  // namespace vbar::test
