#pragma once
// Differences between an emulator and the laboratory as designed: one standard deviation of each hidden error. Each
// error is drawn once from the seed, in a random stream of its own name. Neither driver nor calibration reads any of
// them.

#include <array>
#include <string_view>

namespace vbar::tron::bench {

/// Holds the sizes; defaults are those of data/benches/tron_emulated.toml.
struct ErrorSizes {
  // Arms.
  double joint_offset_deg = 0.15;
  double link_rotation_deg = 0.03;    ///< after each joint, about each axis
  double link_translation_mm = 0.3;   ///< ... along each axis
  double gear_deg = 0.006;            ///< amplitude of a wave with 1 to 3 periods a turn
  double flex_deg_m = 0.05;           ///< flex of A2 a metre of horizontal lever: mean over benches, not a deviation
  double flex_ratio_a3 = 1.5;         ///< flex of A3 relative to that of A2
  double flex_spread = 0.2;           ///< relative standard deviation of both
  double repeatability_deg = 0.0015;  ///< error of each joint at each standstill
  // Track.
  double track_scale = 1e-4;
  double track_offset_mm = 0.8;       ///< sideways and in height
  double track_rotation_deg = 0.035;  ///< roll, pitch, yaw
  double track_repeatability_mm = 0.02;
  // Mounts.
  double mount_rotation_deg = 1.5;  ///< rotation of the camera, and of the plate that mock-up, board and patch share
  double mount_translation_mm = 4.0;
  double plate_rotation_deg = 0.01;  ///< rotation of each of these on the plate: dowel pins, places measured
  double plate_translation_mm = 0.05;
  double base_rotation_deg = 0.3;  ///< rotation of the arm on the floor
  double base_translation_mm = 5.0;
  // Lens.
  double focal_length = 0.003;  ///< relative
  double principal_point_px = 4.0;
  double distortion = 0.03;  ///< error of each coefficient, relative

  /// Returns sizes of a testbed exactly as designed.
  [[nodiscard]] static ErrorSizes none();
};

/// Describes a key of the table [errors].
struct ErrorKey {
  std::string_view key;
  double ErrorSizes::*size;
  double largest;
};

inline constexpr std::array<ErrorKey, 21> kErrorKeys{{
    {"joint_offset_deg", &ErrorSizes::joint_offset_deg, 5.0},
    {"link_rotation_deg", &ErrorSizes::link_rotation_deg, 5.0},
    {"link_translation_mm", &ErrorSizes::link_translation_mm, 50.0},
    {"gear_deg", &ErrorSizes::gear_deg, 1.0},
    {"flex_deg_m", &ErrorSizes::flex_deg_m, 5.0},
    {"flex_ratio_a3", &ErrorSizes::flex_ratio_a3, 10.0},
    {"flex_spread", &ErrorSizes::flex_spread, 1.0},
    {"repeatability_deg", &ErrorSizes::repeatability_deg, 1.0},
    {"track_scale", &ErrorSizes::track_scale, 0.1},
    {"track_offset_mm", &ErrorSizes::track_offset_mm, 50.0},
    {"track_rotation_deg", &ErrorSizes::track_rotation_deg, 5.0},
    {"track_repeatability_mm", &ErrorSizes::track_repeatability_mm, 10.0},
    {"mount_rotation_deg", &ErrorSizes::mount_rotation_deg, 20.0},
    {"mount_translation_mm", &ErrorSizes::mount_translation_mm, 100.0},
    {"plate_rotation_deg", &ErrorSizes::plate_rotation_deg, 20.0},
    {"plate_translation_mm", &ErrorSizes::plate_translation_mm, 100.0},
    {"base_rotation_deg", &ErrorSizes::base_rotation_deg, 20.0},
    {"base_translation_mm", &ErrorSizes::base_translation_mm, 200.0},
    {"focal_length", &ErrorSizes::focal_length, 0.1},
    {"principal_point_px", &ErrorSizes::principal_point_px, 200.0},
    {"distortion", &ErrorSizes::distortion, 1.0},
}};

inline ErrorSizes ErrorSizes::none() {
  ErrorSizes sizes;
  for (const ErrorKey& key : kErrorKeys) sizes.*key.size = 0.0;
  return sizes;
}

}  // namespace vbar::tron::bench
