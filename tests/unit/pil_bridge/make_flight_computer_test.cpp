#include "pil_bridge/make_flight_computer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::pil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(const FlightComputerOptions& options) {
  try {
    (void)make_flight_computer(options);
  } catch (const FlightComputerError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MakeFlightComputer, NamesGoBothWays) {
  for (const char* name : {"in_process", "host_process", "zynq_qemu", "zynq_linux_qemu", "board"}) {
    EXPECT_EQ(name_of(target_from_name(name)), name);
  }
  for (const char* name : {"serial", "pty", "udp"}) EXPECT_EQ(name_of(link_from_name(name)), name);
}

TEST(MakeFlightComputer, AnUnknownNameListsWhatIsAccepted) {
  try {
    (void)target_from_name("zynq");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "'zynq' is no flight_computer.target; accepted: in_process, host_process, zynq_qemu, zynq_linux_qemu, "
                 "board");
  }
  EXPECT_THROW((void)link_from_name("can"), std::invalid_argument);
}

TEST(MakeFlightComputer, InProcessNeedsAnArticle) {
  FlightComputerOptions options;
  EXPECT_THAT(error_of(options), HasSubstr("linked with no flight software"));
  options.article = linked_test_article();
  EXPECT_EQ(make_flight_computer(options)->description(), "in process: vbar link exerciser");
}

TEST(MakeFlightComputer, AMissingImageSaysWhatBuildsIt) {
  FlightComputerOptions options;
  options.image = "/nowhere/image.elf";
  options.target = Target::kZynqQemu;
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("'/nowhere/image.elf'"), HasSubstr("preset 'zynq'")));
  options.target = Target::kZynqLinuxQemu;
  EXPECT_THAT(error_of(options), HasSubstr("preset 'zynq-linux'"));
  options.target = Target::kHostProcess;
  EXPECT_THAT(error_of(options), HasSubstr("preset 'host'"));
}

TEST(MakeFlightComputer, AnIcountShiftThatDoesNotWorkIsRefused) {
  FlightComputerOptions options;
  options.target = Target::kZynqQemu;
  for (const int shift : {-1, 4, 9}) {
    options.icount_shift = shift;
    EXPECT_THAT(error_of(options), HasSubstr("accepted: 5 to 8")) << shift;
  }
}

TEST(MakeFlightComputer, AWiredReceiverNeedsALineOfItsOwn) {
  FlightComputerOptions options;
  options.article = linked_test_article();
  options.receiver = io::WiredReceiver{};
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("sensors.gnss.wired"), HasSubstr("set flight_computer.target to")));
  options.target = Target::kZynqQemu;
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("sensors.gnss.wired"), HasSubstr("set flight_computer.link to udp")));
  options.target = Target::kHostProcess;
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("sensors.gnss.wired"), HasSubstr("device")));
}

TEST(MakeFlightComputer, ABoardNeedsAnEndpointThatMakesSense) {
  FlightComputerOptions options;
  options.target = Target::kBoard;
  options.timing.boot_limit = std::chrono::milliseconds(20);
  EXPECT_THAT(error_of(options), HasSubstr("needs flight_computer.endpoint"));
  options.endpoint = "/nowhere/ttyUSB0";
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("board over serial"), HasSubstr("/nowhere/ttyUSB0")));
  options.endpoint = "unix:/nowhere/socket";
  EXPECT_THAT(error_of(options), HasSubstr("/nowhere/socket"));
  options.endpoint = "tcp:127.0.0.1";
  EXPECT_THAT(error_of(options), HasSubstr("lacks HOST:PORT"));
  options.link = LinkKind::kUdp;
  options.endpoint = "127.0.0.1:port";
  EXPECT_THAT(error_of(options), HasSubstr("'port' is not a port number"));
}

}  // namespace
}  // namespace vbar::pil
