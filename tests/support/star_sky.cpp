#include "tests/support/star_sky.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <numeric>
#include <sstream>

#include <Eigen/Geometry>
#include <erfa.h>
#include <erfam.h>

namespace vbar::sky {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTogether = 70.0 * kDegree / 3600.0;

TrueStar star_of_row(const std::string& row, double julian_year) {
  std::istringstream text(row);
  std::array<double, 7> v{};
  for (double& value : v) {
    text >> value;
    text.ignore(1);
  }
  const double ra = v[1] * kDegree;
  const double dec = v[2] * kDegree;
  const double milliarcsecond = kDegree / 3.6e6;
  double ra2 = 0, dec2 = 0, pmr2 = 0, pmd2 = 0, px2 = 0, rv2 = 0;
  eraPmsafe(ra, dec, v[3] * milliarcsecond / std::cos(dec), v[4] * milliarcsecond, 0.0, 0.0, ERFA_DJ00, 0.0, ERFA_DJ00,
            (julian_year - 2000.0) * 365.25, &ra2, &dec2, &pmr2, &pmd2, &px2, &rv2);
  double c[3];
  eraS2c(ra2, dec2, c);
  return {{c[0], c[1], c[2]}, v[5], {static_cast<int>(v[0])}};
}

void merge(TrueStar& into, const TrueStar& other) {
  const double a = std::pow(10.0, -0.4 * into.magnitude);
  const double b = std::pow(10.0, -0.4 * other.magnitude);
  into.direction = (a * into.direction + b * other.direction).normalized();
  into.magnitude = -2.5 * std::log10(a + b);
  into.hipparcos.insert(into.hipparcos.end(), other.hipparcos.begin(), other.hipparcos.end());
}

}  // namespace

std::vector<TrueStar> read_sky(const std::string& star_file, double julian_year) {
  std::ifstream file(star_file);
  std::vector<TrueStar> stars;
  for (std::string row; std::getline(file, row);) {
    if (row.empty() || row[0] == '#' || row[0] == 'h') continue;
    stars.push_back(star_of_row(row, julian_year));
  }
  std::ranges::sort(stars, {}, [](const TrueStar& s) { return s.direction.z(); });
  // The brighter of two takes the fainter in; a sweep in declination.
  std::vector<bool> gone(stars.size(), false);
  std::vector<std::size_t> order(stars.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return stars[k].magnitude; });
  std::vector<TrueStar> seen;
  for (const std::size_t k : order) {
    if (gone[k]) continue;
    TrueStar joint = stars[k];
    gone[k] = true;
    const auto absorb = [&](std::size_t other) {
      if (!gone[other] && (stars[other].direction - stars[k].direction).norm() < kTogether) {
        merge(joint, stars[other]);
        gone[other] = true;
      }
    };
    const double z = stars[k].direction.z();
    for (std::size_t o = k; o-- > 0 && stars[o].direction.z() > z - kTogether;) absorb(o);
    for (std::size_t o = k + 1; o < stars.size() && stars[o].direction.z() < z + kTogether; ++o) absorb(o);
    seen.push_back(joint);
  }
  return seen;
}

double Camera::radius() const {
  return std::atan(0.5 * std::hypot(width_px, height_px) / focal_length_px);
}

double uniform(Random& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

double normal(Random& random) {  // Box and Muller
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(random, 0.0, 1.0)));
  return radius * std::cos(uniform(random, 0.0, 2.0 * std::numbers::pi));
}

Eigen::Matrix3d small_rotation(const Eigen::Vector3d& angle) {
  double vector[3] = {-angle.x(), -angle.y(), -angle.z()};  // ERFA turns the axes, we the vectors
  double matrix[3][3];
  eraRv2m(vector, matrix);
  Eigen::Matrix3d rotation;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rotation(r, c) = matrix[r][c];
  return rotation;
}

Eigen::Matrix3d random_rotation(Random& random) {
  Eigen::Vector3d z(normal(random), normal(random), normal(random));
  Eigen::Vector3d x(normal(random), normal(random), normal(random));
  z.normalize();
  x = (x - x.dot(z) * z).normalized();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation;
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return 2.0 * std::asin(std::min(1.0, (a - b).norm() / (2.0 * std::numbers::sqrt2)));
}

Scene draw_scene(const std::vector<TrueStar>& sky, const SceneSettings& settings, const Eigen::Matrix3d& R_camera_eci,
                 const Eigen::Vector3d& velocity_over_c, Random& random) {
  const Camera& camera = settings.camera;
  struct Object {
    Eigen::Vector2d pixel;
    double magnitude;
    const TrueStar* truth;
  };
  std::vector<Object> objects;
  const Eigen::Vector3d axis = R_camera_eci.row(2);
  const double reach = std::cos(camera.radius() + 0.001);
  const double height = axis.z();
  const double height_reach = camera.radius() + 0.001;
  double velocity[3] = {velocity_over_c.x(), velocity_over_c.y(), velocity_over_c.z()};
  const double inverse_gamma = std::sqrt(1.0 - velocity_over_c.squaredNorm());
  for (const TrueStar& star : sky) {
    // Height first: it spares most of the sky the rest.
    if (star.magnitude > settings.faintest || std::abs(star.direction.data()[2] - height) > height_reach) continue;
    if (star.direction.dot(axis) < reach) continue;
    double natural[3] = {star.direction.x(), star.direction.y(), star.direction.z()};
    double apparent[3];
    eraAb(natural, velocity, 1.0, inverse_gamma, apparent);
    const Eigen::Vector3d b = R_camera_eci * Eigen::Vector3d(apparent[0], apparent[1], apparent[2]);
    const Eigen::Vector2d pixel = camera.focal_length_px * b.head<2>() / b.z();
    if (std::abs(pixel.x()) > 0.5 * camera.width_px || std::abs(pixel.y()) > 0.5 * camera.height_px) continue;
    objects.push_back({pixel, star.magnitude + settings.magnitude_noise * normal(random), &star});
  }
  for (Object& object : objects) {
    object.pixel += settings.noise_px * Eigen::Vector2d(normal(random), normal(random));
  }
  for (int k = 0; k < settings.false_objects; ++k) {
    objects.push_back({{uniform(random, -0.5, 0.5) * camera.width_px, uniform(random, -0.5, 0.5) * camera.height_px},
                       uniform(random, settings.brightest_false, settings.faintest),
                       nullptr});
  }
  for (std::size_t k = objects.size(); k > 1; --k) std::swap(objects[k - 1], objects[random() % k]);
  Scene scene{R_camera_eci, velocity_over_c, {}, {}, {}};
  for (const Object& object : objects) {
    scene.direction.push_back(Eigen::Vector3d(object.pixel.x(), object.pixel.y(), camera.focal_length_px).normalized());
    scene.magnitude.push_back(object.magnitude);
    scene.truth.push_back(object.truth);
  }
  return scene;
}

}  // namespace vbar::sky
