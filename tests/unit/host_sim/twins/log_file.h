#pragma once
// A log file that goes away with the test.

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::twins::test {

class LogFile : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(testing::TempDir()) /
            ("vbar_log_" + std::to_string(::getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".lcmlog");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  [[nodiscard]] std::string content() const {
    std::ifstream stream(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  std::filesystem::path file_;
};

template <class Message>
Packet packet_of(const Message& message, fsw::GpsTime time, std::uint8_t spacecraft, std::uint16_t sequence_count) {
  fsw::packets::PacketHeader header;
  header.time = time;
  header.spacecraft = spacecraft;
  header.sequence_count = sequence_count;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> buffer{};
  const auto size = fsw::packets::encode(header, message, buffer);
  EXPECT_TRUE(size.ok());
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size.value())};
}

}  // namespace vbar::twins::test
