#include "tests/unit/fsw/vision/target_tracking/scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/truth/earth/time_scales.h"
#include "tests/support/paths.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::testing {
namespace {

using namespace fsw;
namespace mission = orbit::mission;

constexpr double kArcsec = math::kDegree / 3600.0;
constexpr double kPixel = 34.53 * kArcsec;
constexpr double kHalfWidth_px = 250.0;
constexpr double kHalfHeight_px = 400.0;
const Vector2 kCentre_px(959.5, 599.5);

template <class T>
T must(const Result<T>& result) {
  if (!result.ok()) throw std::runtime_error("status " + std::to_string(static_cast<int>(result.status())));
  return result.value();
}

orbit::CartesianState state_of_mean(const orbit::QnsElements& mean) {
  return must(orbit::cartesian_from_qns(must(orbit::osculating_from_mean(mean))));
}

/// Rows: right, down, boresight of a camera that looks along `boresight_rtn`, its vertical in the orbital plane.
Matrix3 camera_rtn(const Vector3& boresight_rtn) {
  Matrix3 rotation;
  const Vector3 right = boresight_rtn.cross(Vector3::UnitX()).normalized();
  rotation.row(0) = right;
  rotation.row(1) = boresight_rtn.cross(right);
  rotation.row(2) = boresight_rtn;
  return rotation;
}

/// Satellites closer than two and a half pixels are one object, at their common centre of brightness; that with the
/// target in it counts as the target.
void merge_blobs(Scene& scene) {
  for (std::size_t a = 0; a < scene.candidates.size(); ++a) {
    for (std::size_t b = scene.candidates.size() - 1; b > a; --b) {
      target_tracking::Candidate& kept = scene.candidates[a];
      const target_tracking::Candidate& gone = scene.candidates[b];
      if ((kept.object.centroid_px - gone.object.centroid_px).norm() > 2.5) continue;
      const double flux = kept.object.flux_dn + gone.object.flux_dn;
      const double part = gone.object.flux_dn / flux;
      kept.direction_rtn = ((1.0 - part) * kept.direction_rtn + part * gone.direction_rtn).normalized();
      kept.object.centroid_px += part * (gone.object.centroid_px - kept.object.centroid_px);
      kept.object.flux_dn = flux;
      kept.object.sharpness = std::max((1.0 - part) * kept.object.sharpness, part * gone.object.sharpness);
      scene.source[a] = std::min<int>(scene.source[a], scene.source[b]);
      scene.candidates.erase(scene.candidates.begin() + static_cast<std::ptrdiff_t>(b));
      scene.source.erase(scene.source.begin() + static_cast<std::ptrdiff_t>(b));
    }
  }
}

}  // namespace

int Scene::target_index() const {
  for (std::size_t k = 0; k < source.size(); ++k) {
    if (source[k] == 0) return static_cast<int>(k);
  }
  return -1;
}

target_tracking::TrackerInput Scene::input() const {
  target_tracking::TrackerInput input;
  input.time = time;
  input.servicer = servicer;
  input.candidates = candidates;
  input.burns = burns;
  input.prediction = prediction;
  input.detection_probability = detection_probability;
  return input;
}

struct SceneMaker::Sky {
  explicit Sky(const SceneSettings& s) : settings(s), noise(s.seed, "tracking scene") {
    truth::TruthSettings truth_settings;
    truth_settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
    truth_settings.gravity_degree = 20;
    truth_settings.gravity_order = 20;
    truth_settings.data_directory = vbar::tests::source_path("data");
    truth = std::make_unique<truth::TruthModel>(truth_settings);
    start = truth_settings.epoch;

    servicer_mean = must(orbit::mean_from_osculating(mission::kServicerOsculating));
    // Every seed begins elsewhere on the orbit.
    servicer_mean.u += noise.uniform(-math::kPi, math::kPi);
    const auto add = [&](const std::string& name, const Vector6& a_roe_m) {
      truth->add_spacecraft(name,
                            state_of_mean(orbit::qns_from_roe(servicer_mean, Vector6(a_roe_m / mission::kReferenceA))));
    };
    add("servicer", Vector6::Zero());
    add("target", settings.target_a_roe_m);
    for (int k = 0; k < 6; ++k) error_a_roe_m[k] = settings.sigma_a_roe_m[k] * noise.normal();
    add("estimate", settings.target_a_roe_m + error_a_roe_m);
    add("refined estimate", settings.target_a_roe_m + settings.refined * error_a_roe_m);
    for (std::size_t k = 0; k < settings.decoys_a_roe_m.size(); ++k) {
      add("decoy " + std::to_string(k), settings.decoys_a_roe_m[k]);
    }
    for (int k = 0; k < settings.hot_pixels; ++k) {
      const Vector2 place = drawn_place();
      hot.emplace_back(kCentre_px + Vector2(std::round(place.x()) + 0.5, std::round(place.y()) + 0.5));
    }
  }

  // One draw a line: in what order arguments are worked out is each compiler's own.
  Vector2 drawn_normals() {
    const double y = noise.normal();
    const double x = noise.normal();
    return {x, y};
  }
  Vector3 drawn_normals_of_three() {
    const double z = noise.normal();
    const Vector2 xy = drawn_normals();
    return {xy.x(), xy.y(), z};
  }
  /// From the middle of the image.
  Vector2 drawn_place() {
    const double y = noise.uniform(-kHalfHeight_px, kHalfHeight_px);
    const double x = noise.uniform(-kHalfWidth_px, kHalfWidth_px);
    return {x, y};
  }

  void advance(Scene& scene) {
    const double to_s = settings.period_s * image;
    for (const SceneBurn& burn : settings.burns) {
      const double from_s = to_s - settings.period_s;
      if (image == 0 || burn.time_s <= from_s || burn.time_s > to_s) continue;
      const GpsTime at = start + nearest_duration(burn.time_s);
      truth->advance_to(at);
      const double sigma = settings.burn_error * burn.dv_rtn.norm();
      const Vector3 error = drawn_normals_of_three();
      truth->apply_impulse_rtn(0, burn.dv_rtn + sigma * error);
      // Navigation takes the burn as commanded, which to the relative motion is as if the target had made the error.
      for (const std::size_t estimate : {2, 3}) truth->apply_impulse_rtn(estimate, sigma * error);
      scene.burns.push_back({at, burn.dv_rtn, sigma});
    }
    truth->advance_to(start + nearest_duration(to_s));
  }

  [[nodiscard]] target_tracking::Prediction prediction(double elapsed_s) const {
    const bool is_refined = elapsed_s >= settings.refined_after_s;
    const double part = is_refined ? settings.refined : 1.0;
    const orbit::RelativeState expected = orbit::relative_state_rtn(truth->state(0), truth->state(is_refined ? 3 : 2));
    const orbit::QnsElements chief = orbit::propagate_secular(servicer_mean, elapsed_s);
    const Matrix6 transition = orbit::roe_transition_j2(servicer_mean, elapsed_s);
    Matrix6 map;
    for (int k = 0; k < 6; ++k) map.col(k) = orbit::rtn_from_roe_linear(chief, transition.col(k));
    const Vector6 sigma = part * settings.sigma_a_roe_m / mission::kReferenceA;
    const Vector6 variance = sigma.cwiseProduct(sigma);
    Matrix6 covariance = map * variance.asDiagonal() * map.transpose();
    for (const SceneBurn& burn : settings.burns) {
      if (burn.time_s > elapsed_s) continue;
      const double since_s = elapsed_s - burn.time_s;
      const orbit::QnsElements then = orbit::propagate_secular(servicer_mean, burn.time_s);
      Matrix6 from_burn;
      const Matrix6 after = orbit::roe_transition_j2(then, since_s);
      for (int k = 0; k < 6; ++k) from_burn.col(k) = orbit::rtn_from_roe_linear(chief, after.col(k));
      const Matrix63 effect = from_burn * orbit::roe_control_matrix_near_circular(then);
      const double size = settings.burn_error * burn.dv_rtn.norm();
      covariance += size * size * effect * effect.transpose();
    }
    return must(target_tracking::prediction_of(expected, covariance));
  }

  void see(Scene& scene, const Matrix3& camera, const Vector3& direction_rtn, int source, double flux, int pixels) {
    const Vector3 in_camera = camera * direction_rtn;
    if (in_camera.z() < 0.9) return;
    const Vector2 offset(in_camera.x() / in_camera.z() / kPixel, in_camera.y() / in_camera.z() / kPixel);
    if (std::abs(offset.x()) > kHalfWidth_px || std::abs(offset.y()) > kHalfHeight_px) return;
    target_tracking::Candidate candidate;
    candidate.direction_rtn = direction_rtn;
    candidate.sigma = settings.noise_arcsec * kArcsec;
    candidate.object.centroid_px = kCentre_px + offset;
    candidate.object.flux_dn = flux;
    candidate.object.pixels = pixels;
    candidate.object.sharpness = pixels <= 2 ? 0.9 : 0.2;  // a hot pixel, or light
    scene.candidates.push_back(candidate);
    scene.source.push_back(source);
  }

  Vector3 blurred(const Vector3& direction) {
    const double sigma = settings.noise_arcsec * kArcsec;
    // Across the direction, which is near T.
    const Vector2 off = sigma * drawn_normals();
    return (direction + Vector3(off.x(), 0.0, off.y())).normalized();
  }

  SceneSettings settings;
  engine::RandomStream noise;
  std::unique_ptr<truth::TruthModel> truth;
  GpsTime start;
  orbit::QnsElements servicer_mean;
  Vector6 error_a_roe_m = Vector6::Zero();
  std::vector<Vector2> hot;
  int image = 0;
};

SceneMaker::SceneMaker(const SceneSettings& settings) : sky_(std::make_unique<Sky>(settings)) {}
SceneMaker::~SceneMaker() = default;
SceneMaker::SceneMaker(SceneMaker&&) noexcept = default;

Scene SceneMaker::next() {
  Sky& sky = *sky_;
  const SceneSettings& settings = sky.settings;
  Scene scene;
  sky.advance(scene);
  const double elapsed_s = settings.period_s * sky.image++;
  scene.time = sky.truth->time();
  scene.servicer = sky.truth->state(0);
  scene.prediction = sky.prediction(elapsed_s);
  scene.target = orbit::relative_state_rtn(scene.servicer, sky.truth->state(1));
  scene.detection_probability = settings.detection_probability;
  for (const SceneEclipse& eclipse : settings.eclipses) {
    if (elapsed_s >= eclipse.from_s && elapsed_s < eclipse.to_s) scene.detection_probability = 0.0;
  }

  Vector3 boresight(scene.prediction.slopes.x(), 1.0, scene.prediction.slopes.y());
  boresight *= scene.prediction.along_track_m < 0.0 ? -1.0 : 1.0;
  const double jitter = settings.jitter_arcsec * kArcsec;
  const Vector2 off = jitter * sky.drawn_normals();
  boresight = boresight.normalized() + Vector3(off.x(), 0.0, off.y());
  const Matrix3 camera = camera_rtn(boresight.normalized());

  // Sunlit satellites of one size, brighter the nearer, until the detector is saturated; tumbling, they vary.
  const std::size_t satellites = 1 + settings.decoys_a_roe_m.size();
  for (std::size_t k = 0; k < satellites; ++k) {
    const bool shows = sky.noise.uniform() < scene.detection_probability && (k > 0 || settings.has_target);
    const orbit::CartesianState state = sky.truth->state(k == 0 ? 1 : 3 + k);
    const Vector3 position = orbit::relative_state_rtn(scene.servicer, state).position_rtn;
    const double nearness = 75e3 / position.norm();
    const double flux = std::min(2e5 * nearness * nearness, 1e7) * std::exp(0.7 * sky.noise.normal());
    const Vector3 measured = sky.blurred(position.normalized());
    if (shows) sky.see(scene, camera, measured, static_cast<int>(k), flux, 16);
  }
  merge_blobs(scene);
  const int count = static_cast<int>(settings.false_detections + sky.noise.uniform());
  for (int k = 0; k < count; ++k) {
    const Vector2 place = sky.drawn_place();
    const Vector3 in_camera(place.x() * kPixel, place.y() * kPixel, 1.0);
    sky.see(scene, camera, camera.transpose() * in_camera.normalized(), -1, 1e3 * std::exp(2.0 * sky.noise.normal()),
            6);
  }
  for (const Vector2& place : sky.hot) {
    if (sky.noise.uniform() > 0.95) continue;
    const Vector2 offset = place - kCentre_px + 0.03 * sky.drawn_normals();
    const Vector3 in_camera(offset.x() * kPixel, offset.y() * kPixel, 1.0);
    sky.see(scene, camera, camera.transpose() * in_camera.normalized(), -2, 2000.0, 1);
  }
  return scene;
}

RunResult run_tracker(target_tracking::TargetTracker& tracker, SceneMaker& maker, int images) {
  RunResult result;
  for (int k = 0; k < images; ++k) {
    const Scene scene = maker.next();
    const target_tracking::TrackerOutput output = must(tracker.step(scene.input()));
    const int target = scene.target_index();
    if (target >= 0) ++result.target_seen;
    if (!output.confirmed) continue;
    ++result.confirmed;
    if (result.first_confirmed < 0) result.first_confirmed = k;
    if (output.candidate != target) ++result.wrong;
  }
  return result;
}

}  // namespace vbar::testing
