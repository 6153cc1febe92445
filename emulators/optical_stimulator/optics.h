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
#include <cstdint>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator::bench {

// Two thin lenses on the axis of a camera, and a display behind them.

/// Describes two lenses: lens 1 is next to the camera; lens 2 stands `separation_mm` behind it, the display behind
/// lens 2.
struct LensPair {
  double f1_mm = 100.0;
  double f2_mm = 80.0;
  double separation_mm = 40.0;

  [[nodiscard]] constexpr double focal_length_mm() const { return f1_mm * f2_mm / (f1_mm + f2_mm - separation_mm); }
  /// Returns the distance of the display behind lens 2 at which its light leaves lens 1 parallel.
  [[nodiscard]] constexpr double infinity_mm() const {
    return f2_mm * (f1_mm - separation_mm) / (f1_mm + f2_mm - separation_mm);
  }
};

// Errors that no lens model expresses: a smooth field of direction errors over the display, and a smooth unevenness of
// its light. Both are sums of plane waves, tabulated on a grid that a cubic spline interpolates.

struct FieldSettings {
  int waves = 60;
  double wave_length_px = 300.0;   ///< reciprocal of one sigma of a wave number (rad/px), a component
  double direction_arcsec = 15.0;  ///< rms of the direction, an axis
  double light = 0.05;             ///< rms of the light, relative; its waves are as long as the display is wide
};

/// Holds the errors at one place of the display.
struct FieldError {
  double x = 0.0, y = 0.0;  ///< rad
  double light = 0.0;       ///< relative
};

class ErrorField {
 public:
  /// Draws the field of a display of `width` times `height` pixels.
  ErrorField(const FieldSettings& settings, std::uint64_t seed, int width, int height);

  /// Returns the errors at a display pixel; beyond the display the field continues for a few pixels.
  [[nodiscard]] FieldError at(double u, double v) const;

  static constexpr int kStep_px = 16;

 private:
  int columns_, rows_;
  std::vector<FieldError> nodes_;  ///< the first is at (-2, -2) steps
};

// Conversion of the counts of a display to its luminance.
//
//   L(D) = L_full ((D - D0)/(255 - D0))^gamma (D > D0)  + L_full / contrast,   times the evenness of the pixel

struct DisplayLight {
  double full_luminance = 200.0;  ///< cd/m^2
  double gamma = 2.2;
  double first_count = 3.0;  ///< D0: up to it no light
  double contrast = 1e5;
  double pixel_unevenness = 0.02;  ///< one sigma, relative

  /// Returns the luminance above the black level, cd/m^2.
  [[nodiscard]] double luminance(double count) const;
  [[nodiscard]] double black_luminance() const { return full_luminance / contrast; }
};

/// Number of counts that a display shows.
inline constexpr std::size_t kCounts = 256;
using CountTable = std::array<float, kCounts>;
[[nodiscard]] CountTable luminance_table(const DisplayLight& light);

/// Holds the light of single pixels relative to their neighbourhood.
class PixelEvenness {
 public:
  PixelEvenness(double sigma, std::uint64_t seed) : sigma_(sigma), stream_(seed, "bench/display/pixels") {}
  [[nodiscard]] double of(std::uint64_t pixel) const;

 private:
  double sigma_;
  engine::RandomStream stream_;
};

/// Returns photons/m^2 at the camera in a second per lux of illuminance: a star of magnitude 0 is 2.54e-6 lx (Allen
/// 1973, rounded) and radiates `zero_magnitude_photons`.
[[nodiscard]] constexpr double photons_per_lux(double zero_magnitude_photons) {
  return zero_magnitude_photons / 2.54e-6;
}

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
