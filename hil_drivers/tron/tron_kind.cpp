#include "hil_drivers/tron/tron_kind.h"

#include "hil_drivers/tron/tron_report.h"
#include "hil_drivers/tron/tron_run.h"

namespace vbar::tron {
namespace {

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<TronRun>(dynamic_cast<const TronSettings&>(settings), context);
}

testbeds::CalibratedCamera calibrated(const mission::TestbedSettings& settings, const mission::Mission& mission,
                                      const std::filesystem::path& data_directory,
                                      const twins::camera::CameraSettings& of_mission) {
  const auto& own = dynamic_cast<const TronSettings&>(settings);
  const Calibration calibration = load_calibration(calibration_file(own, data_directory, mission.seed));
  return {calibrated_camera(calibration, of_mission), std::nullopt};
}

}  // namespace

const testbeds::TestbedKind kTron{{"tron", read_tron}, open, {tables, summarise, sections}, calibrated};

}  // namespace vbar::tron
