#pragma once
// Crops in files, little endian:
//
//   16 bytes "vbar crops 1" and zeros
//   u32 crops, side (128), keypoints (11), numbers (kNumbers); u64 seed; i64 index of the first
//   then each crop: side x side bytes, min(255, round(4 * sample)), rows from the top; f32 numbers:
//     0..21   places of the keypoints in cells of a map, x and y
//     22..32  1 if the keypoint counts, else 0
//     33..36  q_camera_body: rotates body axes into camera axes, x y z w
//     37..39  centre of mass in camera axes, m
//     40..42  centre (x, y) and side of the crop on the detector, px
//     43..50  camera: focal length, principal point (px), distortion k1 k2 p1 p2 k3
//     51..55  phase angle (rad), sunlit, exposure (in nominal ones), spread (px), angle nadir to boresight (rad)

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "host_sim/training/crop_maker.h"

namespace vbar::training {

inline constexpr std::uint32_t kNumbers = 56;

/// Appends a crop's bytes.
void append_crop(const LabelledCrop& crop, const twins::camera::CameraSettings& camera, std::string& bytes);

/// Writes a file of crops. `crops`: what append_crop made of `count` of them. Throws std::runtime_error that names the
/// file; it has its name only once it is whole.
void write_shard(const std::filesystem::path& file, std::uint64_t seed, std::int64_t first, std::uint32_t count,
                 const std::string& crops);

}  // namespace vbar::training
