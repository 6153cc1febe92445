#pragma once
// True optics of the emulator: where on the detector each pixel of the display is seen, how large it appears
// and how sharp it is.
//
//   point of the display   P = R(tilt, turn) (X, Y, 0) + (shift, f + e)      X, Y: pixel times pitch
//   direction              (x, y) = field + distort(P_xy / P_z)              Brown-Conrady
//   then the camera's rotation, its lens and its pixels
//
// f and e follow from the places of lens 2 and display: a display out of focus appears smaller by e / f, and each
// point as a disc of diameter D e / f^2, D the camera's entrance pupil.

#include <array>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/bench/light/error_field.h"
#include "hil_drivers/optical_stimulator/bench/light/lenses.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator::bench {

struct DisplayPose {
  double pitch_um = 9.6;
  std::array<double, 2> shift_mm{0.13, -0.09};
  double turn_mrad = 2.5;                      ///< about the axis
  std::array<double, 2> tilt_mrad{4.0, -6.0};  ///< about x and y
};

struct OpticsErrors {
  std::array<double, 4> distortion{-0.9, 3.0, 1e-3, -7e-4};  ///< k1, k2, p1, p2
  std::array<double, 3> camera_turn_mrad{};                  ///< rotation vector, bench to camera axes
  double point_spread_sigma_px = 0.85;
  double coma_px = 0.05;  ///< displacement of the centroid at the corner of the detector
};

/// Holds the states that change in a run.
struct BenchState {
  double separation_mm = 40.0;               ///< distance between the lenses
  double display_mm = 34.2857142857142857;   ///< display behind lens 2
  std::array<double, 2> display_moved_um{};  ///< drift, a bump
  double scale_ppm = 0.0;

  friend bool operator==(const BenchState&, const BenchState&) = default;
};

/// Describes how one display pixel is seen.
struct SeenPixel {
  fsw::Vector2 pixel = fsw::Vector2::Zero();    ///< pixel of the detector
  fsw::Vector2 coma_px = fsw::Vector2::Zero();  ///< displacement of the centroid, outwards
  double solid_angle = 0.0;                     ///< sr
  double transmitted = 1.0;                     ///< fraction, vignetting of the camera
  double sigma_px = 0.0;  ///< standard deviation of the point spread, before the pixel's own width
};

class BenchOptics {
 public:
  /// `camera`: its lens and detector. The field outlives this.
  BenchOptics(const LensPair& lenses, const DisplayPose& pose, const OpticsErrors& errors, const ErrorField& field,
              const twins::camera::CameraSettings& camera, int display_width, int display_height);

  void set_state(const BenchState& state);
  [[nodiscard]] const BenchState& state() const { return state_; }

  /// Returns the image of the place (u, v) of the display; an integer is the centre of a pixel.
  [[nodiscard]] SeenPixel seen(double u, double v) const;
  /// Returns the place of that pixel alone.
  [[nodiscard]] fsw::Vector2 detector_pixel(double u, double v) const;
  /// Returns the the place of the display that is seen at a pixel of the detector, to 1e-6 px.
  [[nodiscard]] fsw::Vector2 display_pixel(const fsw::Vector2& detector_pixel) const;

  /// Returns the evenness of the field at a place of the display, 1 on average.
  [[nodiscard]] double light_at(double u, double v) const { return 1.0 + field_->at(u, v).light; }

  [[nodiscard]] double focal_length_mm() const { return focal_length_mm_; }
  [[nodiscard]] double defocus_mm() const { return defocus_mm_; }

 private:
  struct Ray;
  [[nodiscard]] Ray ray(double u, double v) const;

  LensPair lenses_;
  DisplayPose pose_;
  OpticsErrors errors_;
  const ErrorField* field_;
  twins::camera::CameraSettings camera_;
  twins::camera::Optics lens_;
  fsw::Vector2 middle_;  ///< middle of the display, px
  fsw::Matrix3 R_display_ = fsw::Matrix3::Identity();
  fsw::Matrix3 R_camera_ = fsw::Matrix3::Identity();
  BenchState state_;
  double focal_length_mm_ = 0.0, defocus_mm_ = 0.0;
};

}  // namespace vbar::optical_stimulator::bench
