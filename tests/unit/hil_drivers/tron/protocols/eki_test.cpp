// The client of Ethernet KRL against a server that answers in awkward pieces.

#include "hil_drivers/tron/protocols/eki.h"

#include <set>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/protocols/kuka_xml.h"
#include "hil_drivers/tron/robot/robot_files.h"

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

// Documents of Ethernet KRL: the schema of TRON.md, section 7.

namespace {

const State kState{3, 1200, true, false, true, false, "KSS29000 <A1> & \"more\""};
const std::string kStateText =
    "<State Seq=\"3\" T=\"1200\" DrivesPowered=\"1\" EmergencyStop=\"0\" RsiOn=\"1\" Stopped=\"0\" "
    "Message=\"KSS29000 &lt;A1&gt; &amp; &quot;more&quot;\"/>";
const RobotState kPose{4, 1204, {1.0, -2.0, 3.5, 90.0, 0.0, -180.0}, {1.0, -90.0, 90.0, 0.0, 45.0, -349.5}, 12.5};
const std::string kPoseText =
    "<RobotState Seq=\"4\" T=\"1204\"><Pos X=\"1.0000\" Y=\"-2.0000\" Z=\"3.5000\" A=\"90.0000\" B=\"0.0000\" "
    "C=\"-180.0000\"/><Axis A1=\"1.0000\" A2=\"-90.0000\" A3=\"90.0000\" A4=\"0.0000\" A5=\"45.0000\" "
    "A6=\"-349.5000\" E1=\"12.5000\"/></RobotState>";

TEST(EkiDocuments, AreWrittenAndRead) {
  EXPECT_EQ("<Command Seq=\"7\" Do=\"start\"/>", encode(Command{7, Action::kStart}));
  EXPECT_EQ(kStateText, encode(kState));
  EXPECT_EQ(kPoseText, encode(kPose));
  for (const Action action : {Action::kStatus, Action::kStart, Action::kStop, Action::kReset, Action::kPose})
    EXPECT_EQ((Command{1, action}), decode_command(encode(Command{1, action})));
  EXPECT_EQ(Reply(kState), decode_reply(kStateText));
  EXPECT_EQ(Reply(kPose), decode_reply(kPoseText));
  EXPECT_EQ((Command{2, Action::kPose}), decode_command("<Command Do='pose' Seq='2' More=\"1\" ></Command>"));
}

TEST(EkiDocuments, HostileOnesAreRefusedWithOneSentence) {
  for (const std::string text :
       {"", "<Command/>", "<Command Seq=\"1\"/>", "<Command Seq=\"1\" Do=\"jump\"/>",
        "<Command Seq=\"-1\" Do=\"pose\"/>", "<Command Seq=\"4294967296\" Do=\"pose\"/>",
        "<Command Seq=\"1\" Seq=\"2\" Do=\"pose\"/>", "<!DOCTYPE a><Command Seq=\"1\" Do=\"pose\"/>",
        "<Command Seq=\"1\" Do=\"&x;\"/>", "<State/>", "<Command Seq=\"1\" Do=\"pose\"><a><b/></a></Command>"})
    EXPECT_THROW((void)decode_command(text), WireError) << text;
  for (const std::string from : {"T=\"1204\"", "X=\"1.0000\"", "E1=\"12.5000\"", "Seq=\"4\""}) {
    std::string text = kPoseText;
    text.erase(text.find(from), from.size());
    EXPECT_THROW((void)decode_reply(text), WireError) << text;
  }
  for (const std::string value : {"nan", "inf", "1e999", ""}) {
    std::string text = kPoseText;
    text.replace(text.find("12.5000"), 7, value);
    EXPECT_THROW((void)decode_reply(text), WireError) << text;
  }
  for (const auto& [from, to] : {std::pair{"RsiOn=\"1\"", "RsiOn=\"2\""}, {"RsiOn=\"1\"", ""}, {"1200", "12 00"}}) {
    std::string text = kStateText;
    text.replace(text.find(from), std::string_view(from).size(), to);
    EXPECT_THROW((void)decode_reply(text), WireError) << text;
  }
  try {
    (void)decode_command("<Command Seq=\"1\" Do=\"jump\"/>");
    FAIL();
  } catch (const WireError& error) {
    EXPECT_STREQ("document \"<Command Seq=\"1\" Do=\"jump\"/>\": Do is not status, start, stop, reset or pose",
                 error.what());
  }
}

TEST(EkiDocuments, ArriveInPiecesAndTwoAtATime) {
  const std::string stream = kStateText + kPoseText + "\r\n<Command Seq=\"1\" Do=\"pose\"></Command>";
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    DocumentBuffer buffer;
    std::vector<std::string> documents;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      buffer.append(stream.substr(at, piece));
      while (const auto document = buffer.next()) documents.push_back(*document);
    }
    ASSERT_THAT(documents, testing::ElementsAre(kStateText, kPoseText, "<Command Seq=\"1\" Do=\"pose\"></Command>"))
        << piece;
  }
}

TEST(EkiDocuments, BlocksPaddedWithZerosAreAccepted) {
  DocumentBuffer buffer;
  buffer.append(std::string(500, '\0') + kStateText + std::string(500, '\0'));
  EXPECT_EQ(kStateText, buffer.next());
  EXPECT_EQ(std::nullopt, buffer.next());
}

TEST(EkiDocuments, AStreamThatIsNoXmlOrNeverEndsIsRefused) {
  DocumentBuffer buffer;
  buffer.append("hello");
  EXPECT_THROW((void)buffer.next(), WireError);
  EXPECT_EQ(std::nullopt, buffer.next());  // discarded
  buffer.append("<State Message=\"" + std::string(kMaxDocumentBytes, 'x'));
  EXPECT_THROW((void)buffer.next(), WireError);
}

}  // namespace

// The controller's configuration of Ethernet KRL has the elements of the documents, and no others.

namespace {

using Paths = std::set<std::string>;

/// "State/@Seq" of every attribute in the document.
void add_paths(const pugi::xml_node& element, const std::string& prefix, Paths& paths) {
  const std::string path = prefix + element.name() + "/";
  for (const pugi::xml_attribute attribute : element.attributes()) paths.insert(path + "@" + attribute.name());
  for (const pugi::xml_node child : element.children()) add_paths(child, path, paths);
}

Paths paths_of(const std::vector<std::string>& documents) {
  Paths paths;
  for (const std::string& text : documents) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(text.c_str()));
    add_paths(document.document_element(), "", paths);
  }
  return paths;
}

Paths configured(const char* direction) {
  const xml::File file(robot_directory() / "vbar_tron_eki.xml", "ETHERNETKRL");
  Paths paths;
  for (const pugi::xml_node element : file.child(file.child(file.root(), direction), "XML").children("ELEMENT")) {
    const std::string tag = file.attribute(element, "Tag");
    if (tag.find('@') != std::string::npos) paths.insert(tag);
  }
  return paths;
}

TEST(EkiXml, HasTheElementsOfTheDocuments) {
  EXPECT_EQ(paths_of({encode(State{}), encode(RobotState{})}), configured("SEND"));
  EXPECT_EQ(paths_of({encode(Command{})}), configured("RECEIVE"));
}

}  // namespace

}  // namespace vbar::tron::eki
