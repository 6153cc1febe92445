// Lines of the ASCII protocol. The replies and their checksums are published ones: the tests of Zaber's own libraries
// for Python and MATLAB, and the example of the C library's manual.

#include "hil_drivers/zaber/wire/messages.h"

#include <gtest/gtest.h>

namespace vbar::zaber {
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
