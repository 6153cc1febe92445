// The worked examples of docs/wire_formats.md are what the code says and reads, and its table of APIDs has them all.

#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/link/frame.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/security_trailer.h"
#include "fsw/vision/imaging/image_assembly.h"
#include "tests/support/paths.h"

namespace vbar::fsw {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The bytes of the block "```hex <name>": on each line the pairs of hex digits up to the comment.
Bytes block(const std::string& name) {
  std::ifstream file(vbar::tests::source_path("docs/wire_formats.md"));
  EXPECT_TRUE(file);
  Bytes bytes;
  std::string line;
  while (std::getline(file, line) && line != "```hex " + name) {
  }
  while (std::getline(file, line) && line != "```") {
    std::istringstream words(line.substr(0, line.find("  ")));
    std::string word;
    while (words >> word) bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  return bytes;
}

Bytes example_packet() {
  vbar::tick tick{};
  tick.step = 42;
  tick.period_ns = 10 * kNanosecondsPerSecond;
  packets::PacketHeader header;
  header.time.ns = 1'400'000'000'123'456'789;
  header.spacecraft = 1;
  Bytes packet(packets::kMaxPacketBytes);
  packet.resize(packets::encode(header, tick, packet).value());
  return packet;
}

Bytes example_frame() {
  link::FrameHeader header;
  header.type = link::FrameType::kData;
  header.session = 0xC0FFEE01;
  header.step = 42;
  header.last = true;
  Bytes frame(link::kMaxFrameBytes);
  frame.resize(link::write_frame(header, example_packet(), frame).value());
  return frame;
}

TEST(WireFormatsDocument, PacketIsRight) {
  EXPECT_EQ(block("packet"), example_packet());
}

TEST(WireFormatsDocument, FrameIsRight) {
  EXPECT_EQ(block("frame"), example_frame());
}

TEST(WireFormatsDocument, StreamIsRight) {
  Bytes stream(link::kMaxCobsFrameBytes);
  stream.resize(link::cobs_encode(example_frame(), stream).value());
  EXPECT_EQ(block("stream"), stream);
}

// The code of the example is that of Python's hmac.
TEST(WireFormatsDocument, AuthenticatedTelecommandIsRight) {
  vbar::fault_command command{};
  command.clear = 4;
  packets::PacketHeader header;
  header.time.ns = 1'400'000'000'123'456'789;
  header.spacecraft = 1;
  Bytes plain(packets::kMaxPacketBytes), secured(packets::kMaxPacketBytes);
  plain.resize(packets::encode(header, command, plain).value());
  packets::TelecommandKey key{};
  for (std::size_t k = 0; k < key.size(); ++k) key[k] = static_cast<std::uint8_t>(k);
  const packets::HmacSha256 hmac(key);
  secured.resize(packets::write_secured(plain, hmac, 1, packets::sequence_at(1'767'225'600, 5), secured).value());
  EXPECT_EQ(block("secured"), secured);
}

TEST(WireFormatsDocument, PixelsAreRight) {
  const std::array<std::uint16_t, 2> pixels{0xabc, 0x123};
  Bytes packed(3);
  ASSERT_EQ(imaging::pack_pixels(pixels, 12, packed), packed.size());
  EXPECT_EQ(block("pixels"), packed);
}

/// By APID, the messages of the table's rows: "| 0x001 | `tick` |", two to a line.
std::map<int, std::string> table_of_apids() {
  std::ifstream file(vbar::tests::source_path("docs/wire_formats.md"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex row(R"(\| 0x([0-9a-f]{3}) \| `(\w+)` )");
  std::map<int, std::string> table;
  for (std::sregex_iterator hit(text.begin(), text.end(), row), end; hit != end; ++hit) {
    table[std::stoi((*hit)[1], nullptr, 16)] = (*hit)[2];
  }
  return table;
}

TEST(WireFormatsDocument, TableHasEveryMessageUnderItsApid) {
  std::map<int, std::string> expected;
#define VBAR_EXPECT_MESSAGE(type, apid, number, route) \
  expected[static_cast<int>(packets::Apid::apid)] = std::string(#type).substr(std::string("::vbar::").size());
  VBAR_FOR_EACH_MESSAGE(VBAR_EXPECT_MESSAGE)
#undef VBAR_EXPECT_MESSAGE
  EXPECT_EQ(table_of_apids(), expected);
}

}  // namespace
}  // namespace vbar::fsw
