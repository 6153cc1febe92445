// The driver of the optical testbed with the emulated bench as a process of its own: X server, GigE Vision, Zaber
// rails.

#include <gtest/gtest.h>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/optical_stimulator/addresses.h"
#include "hil_drivers/optical_stimulator/hardware/bench_devices.h"
#include "tests/integration/optical_stimulator/driver_chain.h"

namespace vbar::optical_stimulator {
namespace {

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
    const BenchAddresses addresses = read_addresses(process_.addresses_file());
    BenchCalibration calibration =
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

  Chain& chain() { return *chain_; }
  BenchDevices& devices() { return *devices_; }

 private:
  bench::BenchSettings settings_;
  bench_process::BenchProcess process_;
  std::optional<BenchDevices> devices_;
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

}  // namespace
}  // namespace vbar::optical_stimulator
