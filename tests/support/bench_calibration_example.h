#pragma once
// A calibration in which every figure has a value of its own.

#include <cmath>

#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"

namespace vbar::optical_stimulator {

// A display map with every term: lens terms of the size of a bench's, and a field of degree 16.

inline DisplayMapParameters display_map_example() {
  DisplayMapParameters parameters;
  parameters.lens.centre_px = {973.1, 590.2};
  parameters.lens.scale_px = 5952.4;
  parameters.lens.rotation_rad = 2.5e-3;
  parameters.lens.tilt_rad = {4e-3, -6e-3};
  parameters.lens.distortion = {0.9, -0.6, -1e-3, 7e-4, 2.0};
  ChebyshevField& field = parameters.field;
  field.degree = ChebyshevField::kDegreeMax;
  field.low_px = {6.0, 4.0};
  field.high_px = {1911.0, 1193.0};
  for (std::size_t k = 0; k < ChebyshevField::term_count(field.degree); ++k) {
    field.x_px.push_back(0.1 * std::sin(3.0 * static_cast<double>(k) + 1.0));
    field.y_px.push_back(0.1 * std::cos(5.0 * static_cast<double>(k)));
  }
  return parameters;
}

inline StimulatorCalibration bench_calibration_example() {
  StimulatorCalibration c;
  c.validity = {"2026-11-22T23:00:00Z",
                true,
                "Point Grey Research",
                "Grasshopper3 GS3-PGE-23S6M",
                "14\"1\\7",
                40.0,
                34.2857142857142847,
                1920,
                1200,
                60.0,
                {710, 200, 500, 800},
                0.2};
  c.geometry = display_map_example();
  c.lens_sigma.centre_px = {0.01, 0.02};
  c.lens_sigma.scale_px = 0.1 + 0.2;
  c.lens_sigma.distortion = {1e-3, 1e-2, 1e-5, 1.0 / 3.0, 0.7};
  c.field_sigma_px = 0.004;
  c.light = {{1.2e7, 3e4}, {1.2e2, 0.4}, {2.2, 0.002}, {3.0, 0.05}, 0.011};
  c.uniformity = {3, 2, {100.5, 200.25}, {800.0, 700.0}, {0.9, 1.0, 1.1, 1.05, 0.97, 0.98}, 0.004};
  c.camera = {
      {66.0, 0.01}, {0.12875, 1e-5}, {7.7, 0.02}, {125.0, 0.5}, {0.99, 0.003}, 12, {{5, 7, 1e4}, {1919, 1199, 2.5e4}}};
  c.held_out = {{0.5, 1.1, 120}, {0.6, 1.4, 459}, {9.8, 20.1, 120}, {11.7, 24.4, 459}, true};
  c.centroid_floor_px = 0.021;
  return c;
}

}  // namespace vbar::optical_stimulator
