#include "host_sim/files/plain_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "host_sim/files/text_lines.h"

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

}  // namespace vbar::files
