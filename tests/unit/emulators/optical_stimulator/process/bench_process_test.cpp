// The X server of the bench, read beside an X client, and vbar_os_bench as a process: its addresses, and that nothing
// stays behind however it ends.

#include "tests/unit/emulators/optical_stimulator/process/bench_process.h"

#include <filesystem>
#include <random>

#include <X11/Xutil.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "emulators/optical_stimulator/screen.h"

namespace vbar::optical_stimulator::bench {
namespace {

namespace fs = std::filesystem;
using test::BenchProcessTest;
using test::Canvas;
using test::kPatience;
using test::TestDirectory;

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
