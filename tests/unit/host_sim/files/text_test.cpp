// Files as they are distributed: the compressed bytes were written by gzip 1.12 and Python's gzip module.

#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <unistd.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"

namespace vbar::files {

namespace {

using namespace std::string_view_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// printf '1 2\n3\n' | gzip -n
constexpr std::string_view kText = "1 2\n3\n";
constexpr std::string_view kGzip =
    "\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x33\x54\x30\xe2\x32\xe6\x02\x00\x7d\x63\x2e\xfc\x06\x00\x00\x00"sv;

// The letter a, 100000 times.
std::string small_bomb() {
  std::string stream(
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\xed\xc1\x31\x01\x00\x00\x00\xc2\xa0\xac\xeb\x5f\xc2\x1a\x1e\x40\x01"sv);
  stream.append(96, '\0');
  return stream.append("\xaf\x06\x87\xfa\xe2\x1b\xa0\x86\x01\x00"sv);
}

std::string complaint_about(std::string contents, std::size_t largest = kLargestText) {
  try {
    static_cast<void>(plain_text(std::move(contents), "brdc.rnx.gz", largest));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(PlainText, GzipIsDecompressed) {
  EXPECT_EQ(plain_text(std::string(kText), "f"), kText);
  EXPECT_EQ(plain_text(std::string(kGzip), "f"), kText);
  // RFC 1952, 2.2: a file may hold several members. Archives on tape are padded with zeros.
  EXPECT_EQ(plain_text(std::string(kGzip) + std::string(kGzip), "f"), "1 2\n3\n1 2\n3\n");
  EXPECT_EQ(plain_text(std::string(kGzip) + std::string(5, '\0'), "f"), kText);
}

TEST(PlainText, AStreamThatIsCutShortIsRefusedAtEveryLength) {
  for (std::size_t length = 2; length < kGzip.size(); ++length)
    EXPECT_THAT(
        complaint_about(std::string(kGzip.substr(0, length))),
        AllOf(StartsWith("brdc.rnx.gz: found a gzip stream that is cut short"), HasSubstr("compressed by gzip")))
        << length;
}

TEST(PlainText, ADamagedStreamIsRefused) {
  std::string damaged(kGzip);
  damaged[18] ^= 1;  // of the checksum
  EXPECT_THAT(complaint_about(damaged), HasSubstr("found a damaged gzip stream (incorrect data check)"));
  EXPECT_THAT(complaint_about(std::string(kGzip).append("x")), HasSubstr("gzip stream"));
}

TEST(PlainText, TheDecompressedSizeIsLimited) {
  EXPECT_EQ(plain_text(small_bomb(), "f", 100000), std::string(100000, 'a'));
  EXPECT_THAT(complaint_about(small_bomb(), 99999), HasSubstr("decompress to more than 99999 bytes"));
}

TEST(PlainText, WhatIsNotTextIsNamed) {
  EXPECT_THAT(complaint_about("\x1f\x9d\x90x"), HasSubstr("found data compressed by compress (.Z), expected text"));
  EXPECT_THAT(complaint_about("PK\x03\x04xx"), HasSubstr("a zip archive"));
  EXPECT_THAT(complaint_about("BZh91AY"), HasSubstr("bzip2"));
  EXPECT_THAT(complaint_about(std::string("\xFD"
                                          "7zXZ\0\0"sv)),
              HasSubstr("xz"));
  EXPECT_THAT(complaint_about("<!DOCTYPE HTML>\n<html>"), HasSubstr("an HTML page"));
  EXPECT_THAT(complaint_about("\xFF\xFE#\0"), HasSubstr("UTF-16"));
  EXPECT_THAT(complaint_about(std::string("ab\0c"sv)), HasSubstr("a byte 0 at position 3"));
}

TEST(PlainText, AByteOrderMarkIsDropped) {
  EXPECT_EQ(plain_text("\xEF\xBB\xBF"
                       "CCSDS_OEM_VERS = 2.0\n",
                       "f"),
            "CCSDS_OEM_VERS = 2.0\n");
}

TEST(PlainText, TheChecksumIsThatOfTheFileOnTheDisk) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("vbar_plain_text_" + std::to_string(::getpid()) + ".gz");
  std::ofstream(file, std::ios::binary) << kGzip;
  DataStream stream(file);
  EXPECT_EQ(stream.view(), kText);
  const auto read = files_read();
  const auto found = std::ranges::find(read, file, &FileRead::file);
  ASSERT_NE(found, read.end());
  EXPECT_EQ(found->bytes, kGzip.size());
  EXPECT_EQ(found->sha256, sha256_of(kGzip));
  std::filesystem::remove(file);
}

using testing::ThrowsMessage;

TextLines first_line_of(std::string_view text) {
  TextLines lines(text, "f.txt");
  lines.next();
  return lines;
}

TEST(TextLines, NumbersInColumns) {
  const TextLines lines = first_line_of("  1 -2.50        7\n");
  EXPECT_EQ(lines.integer_in(1, 3, "a count"), 1);
  EXPECT_EQ(lines.number_in(4, 9, "a length"), -2.5);
  EXPECT_EQ(lines.number_or_blank_in(10, 14, "a width"), std::nullopt);
  EXPECT_EQ(lines.number_or_blank_in(15, 18, "a width"), 7.0);
  EXPECT_EQ(lines.number_or_blank_in(19, 24, "a width"), std::nullopt) << "behind the end of the line";
  EXPECT_THAT([&] { static_cast<void>(lines.number_in(10, 14, "a width")); },
              ThrowsMessage<FormatError>(
                  HasSubstr("f.txt:1: found \"  1 -2.50        7\", expected a width in columns 10 to 14")));
}

// 5.1537E+03 cut to 5.1537E+0 is a number too, a thousand times too small.
TEST(TextLines, ANumberThatIsCutShortIsRefused) {
  const std::string_view whole = "A 5.1537E+03\n";
  EXPECT_EQ(first_line_of(whole).number_in(3, 12, "sqrt_a"), 5153.7);
  for (std::size_t length = 4; length < 12; ++length) {
    const TextLines lines = first_line_of(whole.substr(0, length));
    EXPECT_TRUE(lines.is_cut_in(3, 12));
    EXPECT_FALSE(lines.is_ended());
    EXPECT_THROW(static_cast<void>(lines.number_in(3, 12, "sqrt_a")), FormatError) << length;
    EXPECT_THROW(static_cast<void>(lines.number_or_blank_in(3, 12, "sqrt_a")), FormatError) << length;
  }
  EXPECT_TRUE(first_line_of(whole).is_ended());
}

TEST(TextLines, MessagesHoldNoControlCharacters) {
  EXPECT_EQ(printable("a\x1b[2Jb\x07\x7f\r"), "a?[2Jb???");
  EXPECT_EQ(printable("no_such\nvbar: verdict achieved"), "no_such?vbar: verdict achieved") << "one message, one line";
  EXPECT_EQ(printable("Gr\xC3\xB6\xC3\x9F"
                      "e \xF0\x9F\x9B\xB0"),
            "Gr\xC3\xB6\xC3\x9F"
            "e \xF0\x9F\x9B\xB0");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "?31m")
      << "the control sequence introducer of ISO 6429";
  EXPECT_EQ(printable("\x9b\xC3("),
            "?"
            "?(")
      << "not UTF-8";
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "?x");
  EXPECT_THAT([] { first_line_of("a\n").refuse("norm \x1b[31m", "another"); },
              ThrowsMessage<FormatError>("f.txt:1: found norm ?[31m, expected another"));
}

// A file of the system whose first byte cannot be read, as on a disk that fails.
TEST(ContentsOf, AFileThatFailsHalfwayHasNone) {
  EXPECT_EQ(contents_of("/proc/self/mem"), std::nullopt);
  EXPECT_EQ(contents_of("/tmp"), std::nullopt);
  EXPECT_EQ(contents_of("/no/such"), std::nullopt);
  EXPECT_EQ(contents_of("/dev/null"), "");
  EXPECT_FALSE(DataStream("/proc/self/mem"));
  EXPECT_THAT([] { (void)read_text_file("/proc/self/mem"); },
              ThrowsMessage<std::runtime_error>("/proc/self/mem: cannot be read"));
}

}  // namespace

}  // namespace vbar::files
