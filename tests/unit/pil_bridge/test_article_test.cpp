#include "pil_bridge/test_article.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pil_bridge/in_process.h"
#include "pil_bridge/make_flight_computer.h"
#include "tests/support/paths.h"
#include "tests/support/step_packets.h"

namespace vbar::pil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

// A library flies in a child process, with the same bits.
std::unique_ptr<FlightComputer> library_in_child(const std::string& library, std::uint8_t spacecraft) {
  FlightComputerOptions options;
  options.library = library;
  options.spacecraft = spacecraft;
  options.library_step_limit = std::chrono::milliseconds(500);
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
  EXPECT_THAT(flying(4), ThrowsMessage<FlightComputerError>(HasSubstr("crashed while it was loaded")));
  EXPECT_THAT(flying(5), ThrowsMessage<FlightComputerError>(HasSubstr("did not return while it was loaded")));
}

}  // namespace
}  // namespace vbar::pil
