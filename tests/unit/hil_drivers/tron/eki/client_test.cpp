// The client of Ethernet KRL against a server that answers in awkward pieces.

#include "hil_drivers/tron/eki/client/client.h"

#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::tron::eki {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;

/// Answers each command by the next of a list of texts, one byte a packet; closes the connection after the last.
class Server {
 public:
  explicit Server(std::vector<std::string> answers)
      : acceptor_(context_, {boost::asio::ip::address_v4::loopback(), 0}), answers_(std::move(answers)) {
    port_ = acceptor_.local_endpoint().port();
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() { thread_.join(); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] ClientSettings settings(std::chrono::milliseconds answer_limit = 60s) const {
    return {"camera robot", "127.0.0.1", port_, 60s, answer_limit};
  }
  [[nodiscard]] std::string name() const { return "camera robot at EKI 127.0.0.1:" + std::to_string(port_) + ": "; }

 private:
  void serve() {
    tcp::socket socket = acceptor_.accept();
    socket.set_option(tcp::no_delay(true));
    boost::system::error_code error;
    DocumentBuffer documents;
    for (const std::string& answer : answers_) {
      while (!documents.next() && !error) {
        std::string bytes(256, '\0');
        bytes.resize(socket.read_some(boost::asio::buffer(bytes), error));
        documents.append(bytes);
      }
      for (const char& c : answer) boost::asio::write(socket, boost::asio::buffer(&c, 1), error);
    }
    if (answers_.back().empty()) {  // the client gives up first
      char c = 0;
      (void)socket.read_some(boost::asio::buffer(&c, 1), error);
    }
  }

  boost::asio::io_context context_;
  tcp::acceptor acceptor_;
  std::vector<std::string> answers_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

std::string state(std::uint32_t seq, bool rsi_on, const std::string& message = "") {
  return encode(State{seq, 100, true, false, rsi_on, false, message});
}

TEST(EkiClient, AsksAndKeepsUnsolicitedStates) {
  const RobotState pose{3, 1204, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {1.0, -90.0, 90.0, 0.0, 45.0, -349.5}, 12.5};
  Server server(
      {state(1, false), state(0, true, "on") + state(2, true), state(1, true) + encode(pose) + state(0, false)});
  Client client(server.settings());
  EXPECT_FALSE(client.last_state().rsi_on);
  EXPECT_TRUE(client.start().rsi_on);
  EXPECT_EQ(1U, client.unsolicited());
  EXPECT_EQ(pose, client.pose());
  EXPECT_TRUE(client.last_state().rsi_on);
  while (client.unsolicited() < 2) client.poll();
  EXPECT_FALSE(client.last_state().rsi_on);
  // The server has closed.
  try {
    (void)client.status();
    FAIL();
  } catch (const EkiError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(server.name()));
  }
}

TEST(EkiClient, NamesWhatDoesNotAnswer) {
  Server server({state(1, false), ""});
  Client client(server.settings(50ms));
  try {
    (void)client.pose();
    FAIL();
  } catch (const EkiError& error) {
    EXPECT_EQ(server.name() + "no answer to \"pose\" within 50 ms", error.what());
  }
}

TEST(EkiClient, ADocumentThatCannotBeReadIsAnError) {
  Server server({state(1, false), "<State Seq=\"2\"/>"});
  Client client(server.settings());
  try {
    (void)client.status();
    FAIL();
  } catch (const EkiError& error) {
    EXPECT_EQ(server.name() + "document \"<State Seq=\"2\"/>\": T is missing", error.what());
  }
}

TEST(EkiClient, NamesAControllerThatIsNotThere) {
  ClientSettings settings{"target robot", "127.0.0.1", 1, 50ms, 50ms};
  try {
    Client client(settings);
    FAIL();
  } catch (const EkiError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("target robot at EKI 127.0.0.1:1: "));
  }
}

}  // namespace
}  // namespace vbar::tron::eki
