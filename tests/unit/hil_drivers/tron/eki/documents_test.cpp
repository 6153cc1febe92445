// Documents of Ethernet KRL: the schema of TRON.md, section 7.

#include "hil_drivers/tron/eki/wire/documents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::tron::eki {
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
}  // namespace vbar::tron::eki
