// Answers to abbreviated ASCII commands (OEM6 Family Firmware Reference Manual, 1.4).

#include "hil_drivers/grand/receiver_port/command_answer.h"

#include <string_view>

#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

std::vector<std::uint8_t> bytes(std::string_view text) {
  return {text.begin(), text.end()};
}

TEST(CommandAnswer, IsFoundOnceComplete) {
  EXPECT_FALSE(find_answer(bytes("")).has_value());
  EXPECT_FALSE(find_answer(bytes("\r\n<O")).has_value());
  EXPECT_TRUE(find_answer(bytes("\r\n<OK"))->is_accepted);
  EXPECT_FALSE(find_answer(bytes("\r\n<ERROR:Invalid Mess")).has_value());
  const auto refusal = find_answer(bytes("\r\n<ERROR:Invalid Message ID\r\n[COM1]"));
  ASSERT_TRUE(refusal.has_value());
  EXPECT_FALSE(refusal->is_accepted);
  EXPECT_EQ(refusal->text, "<ERROR:Invalid Message ID");
}

TEST(CommandAnswer, IgnoresGarbageThatResemblesOne) {
  EXPECT_FALSE(find_answer(bytes("<<<<ERR<")).has_value());
  EXPECT_FALSE(find_answer(bytes(std::string("<ERROR:").append(300, 'x').append("\r\n"))).has_value());
  EXPECT_FALSE(find_answer(bytes("<ERROR:\x01\x02\r\n")).has_value());
  EXPECT_TRUE(find_answer(bytes("<ERROR:\x01\x02\r\n<OK"))->is_accepted);
}

TEST(CommandAnswer, PromptNamesThePort) {
  EXPECT_EQ(find_prompt(bytes("<OK\r\n[COM2]")), "COM2");
  EXPECT_EQ(find_prompt(bytes("[COM1][USB3]")), "USB3");
  EXPECT_FALSE(find_prompt(bytes("[COM")).has_value());
  EXPECT_FALSE(find_prompt(bytes("[12]")).has_value());
}

TEST(CommandAnswer, IsShownInPrintableForm) {
  EXPECT_EQ(printable(bytes("a\r\x80")), "a\\x0d\\x80");
  EXPECT_EQ(printable(bytes("abcdef"), 3), "abc...");
}

}  // namespace
}  // namespace vbar::grand
