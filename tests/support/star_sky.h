#pragma once
// What a camera sees of the sky, for tests of star identification: from the star file through ERFA (proper motion,
// aberration), not from the tables on board.

#include <array>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vbar::sky {

struct TrueStar {
  Eigen::Vector3d direction;  ///< barycentric, at the epoch
  double magnitude = 0.0;
  std::vector<int> hipparcos;  ///< of all that are seen as one
};

/// The star file at a Julian year, stars closer than 70 arcsec (two pixels) seen as one.
std::vector<TrueStar> read_sky(const std::string& star_file, double julian_year);

struct Camera {
  double focal_length_px = 5972.7;  // 35 mm, pixels of 5.86 um
  double width_px = 500.0;
  double height_px = 800.0;
  [[nodiscard]] double radius() const;  ///< of the cone around the field, rad
};
inline constexpr Camera kRegion{};
inline constexpr Camera kFull{.width_px = 1920.0, .height_px = 1200.0};

struct Scene {
  Eigen::Matrix3d R_camera_eci;
  Eigen::Vector3d velocity_over_c;
  std::vector<Eigen::Vector3d> direction;  ///< measured, camera axes
  std::vector<double> magnitude;           ///< by flux
  std::vector<const TrueStar*> truth;      ///< null: no star
};

struct SceneSettings {
  Camera camera = kRegion;
  double faintest = 7.5;
  double noise_px = 0.1;
  double magnitude_noise = 0.3;
  int false_objects = 8;
  double brightest_false = 2.0;  ///< false objects' magnitudes are even from here to the faintest
};

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high);
double normal(Random& random);
Eigen::Matrix3d random_rotation(Random& random);
/// Small rotation by a vector, rad.
Eigen::Matrix3d small_rotation(const Eigen::Vector3d& angle);
/// Angle of R_a R_b', rad.
double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// Objects in random order.
Scene draw_scene(const std::vector<TrueStar>& sky, const SceneSettings& settings, const Eigen::Matrix3d& R_camera_eci,
                 const Eigen::Vector3d& velocity_over_c, Random& random);

}  // namespace vbar::sky
