#pragma once
// Light of the lamp and of the boxes in the laboratory, photons/(m^2 s) (at the peak of the detector's response, as the
// digital twin counts them).

#include <array>
#include <cstdint>
#include <vector>

#include "emulators/tron/scene/lab_view.h"
#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

inline constexpr double kLampRadiusRad = 0.01745329251994329577;      ///< 2 deg across [TRON lamp; the Sun: 0.53 deg]
inline constexpr double kBeamDivergenceRad = 0.03490658503988659154;  ///< at the edge of the beam
inline constexpr double kBeamUnevenness = 0.10;                       ///< largest, within the beam
inline constexpr double kFlicker = 0.01;                              ///< 1 sigma, of an image

/// Describes the lamp's light. Parallel and without edge if `inverse_distance` and `radius_m` are zero.
struct LampBeam {
  fsw::Vector3 centre_m = fsw::Vector3::Zero();    ///< L, where the irradiance is `irradiance`
  fsw::Vector3 direction = fsw::Vector3::UnitX();  ///< from there to the lamp
  fsw::Vector3 across = fsw::Vector3::UnitY(), up = fsw::Vector3::UnitZ();
  double inverse_distance = 0.0;   ///< reciprocal distance of the point from which the beam seems to come, 1/m
  double source_radius_rad = 0.0;  ///< angular radius of the lamp as any lit point sees it
  double radius_m = 0.0;           ///< radius of the beam at the centre
  std::array<double, 3> uneven{};  ///< relative irradiance 1 + a u + b v + c (u^2 + v^2), 1 at the edge
  double irradiance = 0.0;

  [[nodiscard]] fsw::Vector3 direction_at(const fsw::Vector3& point_L) const;
  /// Returns the irradiance of an area that faces the lamp.
  [[nodiscard]] double irradiance_at(const fsw::Vector3& point_L) const;
};

inline constexpr double kBeamEdgeM = 0.015;  ///< half width of the edge of the beam

/// Returns the beam in frame L. `sun_photons`: light of the Sun at 1 au.
[[nodiscard]] LampBeam lamp_beam(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed,
                                 const LabView& view, double sun_photons);

/// Describes a part of a box: a small Lambert emitter.
struct Emitter {
  fsw::Vector3 place_m;
  fsw::Vector3 normal;
  double radiance_area = 0.0;  ///< photons/(s sr)
};

/// Describes a rectangle of even radiance.
struct BoxLight {
  fsw::Vector3 centre_m, normal, across, up;
  double half_side_m = 0.3;
  double radiance = 0.0;  ///< photons/(m^2 s sr)
};

[[nodiscard]] std::array<BoxLight, kBoxes> box_lights(const TestbedDesign& bench,
                                                      const std::array<double, kBoxes>& powers, double sun_photons);

/// Returns Gauss's four points of a box of 0.6 m: its light to 0.4 % at 1 m, falling with the fourth power of the
/// distance.
[[nodiscard]] std::array<Emitter, 4> emitters_of(const BoxLight& box);

/// Returns the irradiance of an area; without anything in between.
[[nodiscard]] double irradiance_of(const BoxLight& box, const fsw::Vector3& place_m, const fsw::Vector3& normal);

/// Returns the vector of irradiance at a place: its component along a unit vector is the irradiance of an area that
/// faces there less that of its back.
[[nodiscard]] fsw::Vector3 light_vector(const std::array<BoxLight, kBoxes>& boxes, const fsw::Vector3& place_m);

// Conversion of radiance to photo-electrons, pixel by pixel: solid angle of a pixel (distortion included) times
// transmission.

class LensMap {
 public:
  /// Computes the map of `area` of the detector; `area` may reach beyond the detector.
  LensMap(const twins::camera::CameraSettings& settings, const twins::camera::Region& area);

  [[nodiscard]] bool is_of(const twins::camera::CameraSettings& settings, const twins::camera::Region& area) const;
  /// Returns photo-electrons a second per unit of radiance, photons/(m^2 s sr); rows from the top.
  [[nodiscard]] const std::vector<float>& electrons_per_radiance() const { return map_; }

 private:
  twins::camera::CameraSettings settings_;
  twins::camera::Region area_;
  std::vector<float> map_;
};

}  // namespace vbar::tron::bench
