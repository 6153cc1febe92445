// The worked example of docs/wire_formats.md is what the code says and reads.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/link/cobs.h"
#include "fsw/link/frame.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The bytes of the block "```hex <name>": on each line the pairs of hex digits up to the comment.
Bytes block(const std::string& name) {
  std::ifstream file(VBAR_SOURCE_DIR "/docs/wire_formats.md");
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

}  // namespace
}  // namespace vbar::fsw
