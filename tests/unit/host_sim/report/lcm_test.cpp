#include <cstdlib>
#include <memory>
#include <stdexcept>

#include <gmock/gmock.h>
#include <lcm/eventlog.h>
#include <lcm/lcm.h>

#include "host_sim/report/lcm_mirror.h"
#include "host_sim/report/provenance.h"
#include "host_sim/twins/packet_log.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {

namespace {

using testing::HasSubstr;

class LcmMirrorTest : public ScratchFolder {};

std::vector<twins::PacketRecord> some_records() {
  std::vector<twins::PacketRecord> records;
  std::uint32_t step = 0;
  for (const Bytes& packet : some_packets()) {
    const auto view = fsw::packets::parse_packet(packet);
    EXPECT_TRUE(view.ok());
    records.push_back({step++, view.value().header.time, fsw::packets::is_to_flight(view.value().header.apid), packet});
  }
  return records;
}

// LCM's own file:// provider writes what is published as lcm-logger would, and anyone can read it back.
TEST_F(LcmMirrorTest, WhatIsLoggedFromTheBusIsEveryPacket) {
  const auto file = scratch_ / "bus.lcmlog";
  const std::vector<twins::PacketRecord> records = some_records();
  OutputHash hash;
  {
    LcmMirror mirror("file://" + file.string() + "?mode=w");
    for (const twins::PacketRecord& record : records) {
      mirror.publish(record);
      hash.add(record.packet);
    }
    EXPECT_EQ(mirror.events_not_sent(), 0U);
  }
  const twins::PacketLog log = twins::read_packet_log(file);
  EXPECT_FALSE(log.cut_short);
  ASSERT_EQ(log.records.size(), records.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    EXPECT_EQ(log.records[k].step, records[k].step);
    EXPECT_EQ(log.records[k].time, records[k].time);
    EXPECT_EQ(log.records[k].to_flight, records[k].to_flight);
    EXPECT_EQ(log.records[k].packet, records[k].packet);
  }
  const ProgramOutput independent =
      output_of("python3 " + vbar::tests::source_path("tests/unit/host_sim/report/hash_lcm_log.py ") + file.string());
  EXPECT_EQ(independent.text, hash.commands_sha256() + "\n" + hash.telemetry_sha256() + "\n");
}

struct Listener {
  std::vector<Bytes> received;
  static void take(const lcm_recv_buf_t* buffer, const char*, void* listener) {
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    static_cast<Listener*>(listener)->received.emplace_back(data, data + buffer->data_size);
  }
};

// Over real datagrams that do not leave this computer (time to live 0), on a port that no LCM program has by default.
TEST_F(LcmMirrorTest, ReachesAListenerOnThisComputer) {
  const std::string url = "udpm://239.255.76.67:" + std::to_string(20000 + ::getpid() % 20000) + "?ttl=0";
  lcm_t* bus = lcm_create(url.c_str());
  if (bus == nullptr) GTEST_SKIP() << "this computer has no multicast";
  Listener listener;
  lcm_subscribe(bus, twins::kPacketChannel, &Listener::take, &listener);
  const twins::PacketRecord record = some_records().front();
  LcmMirror mirror(url);
  mirror.publish(record);
  constexpr int kPatience_ms = 2000;  // a datagram to oneself takes far less than a millisecond
  EXPECT_GT(lcm_handle_timeout(bus, kPatience_ms), 0);
  lcm_destroy(bus);
  ASSERT_EQ(listener.received.size(), 1U);
  EXPECT_EQ(listener.received.front(), twins::lcm_events_of(record).front().data);
}

TEST_F(LcmMirrorTest, ABusThatCannotBeOpenedIsNamed) {
  for (const std::string url : {"nonsense://x", "udpm://not-an-address:1"}) {
    try {
      const LcmMirror mirror(url);
      ADD_FAILURE() << url;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(url));
    }
  }
}

// Without a URL, LCM would take that of the environment, which may point off this computer.
TEST_F(LcmMirrorTest, TheEnvironmentDoesNotChooseTheBus) {
  ASSERT_EQ(::setenv("LCM_DEFAULT_URL", "memq://", 1), 0);
  EXPECT_THROW(LcmMirror(""), std::runtime_error);
  ::unsetenv("LCM_DEFAULT_URL");
}

}  // namespace

// The packet log of a run against LCM's own library: the same events give the same bytes, and LCM reads them back.

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
