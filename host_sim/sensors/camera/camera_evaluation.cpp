#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "fsw/math/math.h"
#include "fsw/packets/messages.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/camera/camera_truth.h"
#include "host_sim/sensors/camera/image_gallery.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/camera/pose_gallery.h"

namespace vbar::sensors {

namespace {

using fsw::math::kArcsecond;

}  // namespace

void append_objects(double exposure_s, const telemetry_objects& objects, std::vector<ObjectRow>& rows) {
  const int count = std::min<int>(objects.count, static_cast<int>(std::size(objects.kind)));
  for (int k = 0; k < count; ++k)
    rows.push_back({exposure_s, objects.image, k, objects.kind[k], objects.star[k], objects.x_px[k], objects.y_px[k]});
}

void append_residuals(const ImageRow& row, std::vector<report::ResidualRow>& rows) {
  if (!(row.nis > 0.0)) return;  // the filter did not run
  const double sigma_arcsec = std::hypot(row.prefit[0], row.prefit[1]) / std::sqrt(row.nis) / kArcsecond;
  const char* const sensors[] = {"bearing_in_plane_arcsec", "bearing_cross_plane_arcsec"};
  for (const std::size_t axis : {0U, 1U})
    rows.push_back(
        {row.time_s, sensors[axis], row.prefit[axis] / kArcsecond, row.postfit[axis] / kArcsecond, sigma_arcsec});
}

// Telemetry of images as rows, the truth of their exposures beside it, and pictures of a few.

namespace {

/// Telemetry of a step on an image, in two packets.
struct ImageTelemetry {
  fsw::GpsTime exposure;
  std::optional<telemetry_image> image;
  std::optional<telemetry_objects> objects;
  std::optional<telemetry_pose> pose;
};

ImageTelemetry image_telemetry(std::span<const fsw::packets::PacketView> answer, std::uint8_t unit) {
  ImageTelemetry told;
  for (const fsw::packets::PacketView& packet : answer) {
    if (packet.header.unit != unit) continue;
    if (const auto image = fsw::packets::decode<telemetry_image>(packet); image.ok()) {
      told.exposure = packet.header.time;
      told.image = image.value();
    } else if (const auto objects = fsw::packets::decode<telemetry_objects>(packet); objects.ok()) {
      told.objects = objects.value();
    } else if (const auto pose = fsw::packets::decode<telemetry_pose>(packet); pose.ok()) {
      told.exposure = packet.header.time;
      told.pose = pose.value();
    }
  }
  return told;
}

class CameraEvaluation final : public Evaluation {
 public:
  CameraEvaluation(const mission::Sensor& sensor, const CameraSensor& camera, const EvaluationContext& context)
      : context_(context),
        record_(context.record),
        known_camera_(known_camera(camera, context.mission, mission::data_directory()).sensor),
        unit_(camera_unit(sensor, context.servicer)),
        gallery_(context.mission, context.servicer, twin_of_testbed_camera(context.mission, context.servicer, sensor),
                 unit_),
        pose_gallery_(context.mission, context.servicer, unit_) {
    if (camera.has_use(CameraSensor::kKeypoints))
      known_target_ = target_model_of(context.mission, camera, mission::data_directory());
  }

  void on_measured(const twins::TruthSnapshot& truth) override { truth_recorder_.keep(truth); }

  void on_inputs(fsw::GpsTime time, std::span<const twins::Packet> inputs) override {
    gallery_.on_inputs(time, inputs);
    pose_gallery_.on_inputs(time, inputs);
  }

  void on_answer(fsw::GpsTime time, std::span<const fsw::packets::PacketView> answer) override {
    const ImageTelemetry told = image_telemetry(answer, unit_);
    if (told.image) on_image(seconds_of(time), told);
    if (told.pose) on_pose(seconds_of(time), told);
  }

  void finish() override { gallery_.finish(record_.gallery); }

 private:
  [[nodiscard]] double seconds_of(fsw::GpsTime time) const { return fsw::seconds(time - context_.mission.epoch); }

  void on_image(double step_time_s, const ImageTelemetry& told) {
    auto row = report::row_of<ImageRow>(*told.image);
    row.time_s = seconds_of(told.exposure);
    row.step_time_s = step_time_s;
    const telemetry_objects* const objects =
        told.objects && told.objects->image == told.image->image ? &*told.objects : nullptr;
    const auto truth = truth_recorder_.take(told.exposure);
    if (truth) add_truth(row, *told.image, objects, known_camera_, context_.servicer, *truth);
    if (row.fate >= telemetry_image::kEditFilter) append_residuals(row, record_.residuals);
    if (objects != nullptr) append_objects(row.time_s, *objects, record_.tables.rows<ObjectRow>());
    record_.tables.rows<ImageRow>().push_back(row);
    gallery_.on_image({told.exposure, row, objects, truth ? &*truth : nullptr}, record_.gallery);
  }

  void on_pose(double step_time_s, const ImageTelemetry& told) {
    auto row = report::row_of<PoseRow>(*told.pose);
    row.time_s = seconds_of(told.exposure);
    row.step_time_s = step_time_s;
    append_keypoints(row.time_s, *told.pose, record_.tables.rows<KeypointRow>());
    const auto truth = truth_recorder_.take(told.exposure);
    if (truth && known_target_)
      add_truth(row, record_.tables.rows<KeypointRow>(), *told.pose, known_target_->keypoints_body_m, known_camera_,
                context_.servicer, *truth);
    record_.tables.rows<PoseRow>().push_back(row);
    pose_gallery_.on_pose(told.exposure, *told.pose, row, record_.gallery);
  }

  EvaluationContext context_;
  report::RunRecord& record_;
  CameraSensor known_camera_;
  TruthRecorder truth_recorder_;
  std::optional<target_model> known_target_;  ///< as telecommanded, with navigation by the pose network
  std::uint8_t unit_;
  GalleryRecorder gallery_;
  PoseGallery pose_gallery_;
};

}  // namespace

std::unique_ptr<Evaluation> evaluate_camera(const mission::Sensor& sensor, const EvaluationContext& context) {
  const auto& camera = settings_of<CameraSensor>(sensor);
  if (!camera.is_used()) return nullptr;  // no telemetry reports its images
  return std::make_unique<CameraEvaluation>(sensor, camera, context);
}

}  // namespace vbar::sensors
