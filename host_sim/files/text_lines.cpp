#include "host_sim/files/text_lines.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

namespace vbar::files {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kGzip = "\x1f\x8b"sv;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF"sv;

/// First bytes of contents that are not read, in lower case where they are letters of a page.
struct Signature {
  std::string_view bytes, name;
};
constexpr std::array kUnreadable{
    Signature{kGzip, "data compressed by gzip twice"},
    Signature{"\x1f\x9d"sv, "data compressed by compress (.Z)"},
    Signature{"PK\x03\x04"sv, "a zip archive"},
    Signature{"BZh"sv, "data compressed by bzip2"},
    Signature{"\xFD"
              "7zXZ\0"sv,
              "data compressed by xz"},
    Signature{"\x28\xB5\x2F\xFD"sv, "data compressed by zstd"},
    Signature{"7z\xBC\xAF\x27\x1C"sv, "a 7-Zip archive"},
    Signature{"\xFF\xFE"sv, "text in UTF-16"},
    Signature{"\xFE\xFF"sv, "text in UTF-16"},
    Signature{"%PDF"sv, "a PDF document"},
    Signature{"<!doctype html"sv, "an HTML page, which servers send in place of a file"},
    Signature{"<html"sv, "an HTML page, which servers send in place of a file"},
};

[[noreturn]] void refuse(const std::string& file, std::string_view found) {
  throw std::runtime_error(
      fmt::format("{}: found {}, expected text, plain or compressed by gzip", printable(file), found));
}

bool begins_as(std::string_view contents, std::string_view signature) {
  const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  if (contents.starts_with(signature)) return true;
  return signature.front() == '<' && contents.size() >= signature.size() &&
         std::ranges::equal(contents.substr(0, signature.size()), signature, {}, lower);
}

/// One inflation; a file may hold several streams one after the other.
class Inflation {
 public:
  Inflation(std::string& contents, const std::string& file) : file_(file) {
    constexpr int kGzipHeader = 16;
    if (contents.size() > kLargestText) refuse(file_, fmt::format("{} bytes of compressed data", contents.size()));
    stream_.next_in = reinterpret_cast<Bytef*>(contents.data());
    stream_.avail_in = static_cast<uInt>(contents.size());
    if (inflateInit2(&stream_, kGzipHeader + MAX_WBITS) != Z_OK) throw std::runtime_error("zlib has no memory");
  }
  ~Inflation() { inflateEnd(&stream_); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;

  std::string read(std::size_t largest) {
    std::string text;
    do {
      read_stream(text, largest);
    } while (has_another());
    return text;
  }

 private:
  void read_stream(std::string& text, std::size_t largest) {
    constexpr std::size_t kChunk = std::size_t{1} << 16;
    std::array<char, kChunk> chunk;  // filled by zlib
    for (int status = Z_OK; status != Z_STREAM_END;) {
      stream_.next_out = reinterpret_cast<Bytef*>(chunk.data());
      stream_.avail_out = static_cast<uInt>(chunk.size());
      status = inflate(&stream_, Z_NO_FLUSH);
      text.append(chunk.data(), chunk.size() - stream_.avail_out);
      if (text.size() > largest) refuse(file_, fmt::format("gzip data that decompress to more than {} bytes", largest));
      if (status == Z_BUF_ERROR)
        refuse(file_, fmt::format("a gzip stream that is cut short after {} bytes of text", text.size()));
      if (status != Z_OK && status != Z_STREAM_END)
        refuse(file_, fmt::format("a damaged gzip stream ({})", stream_.msg == nullptr ? "zlib" : stream_.msg));
    }
  }

  /// Zeros behind a stream are padding.
  bool has_another() {
    const std::string_view rest(reinterpret_cast<const char*>(stream_.next_in), stream_.avail_in);
    if (rest.find_first_not_of('\0') == std::string_view::npos) return false;
    return inflateReset(&stream_) == Z_OK;
  }

  z_stream stream_{};
  const std::string& file_;
};

}  // namespace

std::string plain_text(std::string contents, const std::string& file, std::size_t largest) {
  if (contents.starts_with(kGzip)) contents = Inflation(contents, file).read(largest);
  for (const Signature& signature : kUnreadable)
    if (begins_as(contents, signature.bytes)) refuse(file, signature.name);
  if (const auto nul = contents.find('\0'); nul != std::string::npos)
    refuse(file, fmt::format("a byte 0 at position {}, as binary data have it", nul + 1));
  if (contents.starts_with(kByteOrderMark)) contents.erase(0, kByteOrderMark.size());
  return contents;
}

namespace {

constexpr std::string_view kBlanks = " \t\r";

/// Bytes of the character that `text` begins with; 0 if it is not one of UTF-8.
std::size_t character_bytes(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t count = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  const auto follows = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  return count <= text.size() && std::ranges::all_of(text.substr(1, count - 1), follows) ? count : 0;
}

/// The controls of ASCII and those that ISO 6429 adds, U+0080 to U+009F.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<double> number_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('+')) return std::nullopt;
  std::array<char, 64> digits{};
  if (text.empty() || text.size() > digits.size()) return std::nullopt;
  std::ranges::transform(text, digits.begin(), [](char c) { return c == 'D' || c == 'd' ? 'e' : c; });
  double value = 0.0;
  const char* const end = digits.data() + text.size();
  const auto [at, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc{} || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> integer_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  int value = 0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text.front() == '+' || error != std::errc{} || at != text.data() + text.size())
    return std::nullopt;
  return value;
}

std::vector<std::string_view> split_at(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 100;
  const bool is_long = text.size() > kLongest;
  std::string shown(text.substr(0, kLongest));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = c == '\t' ? ' ' : '?';
  return fmt::format("\"{}{}\"", shown, is_long ? "..." : "");
}

std::string printable(std::string_view message) {
  std::string shown;
  while (!message.empty()) {
    const std::size_t bytes = character_bytes(message);
    const std::string_view character = message.substr(0, std::max<std::size_t>(1, bytes));
    if (bytes == 0 || is_control(character))
      shown += '?';
    else
      shown += character;
    message.remove_prefix(character.size());
  }
  return shown;
}

bool TextLines::next() {
  if (rest_.empty()) return false;
  const auto end = rest_.find('\n');
  is_ended_ = end != std::string_view::npos;
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

std::string_view TextLines::columns(std::size_t first, std::size_t last) const {
  if (first > line_.size()) return {};
  return line_.substr(first - 1, last - first + 1);
}

bool TextLines::is_cut_in(std::size_t first, std::size_t last) const {
  return line_.size() < last && !trimmed(columns(first, last)).empty();
}

std::optional<double> TextLines::number_or_blank_in(std::size_t first, std::size_t last, std::string_view what) const {
  if (trimmed(columns(first, last)).empty()) return std::nullopt;
  return number_in(first, last, what);
}

double TextLines::number_in(std::size_t first, std::size_t last, std::string_view what) const {
  const auto value = number_of(columns(first, last));
  if (!value || is_cut_in(first, last)) refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

int TextLines::integer_in(std::size_t first, std::size_t last, std::string_view what) const {
  const auto value = integer_of(columns(first, last));
  if (!value || is_cut_in(first, last)) refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

std::vector<std::string_view> TextLines::words() const {
  std::vector<std::string_view> words;
  std::string_view rest = line_;
  for (;;) {
    const auto begin = rest.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return words;
    const auto end = std::min(rest.find_first_of(kBlanks, begin), rest.size());
    words.push_back(rest.substr(begin, end - begin));
    rest.remove_prefix(end);
  }
}

void TextLines::check_ended() const {
  if (!is_ended_) refuse("a last row without a line feed", "one: its last number may be cut short");
}

void TextLines::refuse(std::string_view expected) const {
  refuse(quoted(line_), expected);
}

void TextLines::refuse(std::string_view found, std::string_view expected) const {
  throw FormatError(
      printable(fmt::format("{}:{}: found {}, expected {}", file_, std::max(number_, 1), found, expected)));
}

void print_error(std::string_view program, std::string_view message) {
  static_cast<void>(std::fputs(fmt::format("{}: {}\n", program, printable(message)).c_str(), stderr));
}

std::string parse_error_text(std::string_view message) {
  return fmt::format("{}\nRun with --help for more information.\n", printable(message));
}

}  // namespace vbar::files
