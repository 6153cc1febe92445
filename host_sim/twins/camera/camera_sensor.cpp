#include "host_sim/twins/camera/camera_sensor.h"

#include <stdexcept>
#include <utility>

#include "host_sim/twins/camera/image_recipe.h"

namespace vbar::twins::camera {
namespace {

/// Refuses before the first image what no recipe could hold.
void check_models(const CameraMount& mount) {
  Exposure exposure;
  for (const CameraMount::Model& model : mount.models) {
    if (model.spacecraft == mount.spacecraft) continue;
    ObjectInView& object = exposure.objects.emplace_back();
    object.name = model.spacecraft;
    object.model = model.model;
  }
  static_cast<void>(bytes_of({0, 0, exposure}));
}

}  // namespace

CameraSensor::CameraSensor(const Settings& settings, Renderer renderer)
    : settings_(settings), maker_(settings.image, std::move(renderer)) {
  check_models(settings.mount);
}

std::optional<fsw::GpsTime> CameraSensor::next_epoch(fsw::GpsTime from) const {
  return next_periodic_epoch(settings_.start, settings_.period, from);
}

Measurement CameraSensor::measure(const TruthSnapshot& truth) {
  Measurement measurement;
  measurement.available = truth.time + settings_.readout;
  try {
    const std::int64_t number = (truth.time - settings_.start).ns / settings_.period.ns;
    const Exposure exposure = exposure_of_truth(settings_.mount, truth, number);
    measurement.recipe = bytes_of({settings_.image.spacecraft, settings_.image.unit, exposure});
    measurement.pending = worker_.run([this, exposure] { return maker_.packets_of(exposure); });
    measurement.status = MeasurementStatus::kReady;
  } catch (const std::invalid_argument& error) {
    measurement.status = MeasurementStatus::kFailed;
    measurement.reason = "camera: " + std::string(error.what());
  }
  return measurement;
}

ImagingTime CameraSensor::time_spent() {
  return worker_.run([this] { return maker_.time_spent(); }).get();
}

}  // namespace vbar::twins::camera
