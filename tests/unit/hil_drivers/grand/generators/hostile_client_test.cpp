// Hostile bytes on every port of the servers: counted, answered by an error where the protocol has one, and without
// effect on the conversation of another client.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/wire/skydel.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/io/udp_socket.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

namespace vbar::grand::test {
namespace {

using testing::HasSubstr;
using wire::Bytes;

std::unique_ptr<io::ByteChannel> connect(std::uint16_t port) {
  return io::connect_tcp("127.0.0.1", std::to_string(port), soon());
}

Bytes bytes_of_text(std::string_view text) {
  return {text.begin(), text.end()};
}

/// What the server sends until it closes the connection.
std::string all_of(io::ByteChannel& channel) {
  std::string text;
  try {
    for (const auto deadline = soon(); io::Clock::now() < deadline;) {
      const auto bytes = channel.read(deadline);
      text.append(bytes.begin(), bytes.end());
    }
    ADD_FAILURE() << "the connection stays open";
  } catch (const io::ChannelError&) {
  }
  return text;
}

std::string answer_to(io::ByteChannel& channel, std::string_view text) {
  channel.write(bytes_of_text(text), soon());
  const auto bytes = channel.read(soon());
  return {bytes.begin(), bytes.end()};
}

TEST(HostileClient, SkydelClosesAConnectionWithoutFrames) {
  Loopback loopback({});
  const Bytes frames[] = {
      {0x02, 0x00, 0x07, 0x00},                          // unknown kind
      {0x00, 0x00},                                      // no kind
      {0x05, 0x00, 0x00, '{', '"', 'a', 0x00},           // not JSON
      {0x04, 0x00, 0x00, '[', ']', 0x00},                // not an object
      {0x03, 0x00, 0x02, 0x31, 0x00},                    // version of two bytes
      {0x06, 0x00, 0x01, 0xff, 0xff, 0xff, 0x7f, 0x00},  // result longer than its frame
  };
  for (const Bytes& frame : frames) {
    const auto channel = connect(loopback.control_ports()[0]);
    channel->write(frame, soon());
    EXPECT_EQ(all_of(*channel), "");
  }
  EXPECT_EQ(loopback.statistics().malformed, std::size(frames));
}

TEST(HostileClient, SkydelAnswersACommandWithoutName) {
  Loopback loopback({});
  const auto channel = connect(loopback.control_ports()[0]);
  channel->write(wire::encode_command({{"CmdUuid", 5}}), soon());
  const auto bytes = channel->read(soon());
  EXPECT_THAT(std::string(bytes.begin(), bytes.end()), HasSubstr("CmdName is missing"));
  channel->write(wire::encode_command({{"CmdName", "GetHilPort"}}), soon());
  const auto second = channel->read(soon());
  EXPECT_THAT(std::string(second.begin(), second.end()), HasSubstr("field CmdUuid is missing"));
}

// JSON nested 20000 deep would exhaust a recursive reader's stack.
TEST(HostileClient, SkydelRefusesDeeplyNestedJson) {
  Loopback loopback({});
  const auto channel = connect(loopback.control_ports()[0]);
  std::string nested = R"({"CmdName":"New","CmdUuid":"1","a":)";
  nested += std::string(20000, '[') + std::string(20000, ']') + "}";
  Bytes frame = {static_cast<std::uint8_t>((nested.size() + 1) & 0xff),
                 static_cast<std::uint8_t>((nested.size() + 1) >> 8), 0};
  frame.insert(frame.end(), nested.begin(), nested.end());
  channel->write(frame, soon());
  EXPECT_EQ(all_of(*channel), "");
}

TEST(HostileClient, SkydelCountsMalformedAndUnexpectedDatagrams) {
  Loopback loopback({});
  io::UdpSocket socket("127.0.0.1", loopback.hil_ports()[0], 0, 512);
  TrajectorySample sample = sample_at(kTenth);
  Bytes good = wire::encode_sample(sample);
  Bytes with_nan = good;
  for (std::size_t k = 0; k < 8; ++k) with_nan[10 + k] = 0xff;
  socket.send(Bytes{});
  socket.send(Bytes{0x09});
  socket.send(Bytes(good.begin(), good.end() - 1));
  socket.send(with_nan);
  socket.send(good);  // before SetVehicleTrajectory
  for (int k = 0; k < 200 && loopback.statistics().samples_refused == 0; ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(loopback.statistics().malformed, 4U);
  EXPECT_EQ(loopback.statistics().samples_refused, 1U);
  loopback.in_server([](FakeEngine& engine, bench::ControlServers&) { EXPECT_TRUE(engine.samples[0].empty()); });
}

// Foreign clients on all ports do not disturb a run.
TEST(HostileClient, SkydelFliesOnBesideForeignClients) {
  Loopback loopback({});
  const auto generator = loopback.generator("skydel");
  prepare(*generator);
  generator->start();
  const auto foreign = connect(loopback.control_ports()[0]);
  foreign->write(bytes_of_text("GET / HTTP/1.0\r\n\r\n"), soon());
  for (int n = 1; n <= 5; ++n) {
    generator->send(0, sample_at(tenths(n)));
    EXPECT_EQ(generator->wait_for(0, tenths(n), soon()), tenths(n));
  }
}

TEST(HostileClient, SimgenAnswersEveryLineWithAnError) {
  Loopback loopback({.protocol = bench::ControlProtocol::kSimgen});
  const auto channel = connect(loopback.control_ports()[0]);
  EXPECT_THAT(answer_to(*channel, "DANCE\n"), HasSubstr("<error>the command DANCE is unknown"));
  EXPECT_THAT(answer_to(*channel, "AR\n"), HasSubstr("<error>there is no start time"));
  EXPECT_THAT(answer_to(*channel, "RU\n"), HasSubstr("<error>the scenario is not armed"));
  EXPECT_THAT(answer_to(*channel, "-,TIME\n"), HasSubstr("<error>"));
  EXPECT_THAT(answer_to(*channel, "START_TIME,32-FOO-2011 16:00:00,02:00:00\n"), HasSubstr("<error>SimGEN START_TIME"));
  EXPECT_THAT(answer_to(*channel, "0 00:00:00.000,MOT,v1_m1,1,2,3\n"), HasSubstr("<error>SimGEN MOT: 4 arguments"));
  EXPECT_THAT(answer_to(*channel, "START_TIME,19-JUL-2011 16:00:00,02:00:00\n"), HasSubstr("<status>2</status></msg>"));
  EXPECT_THAT(answer_to(*channel, "AR\n"), HasSubstr("vehicle 1 has no motion"));
  EXPECT_THAT(answer_to(*channel, "*IDN?\n"), HasSubstr("Spirent"));
  channel->write(Bytes(20000, 'x'), soon());
  EXPECT_THAT(all_of(*channel), HasSubstr("a line of more than"));
}

TEST(HostileClient, APortThatIsTakenIsOneSentence) {
  Loopback loopback({});
  boost::asio::io_context context;
  FakeEngine engine(1);
  EXPECT_THAT(error_of([&] {
                static_cast<void>(
                    bench::make_control_servers(context, engine, {.control_ports = {loopback.control_ports()[0]}}));
              }),
              HasSubstr("TCP port " + std::to_string(loopback.control_ports()[0]) + " of 127.0.0.1 is not available"));
}

}  // namespace
}  // namespace vbar::grand::test
