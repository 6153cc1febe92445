#include "hil_drivers/optical_stimulator/stimulator_kind.h"

#include "hil_drivers/optical_stimulator/stimulator_report.h"
#include "hil_drivers/optical_stimulator/stimulator_run.h"

namespace vbar::optical_stimulator {
namespace {

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<StimulatorRun>(dynamic_cast<const OpticalStimulatorSettings&>(settings), context);
}

testbeds::CalibratedCamera calibrated(const mission::TestbedSettings& settings, const mission::Mission& mission,
                                      const std::filesystem::path& data_directory,
                                      const twins::camera::CameraSettings& of_mission) {
  const auto& own = dynamic_cast<const OpticalStimulatorSettings&>(settings);
  const BenchCalibration calibration = load_calibration(calibration_file(own, data_directory, mission.seed));
  return {calibrated_camera(calibration, of_mission), calibration.centroid_floor_px};
}

}  // namespace

const testbeds::TestbedKind kOpticalStimulator{
    {"optical_stimulator", read_optical_stimulator}, open, {tables, summarise, sections}, calibrated};

}  // namespace vbar::optical_stimulator
