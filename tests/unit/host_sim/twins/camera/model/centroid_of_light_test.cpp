// Centroid of the light of a body of unknown attitude, by Monte Carlo with the renderer: what CentroidModel
// (fsw/vision/target_tracking/bearing.h) states of it by phase angle. Axes about which a body turns are uniform; of
// each, the mean over a turn is what remains of the offset for many images, and the rest is different in each image.

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fsw/vision/target_tracking/bearing.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/twins/camera/model/ray_tracer.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector2;
using fsw::Vector3;

constexpr double kRange_m = 3000.0;

/// Moments of the centroid across the line of sight, from the centre of mass, m: x towards the Sun.
struct Moments {
  double mean = 0.0;                   ///< along x
  Vector2 lasting = Vector2::Zero();   ///< standard deviation of the means over a turn
  Vector2 changing = Vector2::Zero();  ///< root mean square about the mean of the turn
};

Moments moments_of(TargetRenderer& renderer, const Vector3& centre_of_mass, double phase, int axes, int angles) {
  std::mt19937_64 random(20261127);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vector3(normal(random), normal(random), normal(random)).normalized(); };
  std::vector<Vector2> means;
  Vector2 changing = Vector2::Zero(), mean_of_all = Vector2::Zero();
  std::vector<LightSample> light;
  for (int axis = 0; axis < axes; ++axis) {
    const Vector3 spin = direction();
    const Eigen::Quaterniond start = Eigen::Quaterniond::FromTwoVectors(direction(), direction()) *
                                     Eigen::AngleAxisd(2.0 * M_PI * std::abs(normal(random)), direction());
    std::vector<Vector2> turn;
    for (int k = 0; k < angles; ++k) {
      TargetView view = view_at(kRange_m, phase);
      view.R_camera_body = (Eigen::AngleAxisd(2.0 * M_PI * k / angles, spin) * start).toRotationMatrix();
      view.position_camera -= view.R_camera_body * centre_of_mass;
      light.clear();
      renderer.render(view, light);
      const Light sum = sum_of(light);
      if (sum.flux > 0.0) turn.push_back(kRange_m * sum.direction.head<2>());
    }
    if (turn.size() < 2) continue;
    Vector2 mean = Vector2::Zero();
    for (const Vector2& point : turn) mean += point / static_cast<double>(turn.size());
    for (const Vector2& point : turn)
      changing += (point - mean).cwiseAbs2() / (static_cast<double>(turn.size()) * axes);
    means.push_back(mean);
    mean_of_all += mean / axes;
  }
  Moments result{.mean = mean_of_all.x(), .changing = changing.cwiseSqrt()};
  Vector2 square = Vector2::Zero();
  for (const Vector2& mean : means) square += (mean - mean_of_all).cwiseAbs2() / static_cast<double>(means.size());
  result.lasting = square.cwiseSqrt();
  return result;
}

// 16 axes determine a standard deviation to a sixth, and the mean to a tenth of the scatter.
TEST(CentroidOfLight, OfTangoScattersWithThePhaseAngleAsModelled) {
  const CadModel model = load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
  TargetRenderer renderer(model);
  const Vector3 centre_of_mass(0.0, 0.018823529411764704, 0.160794117647059);  // data/bodies/tango.toml
  constexpr double kScatterAtHalfPhase_m = 0.097, kOffsetAtHalfPhase_m = 0.163;
  for (const double degrees : {45.0, 90.0, 140.0}) {
    const double phase = degrees * M_PI / 180.0;
    const Moments moments = moments_of(renderer, centre_of_mass, phase, 16, 8);
    const double scatter = moments.changing.norm() / std::sqrt(2.0);
    const double modelled = kScatterAtHalfPhase_m * fsw::target_tracking::centroid_scatter_growth(std::cos(phase));
    const double offset = fsw::target_tracking::centre_of_brightness(Vector3(0.0, 0.0, kRange_m), Vector3::Zero(),
                                                                     Vector3(std::sin(phase), 0.0, -std::cos(phase)),
                                                                     {.to_sun_m = kOffsetAtHalfPhase_m})
                              .x();
    EXPECT_NEAR(moments.mean, offset, 0.04) << degrees;
    EXPECT_NEAR(scatter / modelled, 1.0, 0.35) << degrees;
  }
}

}  // namespace
}  // namespace vbar::twins::camera
