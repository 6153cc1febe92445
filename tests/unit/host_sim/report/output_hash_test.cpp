#include "host_sim/report/output_hash.h"

#include "tests/unit/host_sim/report/packets.h"
#include "tests/unit/host_sim/report/program_output.h"
#include "tests/unit/host_sim/report/scratch_folder.h"

namespace vbar::report::test {
namespace {

using fsw::packets::Apid;

class OutputHashTest : public ScratchFolder {
 protected:
  [[nodiscard]] std::string sha256sum(const Bytes& bytes) const {
    const auto file = scratch_ / "bytes";
    write(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return output_of("sha256sum " + file.string()).text.substr(0, 64);
  }
};

void append(Bytes& all, const Bytes& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// FIPS 180-4: SHA-256 of no bytes at all.
TEST_F(OutputHashTest, OfNothing) {
  const OutputHash hash;
  EXPECT_EQ(hash.commands_sha256(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash.telemetry_sha256(), hash.commands_sha256());
}

TEST_F(OutputHashTest, IsThatOfTheBytesInOrder) {
  OutputHash hash;
  Bytes commands, telemetry;
  std::size_t step_reports = 0;
  for (const Bytes& packet : some_packets()) {
    hash.add(packet);
    const int apid = (packet[0] & 0x07) << 8 | packet[1];
    if (apid == 0x401) append(commands, packet);
    if (apid >= 0x500 && apid < 0x600) append(telemetry, packet);
    if (apid == 0x601) ++step_reports;
  }
  ASSERT_EQ(step_reports, 5U) << "they count nowhere, so there must be some";
  EXPECT_EQ(hash.commands_sha256(), sha256sum(commands));
  EXPECT_EQ(hash.telemetry_sha256(), sha256sum(telemetry));
}

TEST_F(OutputHashTest, CanBeAskedInBetween) {
  OutputHash asked, quiet;
  for (const Bytes& packet : some_packets()) {
    asked.add(packet);
    quiet.add(packet);
    static_cast<void>(asked.telemetry_sha256());
  }
  EXPECT_EQ(asked.telemetry_sha256(), quiet.telemetry_sha256());
}

TEST_F(OutputHashTest, OrderAndDamageMatter) {
  const Bytes first = packet_of(Apid::kManeuverCommand, 0);
  const Bytes second = packet_of(Apid::kManeuverCommand, 1);
  OutputHash forwards, backwards, damaged;
  forwards.add(first);
  forwards.add(second);
  backwards.add(second);
  backwards.add(first);
  EXPECT_NE(forwards.commands_sha256(), backwards.commands_sha256());
  Bytes flipped = second;
  flipped.back() ^= 1U;  // the CRC is wrong now: no receiver takes it, but it was sent
  damaged.add(first);
  damaged.add(flipped);
  EXPECT_NE(forwards.commands_sha256(), damaged.commands_sha256());
  EXPECT_EQ(forwards.telemetry_sha256(), OutputHash().telemetry_sha256());
}

TEST_F(OutputHashTest, ScrapsThatHoldNoApidChangeNothing) {
  OutputHash hash;
  hash.add({});
  hash.add(Bytes{0x04});
  EXPECT_EQ(hash.commands_sha256(), OutputHash().commands_sha256());
}

}  // namespace
}  // namespace vbar::report::test
