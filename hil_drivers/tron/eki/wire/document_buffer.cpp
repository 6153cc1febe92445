#include <fmt/format.h>

#include "hil_drivers/tron/eki/wire/documents.h"

namespace vbar::tron::eki {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// Position behind the '>' that ends the tag at `begin`, quoted attribute values skipped; npos: not yet there.
std::size_t end_of_tag(std::string_view text, std::size_t begin) {
  char quote = 0;
  for (std::size_t k = begin; k < text.size(); ++k) {
    const char c = text[k];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return k + 1;
    }
  }
  return std::string_view::npos;
}

/// Length of the document at the beginning of `text`, which begins with '<'; 0: not complete.
std::size_t document_length(std::string_view text) {
  const std::size_t name_end = text.find_first_of(" \t\r\n/>", 1);
  const std::size_t tag_end = end_of_tag(text, 0);
  if (name_end == std::string_view::npos || tag_end == std::string_view::npos) return 0;
  if (text[tag_end - 2] == '/') return tag_end;
  const std::string closing = fmt::format("</{}", text.substr(1, name_end - 1));
  for (std::size_t at = text.find(closing, tag_end); at != std::string_view::npos; at = text.find(closing, at + 1)) {
    const std::size_t end = text.find_first_not_of(kBlanks, at + closing.size());
    if (end == std::string_view::npos) return 0;
    if (text[end] == '>') return end + 1;
  }
  return 0;
}

}  // namespace

std::optional<std::string> DocumentBuffer::next() {
  // A controller pads blocks with zeros; blanks between documents are allowed.
  const std::size_t begin = buffer_.find_first_not_of(std::string_view("\0 \t\r\n", 5));
  buffer_.erase(0, begin);
  if (buffer_.empty()) return std::nullopt;
  const auto discard = [&](const std::string& problem) {
    buffer_.clear();
    throw WireError(problem);
  };
  if (buffer_.front() != '<') discard(fmt::format("\"{}\" does not begin a document", wire::printable(buffer_)));
  const std::size_t length = document_length(std::string_view(buffer_).substr(0, kMaxDocumentBytes));
  if (length == 0) {
    if (buffer_.size() >= kMaxDocumentBytes)
      discard(fmt::format("a document does not end within {} bytes", kMaxDocumentBytes));
    return std::nullopt;
  }
  std::string document = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return document;
}

}  // namespace vbar::tron::eki
