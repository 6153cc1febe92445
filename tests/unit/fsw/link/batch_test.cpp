// Go-back-N: what the two ends of a batch take, acknowledge and send again (frame.h).

#include "fsw/link/batch.h"

#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::link {
namespace {

using Verdict = BatchReceiver::Verdict;

FrameHeader data(std::uint16_t index, bool last = false, std::uint32_t step = 7, std::uint32_t session = 1) {
  FrameHeader header;
  header.type = FrameType::kData;
  header.session = session;
  header.step = step;
  header.index = index;
  header.last = last;
  return header;
}

BatchReceiver receiver_of_step_7() {
  BatchReceiver receiver;
  receiver.open(1, 7);
  return receiver;
}

BatchSender sender_of(std::uint16_t count) {
  BatchSender sender;
  sender.open(1, 7, count);
  return sender;
}

/// Sends what the window allows; the indices sent.
std::vector<int> send_all(BatchSender& sender) {
  std::vector<int> indices;
  while (sender.can_send()) {
    indices.push_back(sender.next_header().index);
    sender.sent();
  }
  return indices;
}

std::vector<int> range(int begin, int end) {
  std::vector<int> values;
  for (int i = begin; i < end; ++i) values.push_back(i);
  return values;
}

TEST(BatchReceiver, TakesInOrderOnly) {
  BatchReceiver receiver = receiver_of_step_7();
  EXPECT_EQ(receiver.offer(data(1)).verdict, Verdict::kOutOfOrder);
  EXPECT_EQ(receiver.offer(data(0)).verdict, Verdict::kTaken);
  EXPECT_EQ(receiver.offer(data(0)).verdict, Verdict::kDuplicate);
  EXPECT_EQ(receiver.offer(data(2, true)).verdict, Verdict::kOutOfOrder);
  EXPECT_FALSE(receiver.complete());
  EXPECT_EQ(receiver.offer(data(1)).verdict, Verdict::kTaken);
  EXPECT_EQ(receiver.offer(data(2, true)).verdict, Verdict::kTaken);
  EXPECT_TRUE(receiver.complete());
  EXPECT_EQ(receiver.held(), 3);
}

TEST(BatchReceiver, AnotherSessionOrStepIsForeign) {
  BatchReceiver closed;
  EXPECT_EQ(closed.offer(data(0)).verdict, Verdict::kForeign);
  BatchReceiver receiver = receiver_of_step_7();
  EXPECT_EQ(receiver.offer(data(0, false, 8)).verdict, Verdict::kForeign);
  EXPECT_EQ(receiver.offer(data(0, false, 7, 2)).verdict, Verdict::kForeign);
  EXPECT_EQ(receiver.held(), 0);
  receiver.close();
  EXPECT_EQ(receiver.offer(data(0)).verdict, Verdict::kForeign);
}

TEST(BatchReceiver, NothingIsTakenAfterTheLastPacket) {
  BatchReceiver receiver = receiver_of_step_7();
  EXPECT_EQ(receiver.offer(data(0, true)).verdict, Verdict::kTaken);
  EXPECT_EQ(receiver.offer(data(1)).verdict, Verdict::kDuplicate);
  EXPECT_EQ(receiver.held(), 1);
}

TEST(BatchReceiver, AcknowledgesEveryHalfWindowAndOnDemand) {
  BatchReceiver receiver = receiver_of_step_7();
  for (int i = 0; i < 3 * kWindow; ++i) {
    const bool due = (i + 1) % (kWindow / 2) == 0;
    EXPECT_EQ(receiver.offer(data(static_cast<std::uint16_t>(i))).acknowledge, due) << i;
  }
  FrameHeader demanding = data(5);  // long held
  demanding.acknowledge_now = true;
  EXPECT_TRUE(receiver.offer(demanding).acknowledge);
  demanding.index = 1000;  // far ahead
  EXPECT_TRUE(receiver.offer(demanding).acknowledge);
  const FrameHeader acknowledgement = receiver.acknowledgement();
  EXPECT_EQ(acknowledgement.type, FrameType::kAck);
  EXPECT_EQ(acknowledgement.session, 1U);
  EXPECT_EQ(acknowledgement.step, 7U);
  EXPECT_EQ(acknowledgement.index, 3 * kWindow);
}

TEST(BatchReceiver, CountsNeverWrap) {
  BatchReceiver receiver = receiver_of_step_7();
  for (int i = 0; i < 65535; ++i)
    ASSERT_EQ(receiver.offer(data(static_cast<std::uint16_t>(i))).verdict, Verdict::kTaken);
  EXPECT_EQ(receiver.offer(data(65535)).verdict, Verdict::kOutOfOrder);
  EXPECT_EQ(receiver.held(), 65535);
}

TEST(BatchSender, FlagsTheLastPacketOnly) {
  BatchSender sender = sender_of(3);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(sender.can_send());
    const FrameHeader header = sender.next_header();
    EXPECT_EQ(header.type, FrameType::kData);
    EXPECT_EQ(header.session, 1U);
    EXPECT_EQ(header.step, 7U);
    EXPECT_EQ(header.index, i);
    EXPECT_EQ(header.last, i == 2);
    sender.sent();
  }
  EXPECT_FALSE(sender.can_send());
  EXPECT_FALSE(sender.all_acknowledged());
  sender.acknowledge(3);
  EXPECT_TRUE(sender.all_acknowledged());
}

TEST(BatchSender, KeepsAtMostAWindowOut) {
  BatchSender sender = sender_of(100);
  EXPECT_EQ(send_all(sender), range(0, kWindow));
  sender.acknowledge(10);
  EXPECT_EQ(send_all(sender), range(kWindow, kWindow + 10));
  EXPECT_EQ(sender.resent(), 0U);
}

TEST(BatchSender, OldAndImpossibleAcknowledgementsChangeNothing) {
  BatchSender sender = sender_of(100);
  send_all(sender);
  sender.acknowledge(20);
  send_all(sender);
  for (const std::uint16_t held : {std::uint16_t{19}, std::uint16_t{0}, std::uint16_t{53}, std::uint16_t{65535}}) {
    sender.acknowledge(held);
    EXPECT_FALSE(sender.can_send()) << held;
    if (held != 19 && held != 0) sender.rewind(held);
    EXPECT_FALSE(sender.can_send()) << held;
  }
  sender.rewind(5);  // those were acknowledged: a delayed frame
  EXPECT_FALSE(sender.can_send());
}

TEST(BatchSender, SendsAgainFromWhereTheOtherSideStands) {
  BatchSender sender = sender_of(40);
  send_all(sender);
  sender.rewind(8);
  EXPECT_EQ(send_all(sender), range(8, 40));
  EXPECT_EQ(sender.resent(), static_cast<std::uint32_t>(kWindow - 8));  // the rest went out for the first time
  sender.rewind(40);
  EXPECT_TRUE(sender.all_acknowledged());
  EXPECT_FALSE(sender.can_send());
}

TEST(BatchSender, AnAcknowledgementOvertakesAResend) {
  BatchSender sender = sender_of(20);
  send_all(sender);
  sender.rewind(0);
  sender.sent();
  sender.acknowledge(15);  // the first sending had arrived after all
  EXPECT_EQ(send_all(sender), range(15, 20));
}

TEST(BatchSender, CountsResentPacketsOverAllBatches) {
  BatchSender sender = sender_of(2);
  send_all(sender);
  sender.rewind(0);
  send_all(sender);
  EXPECT_EQ(sender.resent(), 2U);
  sender.open(1, 8, 2);
  send_all(sender);
  EXPECT_EQ(sender.resent(), 2U);
  sender.rewind(1);
  send_all(sender);
  EXPECT_EQ(sender.resent(), 3U);
}

}  // namespace
}  // namespace vbar::fsw::link
