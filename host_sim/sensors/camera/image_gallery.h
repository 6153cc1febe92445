#pragma once
// An image of a testbed beside the image that the digital twin makes of the same exposure, for the gallery of a report.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/image_assembly.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/plots/png.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

/// The pixels that the digital camera takes at this truth: the region, rows from the top.
using TakeTwinImage = std::function<std::vector<std::uint16_t>(const twins::TruthSnapshot& truth, std::int64_t number)>;

/// Returns the twin of a camera of `servicer`, as the testbed that provides its images has calibrated it; empty if no
/// testbed does. The renderer is made with the first image. `mission`, `servicer` and `sensor` must outlive it.
[[nodiscard]] TakeTwinImage twin_of_testbed_camera(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                                   const mission::Sensor& sensor);

/// Both images of one region.
struct ImagePair {
  int width = 0, height = 0;
  int origin_x_px = 0, origin_y_px = 0;          ///< origin of the region on the detector
  std::span<const std::uint16_t> testbed, twin;  ///< 0xFFFF: a pixel that is missing
};

/// Returns the testbed's image less the twin's as PNG: red where the testbed's is brighter, blue where the twin's is,
/// black within five standard deviations of the noise.
[[nodiscard]] std::vector<std::uint8_t> difference_png(const ImagePair& pair);

/// Returns the offset of the target from its place in the twin's image, relative to the identified stars, px: the
/// difference of the bearings. By centroids about the places where flight software found the objects; empty without
/// target or stars.
[[nodiscard]] std::optional<Eigen::Vector2d> target_shift_px(const ImagePair& pair, const telemetry_objects& objects);

/// Describes in words: noise and mean of the difference, bearing errors of both images.
[[nodiscard]] std::string difference_text(const ImagePair& pair, const ImageRow& row, const telemetry_objects* objects,
                                          double focal_length_px);

// Keeps a few of a run's camera images for its report, as the flight software got them and with its own findings.
//
// Which ones is known beforehand from the times of exposure, so that the pixels of all others need never be looked at:
// the first image that has a bearing, and the last one before each waypoint and before the end of the run. For these
// the last images before that time are looked at, and the last one with a bearing is taken, or the last one if none
// has, because the target spends a part of each orbit in eclipse.

/// Telemetry of the flight software on an image (telemetry_image, telemetry_objects).
struct ImageFindings {
  fsw::GpsTime exposure;
  ImageRow row;
  const telemetry_objects* objects = nullptr;   ///< null if telemetry did not report them
  const twins::TruthSnapshot* truth = nullptr;  ///< at the exposure, if it is known
};

class GalleryRecorder {
 public:
  static constexpr int kExposuresBefore = 20;  ///< that are looked at before a waypoint

  /// Keeps nothing unless the camera of that unit navigates by angles only.
  /// `take_twin`: for images of a testbed, whose images the gallery shows beside those of the digital twin.
  GalleryRecorder(const mission::Mission& mission, const mission::Spacecraft& servicer, TakeTwinImage take_twin = {},
                  std::uint8_t unit = 0);

  /// Receives the packets that the flight software got with the step at `now`; tiles among them are assembled if they
  /// may be wanted. One image is kept, as in the flight software.
  void on_inputs(fsw::GpsTime now, std::span<const twins::Packet> inputs);

  /// Receives the findings of an image, after on_inputs() of the same step. Images come in order of time.
  void on_image(const ImageFindings& found, std::vector<report::GalleryImage>& gallery);

  /// Puts what is still kept into the gallery, at the end of the run.
  void finish(std::vector<report::GalleryImage>& gallery);

 private:
  /// An image that goes into the gallery unless a better one comes before `moment`.
  struct Candidate {
    fsw::GpsTime moment;
    ImageRow row;
    fsw::imaging::ImageFrame frame;
    std::vector<std::uint16_t> dn;
    std::optional<telemetry_objects> objects;
    std::optional<twins::TruthSnapshot> truth;
  };

  [[nodiscard]] bool may_be_wanted(fsw::GpsTime now) const;
  /// Returns the first moment at or after an exposure, if the exposure is among the last before it.
  [[nodiscard]] std::optional<fsw::GpsTime> moment_of(fsw::GpsTime exposure) const;
  [[nodiscard]] Candidate candidate(const ImageFindings& found, fsw::GpsTime moment) const;
  [[nodiscard]] report::GalleryImage picture(const Candidate& candidate) const;
  void add_twin(const Candidate& candidate, const report::Stretch& stretch, report::GalleryImage& image) const;

  std::unique_ptr<fsw::imaging::ImageAssembly> assembly_;  ///< null without a camera; large
  std::vector<fsw::GpsTime> moments_;                      ///< in order
  fsw::Duration before_;
  double focal_length_px_ = 0.0;
  TakeTwinImage take_twin_;
  bool has_bearing_ = false;
  std::optional<Candidate> best_;
};

}  // namespace vbar::sensors
