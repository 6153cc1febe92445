#include "host_sim/twins/camera/camera_sensor.h"

#include <stdexcept>
#include <utility>

#include "host_sim/twins/camera/image_recipe.h"

namespace vbar::twins::camera {
namespace {

/// Rejects, before the first image, settings that no recipe could hold.
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

CameraSensor::CameraSensor(const Settings& settings, std::unique_ptr<ImageTaker> taker)
    : settings_(settings), taker_(std::move(taker)) {
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
    if (taker_->is_reproducible())
      measurement.recipe = bytes_of({settings_.image.spacecraft, settings_.image.unit, exposure});
    measurement.pending = worker_.run([this, exposure] { return take(exposure); });
    measurement.status = MeasurementStatus::kReady;
  } catch (const std::invalid_argument& error) {
    measurement.status = MeasurementStatus::kFailed;
    measurement.reason = "camera: " + std::string(error.what());
  }
  return measurement;
}

Completion CameraSensor::take(const Exposure& exposure) {
  TakenImage image = taker_->take(exposure);
  Completion completion{{}, std::move(image.notes), std::move(image.failure)};
  if (!completion.failure.empty()) return completion;
  const Stopwatch watch(packing_s_);
  completion.packets = packets_of(settings_.image, exposure, image.dn);
  ++images_;
  return completion;
}

std::vector<Note> CameraSensor::statistics() const {
  std::vector<Note> statistics = taker_->statistics();
  statistics.push_back({"images", static_cast<double>(images_)});
  statistics.push_back({"packing_s", packing_s_});
  return statistics;
}

}  // namespace vbar::twins::camera
