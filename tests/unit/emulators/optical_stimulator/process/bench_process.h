#pragma once
// vbar_os_bench as a process, and an X client that draws on its screen.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "host_sim/io/child_process.h"
#include "host_sim/mission/data_file.h"
#include "tests/support/paths.h"

// Last, also where this header is included: X11 defines macros with names of ours, as Status.
#include <X11/Xlib.h>

namespace vbar::optical_stimulator::bench::test {

namespace fs = std::filesystem;

inline constexpr std::chrono::seconds kPatience{120};

class TestDirectory {
 public:
  TestDirectory() : path_(fs::path(testing::TempDir()) / ("vbar_os_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~TestDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct CloseDisplay {
  void operator()(::Display* display) const { XCloseDisplay(display); }
};
using XClient = std::unique_ptr<::Display, CloseDisplay>;

/// A window over all of the screen, which the client draws into.
struct Canvas {
  explicit Canvas(const std::string& name) : display(XOpenDisplay(name.c_str())) {
    if (!display) throw std::runtime_error("no X client on " + name);
    root = DefaultRootWindow(display.get());
    context = XCreateGC(display.get(), root, 0, nullptr);
  }
  ~Canvas() { XFreeGC(display.get(), context); }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;
  void rectangle(int x, int y, unsigned width, unsigned height, unsigned grey) {
    XSetForeground(display.get(), context, 0x010101UL * grey);
    XFillRectangle(display.get(), root, context, x, y, width, height);
  }
  void finish() { XSync(display.get(), False); }

  XClient display;
  ::Window root = 0;
  ::GC context = nullptr;
};

class BenchProcessTest : public ::testing::Test {
 protected:
  void start(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{tests::build_path("vbar_os_bench"),
                                       (mission::data_directory() / "benches/optical_stimulator.toml").string(),
                                       "--directory", directory.path().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    process.emplace(arguments, std::vector<io::FileDescriptor>{});
    const auto until = std::chrono::steady_clock::now() + kPatience;
    const fs::path file = directory.path() / "addresses.json";
    while (!fs::exists(file)) {
      ASSERT_TRUE(std::chrono::steady_clock::now() < until && !process->has_ended()) << process->output_tail();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    addresses = nlohmann::json::parse(std::ifstream(file));
  }
  [[nodiscard]] bool has_display() const {
    const XClient client(XOpenDisplay(addresses["display"].get<std::string>().c_str()));
    return client != nullptr;
  }
  void expect_display_ends() {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (has_display() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(has_display());
  }

  TestDirectory directory;
  std::optional<io::ChildProcess> process;
  nlohmann::json addresses;
};

}  // namespace vbar::optical_stimulator::bench::test
