// The client against the emulated controller on both of its lines, and against lines that misbehave.

#include "hil_drivers/zaber/client.h"

#include <filesystem>
#include <future>
#include <optional>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "emulators/zaber/device.h"
#include "hil_drivers/zaber/messages.h"
#include "host_sim/io/byte_channel.h"

namespace vbar::zaber {

namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

DeviceSettings two_axes() {
  AxisSettings axis;
  axis.moves_at_once = true;
  return {1, {axis, axis}, 1};
}

class ClientTest : public ::testing::Test {
 protected:
  ClientTest() : directory(testing::TempDir() + "vbar_zaber_" + std::to_string(::getpid())) {
    std::filesystem::create_directories(directory);
    server.emplace(context, device, directory / "rails");
    thread = std::thread([this] { context.run(); });
  }
  ~ClientTest() override {
    context.stop();
    thread.join();
    server.reset();
    std::filesystem::remove_all(directory);
  }
  ClientSettings settings(bool by_tcp) const {
    ClientSettings s;
    s.line = by_tcp ? "127.0.0.1:" + std::to_string(server->tcp_port()) : (directory / "rails").string();
    s.answer_limit = std::chrono::seconds(20);  // a loaded machine
    return s;
  }
  /// On the thread of the device.
  template <class Action>
  void on_device(const Action& action) {
    std::promise<void> done;
    boost::asio::post(context, [&] {
      action();
      done.set_value();
    });
    done.get_future().wait();
  }

  std::filesystem::path directory;
  boost::asio::io_context context{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  Device device{two_axes(), [] { return 0.0; }};
  std::optional<DeviceServer> server;
  std::thread thread;
};

TEST_F(ClientTest, HomesAndMovesOverBothLines) {
  for (const bool by_tcp : {true, false}) {
    Client client(settings(by_tcp));
    client.home_if_needed(1);
    client.home_if_needed(2);
    client.move_to_um(1, 25000.0);
    client.move_to_um(2, 14300.0);
    EXPECT_NEAR(client.position_um(1), 25000.0, 0.03);  // half a microstep
    client.check_held_at_um(1, 25000.0);
    client.check_held_at_um(2, 14300.0);
    double carriage_um = 0.0;
    on_device([&] { carriage_um = device.axis(0).carriage_um(); });
    EXPECT_NEAR(carriage_um, 25000.0, 2.5);  // five sigma, and not the backlash of 3 um
    client.stop();
  }
}

TEST_F(ClientTest, AStalledAxisIsOneError) {
  Client client(settings(true));
  client.home_if_needed(1);
  on_device([&] { device.axis(0).block(); });
  EXPECT_THAT([&] { client.move_to_um(1, 1000.0); },
              ThrowsMessage<RailError>(HasSubstr("axis 1: stalled and stopped (FS)")));
}

TEST_F(ClientTest, AnAxisMovedByHandIsOneError) {
  Client client(settings(true));
  client.home_if_needed(2);
  client.move_to_um(2, 5000.0);
  on_device([&] { device.axis(1).displace(30.0); });
  EXPECT_THAT([&] { client.check_held_at_um(2, 5000.0); },
              ThrowsMessage<RailError>(HasSubstr("displaced when stationary (WM)")));
}

TEST_F(ClientTest, APlaceBeyondTheLimitsIsOneError) {
  Client client(settings(true));
  client.home_if_needed(1);
  EXPECT_THAT([&] { client.move_to_um(1, 200000.0); },
              ThrowsMessage<RailError>(HasSubstr("\"move abs 4198425\" was rejected: BADDATA")));
}

TEST(ZaberClient, AMissingLineIsOneError) {
  ClientSettings settings;
  settings.line = "/dev/does_not_exist";
  EXPECT_THAT([&] { const Client client(settings); }, ThrowsMessage<RailError>(HasSubstr("/dev/does_not_exist")));
}

TEST(ZaberClient, ALineThatDoesNotAnswerIsOneError) {
  const io::Pty silent = io::make_pty();
  ClientSettings settings;
  settings.line = silent.slave_path;
  settings.answer_limit = std::chrono::milliseconds(50);
  EXPECT_THAT([&] { const Client client(settings); }, ThrowsMessage<RailError>(HasSubstr("no answer")));
}

TEST(ZaberClient, ADamagedAnswerIsOneError) {
  const io::Pty pty = io::make_pty();
  ClientSettings settings;
  settings.line = pty.slave_path;
  settings.answer_limit = std::chrono::seconds(20);
  std::thread device([&] {
    char command[64];
    ASSERT_GT(::read(pty.master.get(), command, sizeof command), 0);
    const std::string reply = "@01 0 OK IDLE -- 0:00\r\n";
    ASSERT_EQ(::write(pty.master.get(), reply.data(), reply.size()), static_cast<ssize_t>(reply.size()));
  });
  EXPECT_THAT([&] { const Client client(settings); }, ThrowsMessage<RailError>(HasSubstr("another checksum than 8D")));
  device.join();
}

}  // namespace

// Lines of the ASCII protocol. The replies and their checksums are published ones: the tests of Zaber's own libraries
// for Python and MATLAB, and the example of the C library's manual.

namespace {

TEST(ZaberMessages, PublishedRepliesAreReadAndWrittenAsTheyStand) {
  for (const char* line : {"@01 0 OK IDLE WR 0", "@01 0 OK BUSY WR 0", "@01 0 12 OK IDLE -- 0", "@01 0 OK IDLE -- 0:8D",
                           "@01 0 OK IDLE -- 7z:0C", "@02 0 OK IDLE -- 10.1"}) {
    const Message message = decode_message(line);
    EXPECT_EQ(encode(message), line);
    EXPECT_EQ(message.kind, MessageKind::kReply);
  }
  const Message reply = decode_message("@1 3 9 OK IDLE -- 0:61");
  EXPECT_EQ(reply.device, 1);
  EXPECT_EQ(reply.axis, 3);
  EXPECT_EQ(reply.id, 9);
  EXPECT_EQ(reply.data, "0");
  EXPECT_TRUE(reply.has_checksum);
  EXPECT_TRUE(decode_message("@01 0 OK BUSY WR 0").is_busy);
  EXPECT_EQ(decode_message("@01 0 RJ IDLE -- BADDATA").data, "BADDATA");
  EXPECT_TRUE(decode_message("@01 0 RJ IDLE -- BADDATA").is_rejected);
}

TEST(ZaberMessages, AlertsAndInformationAreToldFromReplies) {
  const Message alert = decode_message("!01 1 IDLE --");
  EXPECT_EQ(alert.kind, MessageKind::kAlert);
  EXPECT_EQ(alert.axis, 1);
  EXPECT_EQ(encode(alert), "!01 1 IDLE --");
  const Message information = decode_message("#01 0 Visit www.zaber.com for instructions");
  EXPECT_EQ(information.kind, MessageKind::kInformation);
  EXPECT_EQ(information.data, "Visit www.zaber.com for instructions");
}

TEST(ZaberMessages, AnAnswerWithNothingToSayHas18Characters) {
  EXPECT_EQ(encode(Message{}).size(), 18U);
}

TEST(ZaberMessages, CommandsMayLeaveOutDeviceAndAxis) {
  EXPECT_EQ(decode_command("/home"), (Command{0, 0, std::nullopt, "home", false}));
  EXPECT_EQ(decode_command("/1 home"), (Command{1, 0, std::nullopt, "home", false}));
  EXPECT_EQ(decode_command("/1 2 move abs 1000"), (Command{1, 2, std::nullopt, "move abs 1000", false}));
  EXPECT_EQ(decode_command("/01 0 05 get  pos"), (Command{1, 0, 5, "get pos", false}));
  EXPECT_EQ(decode_command("/"), (Command{}));
  const Command command{1, 2, 7, "move rel -5", true};
  EXPECT_EQ(decode_command(encode(command)), command);
}

TEST(ZaberMessages, HostileLinesAreOneErrorWithTheLine) {
  for (const char* line :
       {"", "01 0 OK IDLE -- 0", "@", "@01", "@01 0", "@01 0 OK", "@01 0 OK IDLE", "@01 0 OK IDLE --",
        "@01 0 XX IDLE -- 0", "@01 0 OK SLEEP -- 0", "@01 0 OK IDLE --- 0", "@-1 0 OK IDLE -- 0",
        "@01 0 OK IDLE -- 0:8E", "@01 0 OK IDLE -- 0:GG", "@01 0 OK IDLE -- 0:8", "@100 0 OK IDLE -- 0",
        "@01 11 OK IDLE -- 0", "@01 0 OK IDLE -- \x01"})
    EXPECT_THROW((void)decode_message(line), WireError) << line;
  for (const char* line : {"", "home", "/100 home", "/1 10 home", "/1 1 100 home", "/1 1 home:00", "/1 ho\tme"})
    EXPECT_THROW((void)decode_command(line), WireError) << line;
  EXPECT_THROW((void)decode_command("/" + std::string(600, 'a')), WireError);
  EXPECT_THROW((void)encode(Command{1, 1, std::nullopt, "home\n/1 stop", false}), WireError);
}

}  // namespace

}  // namespace vbar::zaber
