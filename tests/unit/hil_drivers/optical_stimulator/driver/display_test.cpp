// The display on an Xvfb: what another client of the server sees is what was to be shown.

#include "hil_drivers/optical_stimulator/hardware/display.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include "host_sim/io/child_process.h"

namespace vbar::optical_stimulator {
namespace {

// An Xvfb of a test on a free display number, which it finds itself; it ends with the test. It does not start over when
// its last client leaves: meanwhile it would refuse the next one.

class Xvfb {
 public:
  Xvfb(int width, int height) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    const io::FileDescriptor reading(ends[0]);
    std::vector<io::FileDescriptor> inherited;
    inherited.emplace_back(ends[1]);
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    process_.emplace(
        std::vector<std::string>{"Xvfb", "-displayfd", "3", "-screen", "0", screen, "-nolisten", "tcp", "-noreset"},
        std::move(inherited));
    std::string number;
    constexpr int kPatience_ms = 60'000;
    pollfd readable{reading.get(), POLLIN, 0};
    while (!number.ends_with('\n')) {
      char byte = 0;
      if (::poll(&readable, 1, kPatience_ms) != 1 || ::read(reading.get(), &byte, 1) != 1)
        throw std::runtime_error("Xvfb does not start: " + process_->output_tail());
      number += byte;
    }
    number.pop_back();
    name_ = ":" + number;
  }
  ~Xvfb() { process_->terminate(std::chrono::seconds(5)); }
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return process_->pid(); }

 private:
  std::optional<io::ChildProcess> process_;
  std::string name_;
};

using testing::HasSubstr;

constexpr int kWidth = 640, kHeight = 400;

std::string refusal(const DisplaySettings& settings) {
  try {
    const Display display(settings);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Display, ShowsEveryPixelAsItIsAndBlackAtTheEnd) {
  const Xvfb server(kWidth, kHeight);
  const std::string command = "xwd -silent -root -display " + server.name() + " 2>&1";
  const auto screen = [&] {  // of the peer
    FILE* const pipe = ::popen(command.c_str(), "r");
    std::vector<unsigned char> bytes;
    std::array<unsigned char, 65536> part;
    for (std::size_t got; (got = ::fread(part.data(), 1, part.size(), pipe)) > 0;)
      bytes.insert(bytes.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(got));
    ::pclose(pipe);
    return bytes;
  };
  {
    Display display({server.name(), "", kWidth, kHeight});
    for (int frame = 0; frame < 10; ++frame) {
      Picture picture(kWidth, kHeight);
      for (std::size_t k = 0; k < picture.counts.size(); ++k)
        picture.counts[k] = static_cast<std::uint8_t>((k * 2654435761U + static_cast<unsigned>(frame) * 97U) >> 7);
      display.show(picture);
      ASSERT_EQ(display.read_back().counts, picture.counts) << frame;
      if (frame > 0) continue;
      const auto bytes = screen();  // 32 bits a pixel, at the end of the file
      ASSERT_GE(bytes.size(), picture.counts.size() * 4);
      const std::size_t begin = bytes.size() - picture.counts.size() * 4;
      std::size_t wrong = 0;
      for (std::size_t k = 0; k < picture.counts.size(); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
          wrong += bytes[begin + 4 * k + channel] == picture.counts[k] ? 0 : 1;
      EXPECT_EQ(wrong, 0U);
    }
    EXPECT_THROW(display.show(Picture(kWidth, kHeight - 1)), std::runtime_error);
  }
  const auto bytes = screen();
  const std::size_t pixels = static_cast<std::size_t>(kWidth) * kHeight;
  ASSERT_GE(bytes.size(), 4 * pixels);
  std::size_t lit = 0;
  for (std::size_t k = 0; k < pixels; ++k) lit += bytes[bytes.size() - 4 * pixels + 4 * k] == 0 ? 0 : 1;
  EXPECT_EQ(lit, 0U);
}

TEST(Display, AnotherSizeOrOutputIsRefusedByName) {
  const Xvfb server(kWidth, kHeight);
  EXPECT_THAT(refusal({server.name(), "", 1920, 1200}),
              AllOf(HasSubstr("display " + server.name()), HasSubstr("640 x 400"), HasSubstr("1920 x 1200")));
  EXPECT_THAT(refusal({server.name(), "OLED-1", kWidth, kHeight}), HasSubstr("no output \"OLED-1\""));
}

TEST(Display, WithoutACalibrationItIsOfItsOwnSize) {
  const Xvfb server(1280, 1024);
  Display display({server.name(), ""});
  EXPECT_EQ(display.width(), 1280);
  EXPECT_EQ(display.height(), 1024);
  EXPECT_NO_THROW(display.show(Picture(1280, 1024)));
}

TEST(Display, AServerThatIsStoppedForLessIsWaitedFor) {
  const Xvfb server(kWidth, kHeight);
  Display display({server.name(), "", kWidth, kHeight, std::chrono::minutes(5)});
  ASSERT_EQ(::kill(server.pid(), SIGSTOP), 0);
  std::jthread later([pid = server.pid()] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    ::kill(pid, SIGCONT);
  });
  Picture picture(kWidth, kHeight);
  std::fill(picture.counts.begin(), picture.counts.end(), std::uint8_t{77});
  display.show(picture);
  EXPECT_EQ(display.read_back().counts, picture.counts);
}

/// What show() says of a server that is stopped, on the standard error. The process cannot open a display again.
void show_on_a_stopped_server() {
  std::signal(SIGPIPE, SIG_IGN);  // as the programs do
  const Xvfb server(kWidth, kHeight);
  Display display({server.name(), "", kWidth, kHeight});
  ::kill(server.pid(), SIGSTOP);
  int errors = 0;
  for (int k = 0; k < 3; ++k) {
    try {
      display.show(Picture(kWidth, kHeight));
    } catch (const std::runtime_error& error) {
      ++errors;
      std::fprintf(stderr, "%s\n", error.what());
    }
  }
  try {
    static_cast<void>(display.read_back());
  } catch (const std::runtime_error&) {
    ++errors;
  }
  std::_Exit(errors);
}

TEST(DisplayDeathTest, AServerThatIsStoppedIsAnErrorAfterItsLimit) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(show_on_a_stopped_server(), testing::ExitedWithCode(4),
              "display :[0-9]+: its X server has not answered for 5 s");
}

TEST(Display, AServerThatGoesAwayIsAnErrorAndNotTheEndOfTheProgram) {
  std::optional<Xvfb> server(std::in_place, kWidth, kHeight);
  Display display({server->name(), "", kWidth, kHeight});
  server.reset();
  EXPECT_THROW(display.show(Picture(kWidth, kHeight)), std::runtime_error);
  EXPECT_THROW(display.show(Picture(kWidth, kHeight)), std::runtime_error);
}

TEST(Display, AServerThatIsAbsentIsNamed) {
  EXPECT_THAT(refusal({":4711", "", kWidth, kHeight}), HasSubstr("display :4711"));
}

}  // namespace

}  // namespace vbar::optical_stimulator
