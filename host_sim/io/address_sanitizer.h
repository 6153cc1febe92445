#pragma once
// Whether this program was built with the address sanitizer, whose own memory is larger than the program's.

namespace vbar::io {

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

}  // namespace vbar::io
