#include "pil_bridge/test_article.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "pil_bridge/make_flight_computer.h"
#include "tests/support/paths.h"
#include "tests/support/sanitizers.h"
#include "tests/support/step_packets.h"

namespace vbar::pil {

namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kMemory = std::uint64_t{64} << 20;
const std::string kLibraries = VBAR_TEST_LIBRARIES "/";

std::string error_of_loading(const std::string& path) {
  try {
    (void)load_test_article(path);
  } catch (const FlightComputerError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TestArticle, ASharedLibraryFliesLikeTheSameCodeLinkedIn) {
  const auto loaded = make_in_process(load_test_article(vbar::tests::build_path("libvbar_echo_article.so")), 1);
  const auto linked = make_in_process(linked_test_article(), 1);
  EXPECT_EQ(loaded->description(), "in process: vbar link exerciser");
  EXPECT_EQ(vbar::test::fly(*loaded, 50), vbar::test::fly(*linked, 50));
}

TEST(TestArticle, TwoOfThemDoNotShareAnything) {
  const auto article = linked_test_article();
  const auto one = make_in_process(article, 1);
  const auto other = make_in_process(article, 2);
  const auto of_one = vbar::test::fly(*one, 5);
  const auto of_other = vbar::test::fly(*other, 5);
  EXPECT_NE(of_one, of_other);  // the spacecraft number is part of what it echoes
  EXPECT_EQ(vbar::test::fly(*make_in_process(article, 1), 5), of_one);
}

TEST(TestArticle, ABatchWithoutATickStepsNothing) {
  const auto computer = make_in_process(linked_test_article(), 1);
  auto packets = vbar::test::step_packets(0, 3);
  packets.pop_back();
  EXPECT_TRUE(computer->step(0, packets).packets.empty());
}

TEST(TestArticle, LoadingSaysWhatIsWrong) {
  EXPECT_THAT(error_of_loading("/nowhere/gnc.so"), AllOf(HasSubstr("/nowhere/gnc.so"), HasSubstr("cannot be loaded")));
  EXPECT_THAT(error_of_loading(kLibraries + "libvbar_article_without_step.so"), HasSubstr("no function vbar_gnc_step"));
  EXPECT_THAT(error_of_loading(kLibraries + "libvbar_article_of_other_version.so"),
              HasSubstr("version 3 of the test-article interface, this program for 2"));
}

// Linked, and as a library in a child.
TEST(TestArticle, AFlightSoftwareThatDoesNotAuthenticateIsNotStartedWithAKey) {
  const std::string key = ::testing::TempDir() + "vbar-key-" + std::to_string(::getpid());
  std::ofstream(key) << std::string(64, '5') << '\n';
  std::filesystem::permissions(key, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  for (const std::string& library : {std::string(), vbar::tests::build_path("libvbar_echo_article.so")}) {
    FlightComputerOptions options;
    options.article = linked_test_article();
    options.library = library;
    options.telecommand_key_file = key;
    std::string error = "no error";
    try {
      (void)make_flight_computer(options);
    } catch (const FlightComputerError& thrown) {
      error = thrown.what();
    }
    EXPECT_THAT(error, AllOf(HasSubstr("vbar link exerciser"), HasSubstr("does not authenticate telecommands")));
    EXPECT_THAT(error, testing::Not(HasSubstr("5555")));
  }
  std::filesystem::remove(key);
}

// A library flies in a child process, with the same bits.
std::unique_ptr<FlightComputer> library_in_child(const std::string& library, std::uint8_t spacecraft,
                                                 std::chrono::milliseconds limit = std::chrono::milliseconds(500)) {
  FlightComputerOptions options;
  options.library = library;
  options.spacecraft = spacecraft;
  options.library_step_limit = limit;
  options.memory_bytes = kMemory;
  return make_flight_computer(options);
}

TEST(LibraryInChild, HasTheSameOutputsAsInProcess) {
  const std::string library = vbar::tests::build_path("libvbar_echo_article.so");
  const auto child = library_in_child(library, 1);
  EXPECT_EQ(child->description(), "in process: vbar link exerciser");
  EXPECT_EQ(vbar::test::fly(*child, 50), vbar::test::fly(*make_in_process(load_test_article(library), 1), 50));
  child->close();
}

TEST(LibraryInChild, LoadingSaysWhatIsWrong) {
  EXPECT_THAT([] { (void)library_in_child("/nowhere/gnc.so", 1); },
              testing::ThrowsMessage<FlightComputerError>(HasSubstr("cannot be loaded")));
}

TEST(LinkedArticle, WithoutANameIsRefused) {
  TestArticle nameless = *vbar::pil::linked_test_article();
  nameless.name = []() -> const char* { return nullptr; };
  EXPECT_THAT([&] { (void)make_in_process(std::make_shared<const TestArticle>(nameless), 1); },
              testing::ThrowsMessage<FlightComputerError>(HasSubstr("vbar_gnc_name returned a null pointer")));
}

// The numbers are those of article_with_faults.c.
TEST(LibraryInChild, AFaultIsOneSentenceAndTheProgramGoesOn) {
  const std::string library = kLibraries + "libvbar_article_with_faults.so";
  const auto flying = [&](std::uint8_t fault) {
    return [&library, fault] { (void)library_in_child(library, fault)->step(7, vbar::test::step_packets(7, 3)); };
  };
  using testing::ThrowsMessage;
  EXPECT_THAT(flying(1), ThrowsMessage<FlightComputerError>(HasSubstr("crashed at step 7: Segmentation fault")));
  EXPECT_THAT(flying(2), ThrowsMessage<FlightComputerError>(HasSubstr("did not return at step 7")));
  EXPECT_THAT(flying(3), ThrowsMessage<FlightComputerError>(HasSubstr("at step 7, with exit code 7")));
  EXPECT_THAT(flying(12), ThrowsMessage<FlightComputerError>(HasSubstr("not its own at step 7")));
  EXPECT_THAT(flying(4), ThrowsMessage<FlightComputerError>(HasSubstr("crashed while it was loaded")));
  EXPECT_THAT(flying(5), ThrowsMessage<FlightComputerError>(HasSubstr("did not return while it was loaded")));
}

TEST(LibraryInChild, ErrorsOfTheSoftwareAreCounted) {
  const auto child = library_in_child(kLibraries + "libvbar_article_with_faults.so", 6);
  const StepResult result = child->step(0, vbar::test::step_packets(0, 3));
  EXPECT_EQ(result.trouble.status, 12345);
  EXPECT_EQ(result.trouble.inputs_refused, vbar::test::step_packets(0, 3).size());
  EXPECT_EQ(result.trouble.packets_dropped, 1U);
  ASSERT_EQ(result.packets.size(), 1U);  // as it came: what it is worth is for the recorder to say
}

TEST(LibraryInChild, ItsMemoryIsLimited) {
  if (vbar::test::kAddressSanitizer) GTEST_SKIP() << "memory is not limited in a program with address sanitizer";
  EXPECT_THAT(
      [] {
        (void)library_in_child(kLibraries + "libvbar_article_with_faults.so", 7, std::chrono::minutes(1))
            ->step(7, vbar::test::step_packets(7, 3));
      },
      testing::ThrowsMessage<FlightComputerError>(
          AllOf(HasSubstr("at step 7"), HasSubstr("limit of its memory, 64 MiB"))));
}

// In its process group, or in a session of their own.
TEST(LibraryInChild, ProcessesThatItStartedEndWithIt) {
  const auto is_alive = [](int pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string line;
    return std::getline(file, line) && line.at(line.rfind(')') + 2) != 'Z';
  };
  for (const std::uint8_t fault : {8, 11}) {
    const auto child = library_in_child(kLibraries + "libvbar_article_with_faults.so", fault);
    const StepResult result = child->step(0, vbar::test::step_packets(0, 3));
    ASSERT_EQ(result.packets.size(), 1U);
    const int pid = std::stoi(std::string(result.packets[0].begin(), result.packets[0].end()));
    EXPECT_TRUE(is_alive(pid));
    child->close();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (is_alive(pid) && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_FALSE(is_alive(pid)) << "fault " << int{fault};
  }
}

// What an article asks for is checked before it is allocated.
TEST(InProcess, AStateThatThereCannotBeIsRefused) {
  const auto error_of = [](std::size_t (*size)(), std::size_t (*alignment)()) {
    auto article = std::make_shared<TestArticle>(*linked_test_article());
    article->state_size = size;
    article->state_alignment = alignment;
    try {
      (void)make_in_process(article, 1);
    } catch (const FlightComputerError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto small = [] { return std::size_t{64}; };
  EXPECT_THAT(error_of([] { return std::size_t{1} << 60; }, small),
              AllOf(HasSubstr("'vbar link exerciser'"), HasSubstr("1152921504606846976 bytes"),
                    HasSubstr("accepted: up to 1073741824")));
  for (std::size_t (*const alignment)() :
       {+[] { return std::size_t{0}; }, +[] { return std::size_t{3}; }, +[] { return std::size_t{1} << 40; }})
    EXPECT_THAT(error_of(small, alignment), HasSubstr("accepted: powers of two from 1 to 4096"));
}

}  // namespace

namespace {

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
