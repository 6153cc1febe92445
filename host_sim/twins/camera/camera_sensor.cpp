#include "host_sim/twins/camera/camera_sensor.h"

#include <stdexcept>
#include <utility>

#include "fsw/packets/messages.h"
#include "host_sim/twins/camera/logged_image.h"

namespace vbar::twins::camera {

Worker::Worker() : thread_([this] { work(); }) {}

Worker::~Worker() {
  stop();
}

void Worker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    jobs_.clear();
  }
  something_to_do_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::enqueue(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (stop_) return;
    jobs_.push_back(std::move(job));
  }
  something_to_do_.notify_one();
}

void Worker::work() {
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      something_to_do_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
      if (stop_) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
  }
}

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
  if (settings.first_exposure_s) commanded_.push_back({fsw::GpsTime{}, *settings.first_exposure_s});
}

std::optional<fsw::GpsTime> CameraSensor::next_epoch(fsw::GpsTime from) const {
  const fsw::GpsTime next = settings_.images.next_at(from);
  if (settings_.until && next > *settings_.until) return std::nullopt;
  return next;
}

void CameraSensor::command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) {
  const bool is_mine = settings_.first_exposure_s && packet.header.apid == fsw::packets::Apid::kExposureCommand &&
                       packet.header.unit == settings_.image.unit;
  if (!is_mine) return;
  const auto message = fsw::packets::decode<exposure_command>(packet);
  if (message.ok() && message.value().exposure_s > 0.0) commanded_.push_back({effective, message.value().exposure_s});
}

std::optional<double> CameraSensor::duration_at(fsw::GpsTime time) {
  while (commanded_.size() > 1 && commanded_[1].from <= time) commanded_.erase(commanded_.begin());
  return commanded_.empty() ? std::nullopt : std::optional(commanded_.front().duration_s);
}

Measurement CameraSensor::measure(const TruthSnapshot& truth) {
  Measurement measurement;
  measurement.available = truth.time + settings_.readout;
  try {
    const std::int64_t number = settings_.images.number_of(truth.time);
    Exposure exposure = exposure_of_truth(settings_.mount, truth, number);
    exposure.duration_s = duration_at(truth.time);
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
  const ImageHeader header{{exposure.time, exposure.number, image.spacecraft, image.unit,
                            exposure.duration_s.value_or(image.camera.exposure_s)},
                           image.camera.region,
                           image.camera.detector.bits};
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
