#pragma once
// What a camera sees of the sky, for tests of star identification: from the star file through ERFA (proper motion,
// aberration), not from the tables on board.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "fsw/vision/stars/star_identification.h"

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

// Many random attitudes through star identification, and what came of it.

/// A scene as star identification is given it.
inline std::vector<fsw::stars::ObservedStar> observed(const Scene& scene, double sigma_rad) {
  std::vector<fsw::stars::ObservedStar> objects;
  for (std::size_t k = 0; k < scene.direction.size() && k < fsw::imaging::kMaxObjects; ++k) {
    objects.push_back({scene.direction[k], sigma_rad, scene.magnitude[k]});
  }
  return objects;
}

struct Tally {
  int identified = 0;
  int wrong_attitudes = 0;   ///< beyond six sigma
  int wrong_stars = 0;       ///< a star taken for another
  int false_as_star = 0;     ///< an object that is no star taken for one, as chance must now and then have it
  double squared_error = 0;  ///< sum of squared errors over their sigma: boresight's two axes and roll, each mean 1
  double chi_square = 0;
  long degrees_of_freedom = 0;
  std::vector<double> boresight_error;  ///< rad
};

/// Normalised squared error of an attitude, chi-square of 3 degrees of freedom.
inline double normalised_squared_error(const fsw::stars::AttitudeFix& fix, const Eigen::Matrix3d& R_camera_eci) {
  const Eigen::Matrix3d turn = fix.R_camera_eci * R_camera_eci.transpose();
  const Eigen::Vector3d angle =
      0.5 * Eigen::Vector3d(turn(1, 2) - turn(2, 1), turn(2, 0) - turn(0, 2), turn(0, 1) - turn(1, 0));
  return angle.dot(fix.covariance_camera.inverse() * angle);
}

inline void count(Tally& tally, const Scene& scene, const fsw::stars::AttitudeFix& fix) {
  ++tally.identified;
  const double squared = normalised_squared_error(fix, scene.R_camera_eci);
  tally.squared_error += squared;
  if (!(squared < 36.0)) ++tally.wrong_attitudes;
  tally.chi_square += fix.chi_square;
  tally.degrees_of_freedom += 2 * fix.matches - 3;
  tally.boresight_error.push_back((fix.R_camera_eci.row(2) - scene.R_camera_eci.row(2)).norm());
  for (int m = 0; m < fix.matches; ++m) {
    const fsw::stars::StarMatch match = fix.match[static_cast<std::size_t>(m)];
    const TrueStar* truth = scene.truth[static_cast<std::size_t>(match.object)];
    if (truth == nullptr) {
      ++tally.false_as_star;
    } else if (std::ranges::count(truth->hipparcos, fsw::stars::star_hipparcos(match.catalogue)) == 0) {
      ++tally.wrong_stars;
    }
  }
}

struct Campaign {
  SceneSettings scene;
  int attitudes = 1000;
  unsigned seed = 1;
  double prediction_error = 0.0;  ///< rad, largest about each axis; 0: lost in space
};

/// Observers move at Earth's speed in any direction.
inline Tally fly(const std::vector<TrueStar>& sky, const Campaign& campaign) {
  Random random(campaign.seed);
  auto identifier = std::make_unique<fsw::stars::StarIdentifier>();
  const fsw::stars::Field field{Eigen::Vector3d::UnitZ(), campaign.scene.camera.radius()};
  const double sigma = campaign.scene.noise_px / campaign.scene.camera.focal_length_px;
  Tally tally;
  for (int k = 0; k < campaign.attitudes; ++k) {
    const Eigen::Matrix3d R_camera_eci = random_rotation(random);
    const Eigen::Vector3d velocity_over_c = 1.0e-4 * random_rotation(random).row(0).transpose();
    const Scene scene = draw_scene(sky, campaign.scene, R_camera_eci, velocity_over_c, random);
    const double e = campaign.prediction_error;
    const Eigen::Vector3d error(uniform(random, -e, e), uniform(random, -e, e), uniform(random, -e, e));
    const auto objects = observed(scene, sigma);
    const fsw::Status status =
        e > 0.0 ? identifier->track(objects, field, small_rotation(error) * R_camera_eci, e, velocity_over_c)
                : identifier->lost_in_space(objects, field, velocity_over_c);
    if (status == fsw::Status::kOk) count(tally, scene, identifier->fix());
  }
  return tally;
}

}  // namespace vbar::sky
