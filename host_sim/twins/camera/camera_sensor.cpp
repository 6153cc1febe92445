#include "host_sim/twins/camera/camera_sensor.h"

#include <stdexcept>
#include <utility>

#include "host_sim/twins/camera/image_recipe.h"
#include "host_sim/twins/camera/recorded_image.h"

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
    const ImageMaker::Settings& image = settings_.image;
    measurement.recipe = LoggedImage{{image.spacecraft, image.unit, image_number_on_link(number)},
                                     bytes_of({image.spacecraft, image.unit, exposure})};
    if (settings_.sends_packets || !taker_->is_reproducible())
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
  {
    const Stopwatch watch(packing_s_);
    completion.packets = packets_of(settings_.image, exposure, image.dn);
  }
  if (!taker_->is_reproducible()) completion.recording = record(exposure, image.dn);
  if (!settings_.sends_packets) completion.packets.clear();
  ++images_;
  return completion;
}

LoggedImage CameraSensor::record(const Exposure& exposure, std::span<const std::uint16_t> dn) {
  const Stopwatch watch(recording_s_);
  const ImageMaker::Settings& image = settings_.image;
  const ImageHeader header{
      {exposure.time, exposure.number, image.spacecraft, image.unit}, image.camera.region, image.camera.detector.bits};
  LoggedImage recording{header.key(), recorded_image_of(header, dn)};
  recorded_bytes_ += static_cast<std::int64_t>(recording.bytes.size());
  return recording;
}

std::vector<Note> CameraSensor::statistics() const {
  std::vector<Note> statistics = taker_->statistics();
  statistics.push_back({"images", static_cast<double>(images_)});
  statistics.push_back({"packing_s", packing_s_});
  if (taker_->is_reproducible()) return statistics;
  statistics.push_back({"recording_s", recording_s_});
  statistics.push_back({"recorded_bytes", static_cast<double>(recorded_bytes_)});
  return statistics;
}

}  // namespace vbar::twins::camera
