#pragma once
// An image of a testbed beside the image that the digital twin makes of the same exposure, for the gallery of a report.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
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

}  // namespace vbar::sensors
