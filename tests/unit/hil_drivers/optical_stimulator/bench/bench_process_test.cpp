// The X server of the bench, read beside an X client, and vbar_os_bench as a process: its addresses, and that nothing
// stays behind however it ends.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <thread>

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "hil_drivers/optical_stimulator/bench/screen/virtual_screen.h"
#include "host_sim/io/child_process.h"
#include "host_sim/mission/data_directory.h"
#include "tests/support/paths.h"

namespace vbar::optical_stimulator::bench {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::chrono::seconds kPatience{120};

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

TEST(VirtualScreen, ReadsThePixelsThatAnXClientReads) {
  const TestDirectory directory;
  VirtualScreen screen(640, 400, directory.path());
  EXPECT_TRUE(fs::is_empty(directory.path()));  // nothing to remove later
  Canvas canvas(screen.display());
  std::mt19937 random(1);
  for (int k = 0; k < 2000; ++k)
    canvas.rectangle(static_cast<int>(random() % 640), static_cast<int>(random() % 400), 1 + random() % 9,
                     1 + random() % 9, random() % 256);
  canvas.finish();
  std::vector<std::uint8_t> grey;
  screen.read(grey);
  XImage* image = XGetImage(canvas.display.get(), canvas.root, 0, 0, 640, 400, AllPlanes, ZPixmap);
  ASSERT_NE(image, nullptr);
  int differences = 0;
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 640; ++x)
      differences += (XGetPixel(image, x, y) & 0xffU) != grey[static_cast<std::size_t>(640 * y + x)] ? 1 : 0;
  XDestroyImage(image);
  EXPECT_EQ(differences, 0);
}

TEST(VirtualScreen, TakesFreeDisplayNumbers) {
  const TestDirectory directory;
  const VirtualScreen a(64, 64, directory.path()), b(64, 64, directory.path());
  EXPECT_NE(a.display(), b.display());
}

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
      std::this_thread::sleep_for(10ms);
    }
    addresses = nlohmann::json::parse(std::ifstream(file));
  }
  [[nodiscard]] bool has_display() const {
    const XClient client(XOpenDisplay(addresses["display"].get<std::string>().c_str()));
    return client != nullptr;
  }
  void expect_display_ends() {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (has_display() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(20ms);
    EXPECT_FALSE(has_display());
  }

  TestDirectory directory;
  std::optional<io::ChildProcess> process;
  nlohmann::json addresses;
};

TEST_F(BenchProcessTest, ListsItsAddressesAndRemovesThemAtItsEnd) {
  start();
  EXPECT_TRUE(has_display());
  EXPECT_TRUE(fs::is_symlink(addresses["rails"]["pty"].get<std::string>()));
  EXPECT_TRUE(fs::is_socket(addresses["control"].get<std::string>()));
  ASSERT_EQ(::kill(process->pid(), SIGTERM), 0);
  ASSERT_TRUE(process->wait_for_end(kPatience));
  EXPECT_EQ(process->status_text(), "exit status 0");
  expect_display_ends();
  for (const auto& entry : fs::directory_iterator(directory.path())) EXPECT_EQ(entry.path().filename(), "faults.jsonl");
}

TEST_F(BenchProcessTest, TheXServerEndsWithAKilledBench) {
  start();
  ASSERT_EQ(::kill(process->pid(), SIGKILL), 0);
  ASSERT_TRUE(process->wait_for_end(kPatience));
  expect_display_ends();
}

TEST_F(BenchProcessTest, AWrongKeyIsOneLineAndExitStatus2) {
  process.emplace(std::vector<std::string>{tests::build_path("vbar_os_bench"),
                                           (mission::data_directory() / "benches/optical_stimulator.toml").string(),
                                           "--directory", directory.path().string(), "--set", "lenses.f1_mm=-1"},
                  std::vector<io::FileDescriptor>{});
  ASSERT_TRUE(process->wait_for_end(kPatience));
  EXPECT_EQ(process->status_text(), "exit status 2");
  EXPECT_NE(process->output_tail().find("lenses.f1_mm"), std::string::npos);
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
