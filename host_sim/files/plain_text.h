#pragma once
// Text of a data file as its producer distributes it: compressed by gzip, with a byte order mark, or not text at all.

#include <cstddef>
#include <string>

namespace vbar::files {

/// Bytes of a decompressed text: twice the largest gravity model that is published (degree 2190).
inline constexpr std::size_t kLargestText = std::size_t{1} << 29;

/// The text in `contents`, those of `file`: gzip streams are decompressed, a byte order mark of UTF-8 is dropped.
/// Throws std::runtime_error that names the file and what was found, for a gzip stream that is damaged, cut short or
/// longer than `largest` bytes, for other compressions, and for contents that are not text.
[[nodiscard]] std::string plain_text(std::string contents, const std::string& file, std::size_t largest = kLargestText);

}  // namespace vbar::files
