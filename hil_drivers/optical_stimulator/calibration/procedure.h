#pragma once
// Complete calibration, step by step.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/calibration/dots.h"
#include "hil_drivers/optical_stimulator/calibration/geometry_fit.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator::calibrate {

// Interface of a testbed to its calibration. Behind it are the wires of a real or emulated testbed, or a model in a
// test.

class Screen {
 public:
  virtual ~Screen() = default;
  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
  /// Returns when the light of these counts has settled.
  virtual void show(const Picture& counts) = 0;
};

class Eye {
 public:
  virtual ~Eye() = default;
  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
  [[nodiscard]] virtual int bits() const = 0;
  /// Takes an image of the whole detector, right-aligned DN.
  [[nodiscard]] virtual std::vector<std::uint16_t> take(double exposure_s) = 0;
};

class Rails {
 public:
  virtual ~Rails() = default;
  virtual void home() = 0;
  /// Moves both axes, always from the same side, and waits until they are there.
  virtual void move_to(double lens_mm, double display_mm) = 0;
};

// Goals of a calibration, on dots that the fit did not use.

inline constexpr double kRegionMeanGoal_arcsec = 1.5, kRegionP95Goal_arcsec = 3.0;
inline constexpr double kDetectorMeanGoal_arcsec = 2.5, kDetectorP95Goal_arcsec = 5.0;

inline constexpr double kArcsecPerRad = 206264.80624709636;

// State and common operations of a calibration in progress.

struct GridSize {
  int columns = 0, rows = 0;
};

struct ProcedureSettings {
  twins::camera::CameraSettings camera;  ///< the camera's file: optics, region and exposure of the flight's images
  double lens_mm = 25.0;                 ///< position of the axis of lens 2
  double display_mm = 14.29;             ///< position of the axis of the display where the search for the focus begins
  double focus_range_mm = 0.5;           ///< range on both sides of the focus
  GridSize geometry_grid{40, 25}, held_out_grid{27, 17}, uniformity_grid{16, 10};
  int focus_steps = 11, fine_focus_steps = 9;
  int grey_levels = 8;
  int count_level_step = 1;  ///< 2: every second of the 24 levels
  int frames = 4;            ///< images of each picture of the geometry
  double exposure_min_s = 5e-5, exposure_max_s = 0.4;
  std::uint64_t seed = 1;  ///< random stream of the places of the dots held out
};

/// Returns settings with a third of the pictures, for a test of the whole path: its figures are two to three times less
/// precise.
[[nodiscard]] ProcedureSettings quick(ProcedureSettings settings);

struct Bench {
  Screen& screen;
  Eye& eye;
  Rails& rails;
};

class Session {
 public:
  using Progress = std::function<void(const std::string&)>;
  Session(const Bench& bench, const ProcedureSettings& settings, Progress progress);

  /// Returns the mean of frames, with hot pixels replaced once they are known.
  [[nodiscard]] CameraPicture picture(double exposure_s, int frames);
  /// Returns a picture at an exposure that brings the highest pixels near half of the range; starts at `exposure_s` and
  /// returns the exposure in it. Exposures end at the limits of the settings.
  [[nodiscard]] CameraPicture well_exposed(double& exposure_s, int frames);
  [[nodiscard]] bool is_saturated(double peak_dn) const { return peak_dn > 0.9 * range_dn(); }
  [[nodiscard]] double range_dn() const { return static_cast<double>((1 << bench.eye.bits()) - 1); }

  /// Returns the camera pixel of a display pixel, as far as the geometry has been fitted.
  [[nodiscard]] fsw::Vector2 expected_px(const fsw::Vector2& display_px) const;
  /// Returns true if a window of `margin_px` about a camera pixel lies on the detector.
  [[nodiscard]] bool is_on_detector(const fsw::Vector2& camera_px, double margin_px) const;
  void set_map(const DisplayMapParameters& parameters);
  [[nodiscard]] const DisplayMap& map() const { return map_; }
  [[nodiscard]] Dot dot_of(const fsw::Vector2& display_px, const fsw::Vector2& camera_px) const;
  void report(const std::string& line) const { progress_(line); }

  Bench bench;
  ProcedureSettings settings;
  StimulatorCalibration result;  ///< filled step by step
  Response response;             ///< response of the display, as far as it has been measured
  double camera_noise_dn = 1.0;
  std::vector<Residual> residuals;  ///< dots held out

 private:
  twins::camera::Optics optics_;
  DisplayMap map_;
  Progress progress_;
};

/// Steps in their order; each needs those before it. They throw std::runtime_error with one sentence.
void measure_noise(Session& session);  ///< offset, background, hot pixels; gain needs step focus
void find_display(Session& session);   ///< a coarse map, and whether the display is mirrored or rotated
void focus(Session& session);
void measure_gain(Session& session);
void measure_light(Session& session);     ///< gamma, first count, uniformity, full pixel
void measure_geometry(Session& session);  ///< map, residuals of dots held out, point spread

struct ProcedureResult {
  StimulatorCalibration calibration;
  std::vector<Residual> residuals;  ///< dots held out, for the heat map
};

/// Calibrates: rails home; noise; focus; gain; counts to light; geometry; dots held out. It fills the measured parts of
/// the validity: rails, display, region and exposure. Throws std::runtime_error with one sentence if a step fails; a
/// geometry that misses its goal is a result (held_out.goal_reached).
[[nodiscard]] ProcedureResult calibrate(const Bench& bench, const ProcedureSettings& settings,
                                        Session::Progress progress);

// calibration.html: the figures of a calibration beside their goals, and the map of the residuals.

[[nodiscard]] std::string calibration_page(const ProcedureResult& result);

}  // namespace vbar::optical_stimulator::calibrate
