// The driver of the optical testbed with the emulated bench as a process of its own: X server, GigE Vision, Zaber
// rails.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "tests/integration/testbeds/driver_chain.h"

namespace vbar::optical_stimulator {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kSeed = 1;

/// A calibration at the axes' places of best focus: the zeros of the rails are known here, as no calibration has to
/// find them.
class Wired {
 public:
  Wired()
      : settings_(bench::read_bench(tests::source_path("data/benches/optical_stimulator.toml"),
                                    {"seed=" + std::to_string(kSeed), "rails.zero_error_mm=0"})),
        process_(tests::build_path("vbar_os_bench") +
                     " {data}/benches/optical_stimulator.toml --directory {directory} --seed {seed} --set "
                     "rails.zero_error_mm=0",
                 kSeed, tests::source_path("data")) {
    const TestbedAddresses addresses = read_addresses(process_.addresses_file());
    StimulatorCalibration calibration =
        true_calibration(settings_, bench::camera_of(settings_, tests::source_path("data")), {});
    DevicePlan plan;
    plan.camera_address = addresses.camera;
    plan.rails = addresses.rails;
    plan.display.x_display = addresses.display;
    plan.region = region_with_strip(CameraSettings{}.region);
    plan.timeout = std::chrono::seconds(20);
    devices_.emplace(plan, calibration);
    chain_.emplace(std::move(calibration), devices_->screen(), devices_->camera());
  }

  /// A fault that acts from the next exposure on, or at once.
  void inject(const std::string& fault, bool is_answered = true) {
    const io::FileDescriptor control(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = (process_.directory() / "control.sock").string();
    std::ranges::copy(path, address.sun_path);
    const void* const bytes = &address;
    ASSERT_EQ(::connect(control.get(), static_cast<const sockaddr*>(bytes), sizeof address), 0);
    // Faults are acknowledged when they have taken effect. That it has been read is known from the answer to a line
    // that is refused.
    const std::string lines = fault + "\nnot a fault\n";
    ASSERT_EQ(::send(control.get(), lines.data(), lines.size(), 0), static_cast<ssize_t>(lines.size()));
    std::string answers;
    for (char byte = 0; answers.find("error") == std::string::npos && ::recv(control.get(), &byte, 1, 0) == 1;)
      answers += byte;
    EXPECT_EQ(answers.find("error") != std::string::npos, is_answered);
  }

  Chain& chain() { return *chain_; }
  StimulatorDevices& devices() { return *devices_; }

 private:
  bench::BenchSettings settings_;
  testbeds::EmulatorProcess process_;
  std::optional<StimulatorDevices> devices_;
  std::optional<Chain> chain_;
};

TEST(OpticalBench, ImagesAreThoseOfTheTwinForTheFlightSoftware) {
  Wired bench;
  EXPECT_TRUE(bench.devices().identity().is_emulated);
  const SelfCheckFigures check = bench.chain().check();
  EXPECT_EQ(complaint_of(check), "");
  bench.chain().place(check.correction);
  expect_images_as_of_the_twin(bench.chain());
  EXPECT_TRUE(bench.devices().check_rails().has_value());
}

std::string failure_of(Chain& chain) {
  try {
    chain.exchange_black();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(OpticalBench, FaultsOfTheDisplayAreSeenInTheImage) {
  Wired bench;
  Chain& chain = bench.chain();
  EXPECT_EQ(failure_of(chain), "");
  bench.inject(R"({"kind": "late_frame", "frames": 1})");
  const ExchangedImage late = chain.exchange_black();
  EXPECT_EQ(late.tries, 2);
  EXPECT_EQ(late.stale, 1);
  bench.inject(R"({"kind": "frozen_display", "frames": 4})");
  EXPECT_THAT(failure_of(chain), HasSubstr("does not follow"));
  bench.inject(R"({"kind": "mirrored_display", "frames": 4})");
  EXPECT_THAT(failure_of(chain), HasSubstr("mirrored"));
  bench.inject(R"({"kind": "rotated_display", "frames": 4})");
  EXPECT_THAT(failure_of(chain), HasSubstr("no frame strip"));
  for (const char* const what : {"brightness", "gain", "exposure"}) {
    bench.inject(R"({"kind": ")" + std::string(what) + R"(", "factor": 1.1, "frames": 1})");
    EXPECT_EQ(chain.exchange_black().tries, 2) << what;
    bench.inject(R"({"kind": ")" + std::string(what) + R"(", "factor": 0.9, "frames": 2})");
    EXPECT_THAT(failure_of(chain), HasSubstr("calibrated brightness")) << what;
  }
  EXPECT_EQ(failure_of(chain), "");
}

TEST(OpticalBench, ADisplayThatWasMovedFarIsRefused) {
  Wired bench;
  bench.inject(R"({"kind": "bumped", "x_um": 20.0, "y_um": 0.0})");
  EXPECT_THAT(complaint_of(bench.chain().check()), HasSubstr("the display has moved by 2."));
  bench.inject(R"({"kind": "rail_moved", "axis": 2, "by_um": 50.0})");
  EXPECT_THROW(static_cast<void>(bench.devices().check_rails()), std::runtime_error);
}

TEST(OpticalBench, ACameraThatReturnsCostsAReconnect) {
  Wired bench;
  EXPECT_EQ(failure_of(bench.chain()), "");
  bench.inject(R"({"kind": "camera_away", "duration_s": 1.0})");
  EXPECT_EQ(failure_of(bench.chain()), "");
  bench.inject(R"({"kind": "triggers_ignored", "count": 1})");
  EXPECT_EQ(failure_of(bench.chain()), "");
  bench.inject(R"({"kind": "bench_exit"})", false);
  EXPECT_NE(failure_of(bench.chain()), "");
}

}  // namespace
}  // namespace vbar::optical_stimulator
