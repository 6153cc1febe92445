// The packet log of a run against LCM's own library: the same events give the same bytes, and LCM reads them back.

#include <memory>

#include <lcm/eventlog.h>

#include "host_sim/twins/packet_log.h"
#include "tests/unit/host_sim/report/packets.h"
#include "tests/unit/host_sim/report/scratch_folder.h"

namespace vbar::report::test {
namespace {

class LogByLcmTest : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    std::uint32_t step = 0;
    for (const Bytes& packet : some_packets()) {
      const auto view = fsw::packets::parse_packet(packet);
      ASSERT_TRUE(view.ok());
      const auto& header = view.value().header;
      records_.push_back({step++, header.time, fsw::packets::is_to_flight(header.apid), packet});
    }
    twins::PacketLogWriter writer(own_ = scratch_ / "own.lcmlog");
    for (const twins::PacketRecord& record : records_) writer.write(record);
    writer.flush();
  }

  std::filesystem::path own_;
  std::vector<twins::PacketRecord> records_;
};

using Log = std::unique_ptr<lcm_eventlog_t, decltype(&lcm_eventlog_destroy)>;

TEST_F(LogByLcmTest, LcmWritesTheSameBytes) {
  const auto by_lcm = scratch_ / "lcm.lcmlog";
  {
    const Log log(lcm_eventlog_create(by_lcm.c_str(), "w"), lcm_eventlog_destroy);
    ASSERT_NE(log, nullptr);
    for (const twins::PacketRecord& record : records_)
      for (twins::LcmEvent& event : twins::lcm_events_of(record)) {
        lcm_eventlog_event_t raw{};
        raw.timestamp = twins::lcm_timestamp(record.time);
        raw.channellen = static_cast<std::int32_t>(event.channel.size());
        raw.channel = event.channel.data();
        raw.datalen = static_cast<std::int32_t>(event.data.size());
        raw.data = event.data.data();
        ASSERT_EQ(lcm_eventlog_write_event(log.get(), &raw), 0);
      }
  }
  EXPECT_GT(content(own_).size(), 1000U);
  EXPECT_EQ(content(own_), content(by_lcm));
}

TEST_F(LogByLcmTest, LcmReadsEveryEvent) {
  const Log log(lcm_eventlog_create(own_.c_str(), "r"), lcm_eventlog_destroy);
  ASSERT_NE(log, nullptr);
  std::int64_t number = 0;
  for (const twins::PacketRecord& record : records_)
    for (const twins::LcmEvent& event : twins::lcm_events_of(record)) {
      const std::unique_ptr<lcm_eventlog_event_t, decltype(&lcm_eventlog_free_event)> read(
          lcm_eventlog_read_next_event(log.get()), lcm_eventlog_free_event);
      ASSERT_NE(read, nullptr);
      EXPECT_EQ(read->eventnum, number++);
      EXPECT_EQ(read->timestamp, twins::lcm_timestamp(record.time));
      EXPECT_EQ(std::string(read->channel, static_cast<std::size_t>(read->channellen)), event.channel);
      const auto* const data = static_cast<const std::uint8_t*>(read->data);
      EXPECT_EQ(Bytes(data, data + read->datalen), event.data);
    }
  EXPECT_EQ(lcm_eventlog_read_next_event(log.get()), nullptr);
}

}  // namespace
}  // namespace vbar::report::test
