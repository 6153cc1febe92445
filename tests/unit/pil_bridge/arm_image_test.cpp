// Headers by the ELF specification (System V ABI, 4th edition, figure 4-3): offsets 4 class, 5 data, 16 type, 18
// machine.

#include "pil_bridge/arm_image.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vbar::pil {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class ArmImage : public testing::Test {
 protected:
  ArmImage() : file_(testing::TempDir() + "vbar_image_" + std::to_string(::getpid())) {}
  ~ArmImage() override { std::filesystem::remove(file_); }

  [[nodiscard]] std::string fault_of(const std::string& content, bool is_for_linux = false) const {
    std::ofstream(file_, std::ios::binary) << content;
    return fault_of_arm_image(file_, is_for_linux);
  }
  static std::string header(char bits, char data, char type, char machine) {
    std::string text(
        "\x7f"
        "ELF",
        4);
    text.resize(52, '\0');
    text[4] = bits;
    text[5] = data;
    text[16] = type;
    text[18] = machine;
    return text;
  }

  std::string file_;
};

TEST_F(ArmImage, AnExecutableForArmIsAccepted) {
  EXPECT_THAT(fault_of(header(1, 1, 2, 40)), IsEmpty());
  EXPECT_THAT(fault_of(header(1, 1, 3, 40), true), IsEmpty());
}

TEST_F(ArmImage, AnythingElseIsNamed) {
  EXPECT_THAT(fault_of("a text"), HasSubstr("not an ELF image; accepted: an ELF executable for 32-bit ARM"));
  EXPECT_THAT(fault_of(""), HasSubstr("not an ELF image"));
  EXPECT_THAT(fault_of(header(1, 1, 2, 40).substr(0, 12)), HasSubstr("not an ELF image"));
  EXPECT_THAT(fault_of(header(1, 2, 2, 40)), HasSubstr("big-endian"));
  EXPECT_THAT(fault_of(header(2, 1, 3, 62)), HasSubstr("64 bits for the machine number 62"));
  EXPECT_THAT(fault_of(header(1, 1, 1, 40)), HasSubstr("type 1, which is not an executable"));
  EXPECT_THAT(fault_of(header(1, 1, 3, 40)), HasSubstr("not an executable")) << "bare metal relocates nothing";
  EXPECT_THAT(fault_of_arm_image("/bin/true", false), HasSubstr("found an ELF image")) << "of this computer";
  EXPECT_THAT(fault_of_arm_image("/nowhere", false), HasSubstr("not an ELF image"));
}

}  // namespace
}  // namespace vbar::pil
