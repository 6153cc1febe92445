// Through all of the bench: a client of X draws, the rails move, a GigE Vision client takes the image.

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "emulators/optical_stimulator/settings.h"
#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/zaber/client.h"
#include "host_sim/io/byte_channel.h"
#include "tests/unit/emulators/optical_stimulator/process/bench_process.h"

namespace vbar::optical_stimulator::bench {
namespace {

using test::Canvas;

constexpr twins::camera::Region kRegion{710, 152, 500, 848};

struct Centroid {
  double x = 0.0, y = 0.0, sum = 0.0;
};

/// Of what stands 20 and more numbers above the offset.
Centroid centroid_of(const gige::Frame& frame) {
  Centroid c;
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const double light = static_cast<double>(frame.dn[static_cast<std::size_t>(frame.width * y + x)]) - 68.0;
      if (light < 20.0) continue;
      c.sum += light;
      c.x += light * (kRegion.x + x);
      c.y += light * (kRegion.y + y);
    }
  }
  c.x /= c.sum;
  c.y /= c.sum;
  return c;
}

class BenchCameraTest : public test::BenchProcessTest {
 protected:
  void start_in_focus(std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--seed", "4", "--set", "rails.zero_error_mm=0", "--set", "camera.hot_pixels=0", "--set",
                             "rails.speed_mm_s=1000"});
    ASSERT_NO_FATAL_FAILURE(start(more));
    zaber::ClientSettings rails;
    rails.line = addresses["rails"]["tcp"].get<std::string>();
    rails.answer_limit = kLong;
    zaber::Client client(rails);
    for (const int axis : {1, 2}) client.home_if_needed(axis);
    client.move_to_um(1, 25000.0);  // lenses 40 mm apart
    client.move_to_um(2, 14285.7);  // display 34.2857 mm behind lens 2
    gige::Camera::Settings settings;
    settings.address = addresses["camera"].get<std::string>();
    settings.region = kRegion;
    settings.timeout_s = 60.0;
    camera.emplace(settings);
    camera->open();
    canvas.emplace(addresses["display"].get<std::string>());
  }
  void TearDown() override {
    camera.reset();
    canvas.reset();
  }

  void draw_dot(int u, int v, unsigned count = 150) {
    canvas->rectangle(0, 0, 1920, 1200, 0);
    canvas->rectangle(u - 1, v - 1, 3, 3, count);
    canvas->finish();
  }
  gige::Frame take() {
    std::string reason;
    for (int tries = 0; tries < 5; ++tries) {  // a loaded machine may lose packets
      auto result = camera->take();
      if (auto* frame = std::get_if<gige::Frame>(&result)) return std::move(*frame);
      reason = std::get<gige::NoFrame>(result).text;
    }
    throw std::runtime_error("no image in five tries: " + reason);
  }
  std::string command(const std::string& line) {
    const auto deadline = io::Clock::now() + kLong;
    const auto channel = io::connect_unix(addresses["control"].get<std::string>(), deadline);
    const std::string text = line + "\n";
    channel->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the bench reads it in its event loop
    return text;
  }

  static constexpr std::chrono::milliseconds kLong{60000};
  std::optional<gige::Camera> camera;
  std::optional<Canvas> canvas;
};

TEST_F(BenchCameraTest, ADotIsSeenWhereTheOpticsPutIt) {
  start_in_focus();
  EXPECT_TRUE(camera->identity().is_emulated());
  const BenchSettings bench = read_bench(mission::data_directory() / "benches/optical_stimulator.toml", {"seed=4"});
  const ErrorField field(bench.field, bench.seed, 1920, 1200);
  const BenchOptics optics(bench.lenses, bench.pose, bench.optics, field, camera_of(bench, mission::data_directory()),
                           1920, 1200);
  for (const auto& [u, v] : {std::pair{960, 600}, {800, 300}, {1100, 900}}) {
    draw_dot(u, v);
    const Centroid seen = centroid_of(take());
    const auto expected = optics.detector_pixel(u, v);
    EXPECT_NEAR(seen.x, expected.x(), 0.1);
    EXPECT_NEAR(seen.y, expected.y(), 0.1);
  }
}

TEST_F(BenchCameraTest, ALateDisplayShowsThePictureBefore) {
  start_in_focus();
  draw_dot(900, 500);
  const Centroid first = centroid_of(take());
  command(R"({"kind": "late_frame", "frames": 1})");
  draw_dot(1000, 700);
  const Centroid late = centroid_of(take());
  EXPECT_NEAR(late.x, first.x, 0.1);
  EXPECT_NEAR(late.y, first.y, 0.1);
  const Centroid after = centroid_of(take());
  EXPECT_GT(after.x, first.x + 80.0);
}

TEST_F(BenchCameraTest, TheSameSeedGivesTheSameImages) {
  std::vector<gige::Frame> images[2];
  for (auto& run : images) {
    start_in_focus();
    for (int k = 0; k < 3; ++k) {
      draw_dot(860 + 50 * k, 600);
      auto result = camera->take();
      if (!std::holds_alternative<gige::Frame>(result)) GTEST_SKIP() << std::get<gige::NoFrame>(result).text;
      run.push_back(std::get<gige::Frame>(std::move(result)));
    }
    TearDown();
    process->terminate(kLong);
    ASSERT_TRUE(process->has_ended());
  }
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(images[0][k].dn, images[1][k].dn);
}

TEST_F(BenchCameraTest, InRealPaceTheDisplayFollowsTheScreen) {
  start_in_focus({"--pace", "real"});
  draw_dot(900, 500);
  // A refresh later, or more of them on a loaded machine.
  const auto until = std::chrono::steady_clock::now() + kLong;
  Centroid first = centroid_of(take());
  while (!(first.sum > 0.0) && std::chrono::steady_clock::now() < until) first = centroid_of(take());
  draw_dot(1000, 700);
  Centroid seen = first;
  while (seen.x < first.x + 95.0 && std::chrono::steady_clock::now() < until) seen = centroid_of(take());
  EXPECT_NEAR(seen.x - first.x, 100.0, 5.0);
  EXPECT_NEAR(seen.y - first.y, 200.0, 5.0);
}

TEST_F(BenchCameraTest, TwoExposuresInRealPaceTakeTheirTime) {
  start_in_focus({"--pace", "real"});
  draw_dot(900, 500);
  const auto begin = std::chrono::steady_clock::now();
  (void)take();
  (void)take();
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(400));
}

TEST_F(BenchCameraTest, APacketInAHundredLostIsSentAgain) {
  start_in_focus();
  command(R"({"kind": "packet_loss", "fraction": 0.01})");
  draw_dot(960, 600);
  std::int64_t resent = 0;
  for (int k = 0; k < 5; ++k) resent += take().packets_resent;
  EXPECT_GT(resent, 0);
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
