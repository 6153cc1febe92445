#pragma once
// An image through the optical testbed beside the digital twin's: the parts of the driver as its run puts them
// together, and what the flight software makes of both images.
//
// With VBAR_PICTURES set to a folder the last images are written there: testbed, twin and difference.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/imaging/self_check.h"
#include "hil_drivers/optical_stimulator/pictures/scene_pictures.h"
#include "host_sim/report/plots/png.h"
#include "tests/integration/angles_only/image_chain.h"
#include "tests/support/optical_bench.h"
#include "tests/support/paths.h"

namespace vbar::optical_stimulator {

using fsw::Vector3;
using twins::camera::CameraSettings;

/// The driver's parts as its run puts them together.
class Chain {
 public:
  Chain(StimulatorCalibration calibration, Screen& screen, FrameCamera& camera)
      : calibration_(std::move(calibration)),
        known_(calibrated_camera(calibration_, camera_)),
        screen_(screen),
        frames_(camera),
        light_(display_light(calibration_, camera_.exposure_s)),
        picture_(light_.width(), light_.height()) {
    place({});
  }

  SelfCheckFigures check() { return SelfCheck(calibration_, known_, *map_, light_).run(*exchange_); }
  void place(const DayCorrection& correction) {
    map_ = std::make_shared<const DisplayMap>(calibration_.geometry, correction);
    const auto region = region_with_strip(camera_.region);
    strip_.emplace(region, light_, camera_pixels(map_, camera_),
                   display_region({region.x, region.y, region.width, kStripRows}, camera_, *map_, light_.width(),
                                  light_.height(), 2),
                   12000.0);
    ExchangeSettings exchange;
    exchange.gain_dn_per_electron = known_.detector.gain_dn_per_electron;
    exchange.white_electrons = strip_->white_electrons();
    exchange_.emplace(exchange, *strip_, screen_, frames_);
    pictures_.emplace(calibration_, map_, light_, camera_,
                      [](const CameraSettings& settings, std::shared_ptr<const twins::camera::Projection> projection) {
                        return std::make_unique<twins::camera::SceneRenderer>(
                            settings, tests::source_path("data"), twins::camera::ObjectRenderer{},
                            twins::camera::ObjectCover{}, std::move(projection));
                      });
  }

  std::vector<std::uint16_t> image_of(const test::Scene& scene) {
    figures = pictures_->draw(scene.exposure, picture_);
    ExchangedImage image = exchange_->take(picture_);
    brightness = image.brightness;
    return std::move(image.dn);
  }

  /// A picture with nothing but the frame strip.
  ExchangedImage exchange_black() {
    Picture black(light_.width(), light_.height());
    return exchange_->take(black);
  }

  [[nodiscard]] const CameraSettings& known() const { return known_; }

  PictureFigures figures;
  double brightness = 0.0;

 private:
  CameraSettings camera_;
  StimulatorCalibration calibration_;
  CameraSettings known_;
  Screen& screen_;
  FrameCamera& frames_;
  DisplayLight light_;
  Picture picture_;
  std::shared_ptr<const DisplayMap> map_;
  std::optional<FrameStrip> strip_;
  std::optional<Exchange> exchange_;
  std::optional<ScenePictures> pictures_;
};

struct Seen {
  int stars = 0, objects = 0;
  double attitude_arcsec = 0.0;  ///< error of the boresight by the stars
  double bearing_arcsec = -1.0;  ///< error of the bearing; negative: none
  double background_dn = 0.0, noise_dn = 0.0;
};

inline Seen seen_by(const fsw::target_tracking::Sighting& sighting, const test::Scene& scene) {
  Seen seen;
  seen.stars = sighting.stars;
  seen.objects = sighting.objects;
  seen.background_dn = sighting.background_dn;
  seen.noise_dn = sighting.noise_dn;
  const Vector3 axis = sighting.R_camera_eci.transpose() * Vector3::UnitZ();
  const Vector3 truth = scene.R_camera_eci.transpose() * Vector3::UnitZ();
  seen.attitude_arcsec = axis.cross(truth).norm() / test::kArcsec;
  if (sighting.status == fsw::target_tracking::SightingStatus::kBearing)
    seen.bearing_arcsec = sighting.bearing.direction_eci.cross(scene.target_direction()).norm() / test::kArcsec;
  return seen;
}

inline void write_png(const std::vector<std::uint16_t>& dn, const std::string& name, const report::Stretch& stretch) {
  const char* const folder = std::getenv("VBAR_PICTURES");
  if (folder == nullptr) return;
  const auto png = report::png_of({500, 800, dn}, stretch);
  std::ofstream file(std::filesystem::path(folder) / name, std::ios::binary);
  for (const std::uint8_t byte : png) file.put(static_cast<char>(byte));
}

inline void write_pictures(const std::vector<std::uint16_t>& hil, const std::vector<std::uint16_t>& sil) {
  const report::Stretch stretch = report::stretch_for({500, 800, sil});
  write_png(hil, "hil.png", stretch);
  write_png(sil, "sil.png", stretch);
  std::vector<std::uint16_t> difference;
  for (std::size_t k = 0; k < hil.size(); ++k)
    difference.push_back(static_cast<std::uint16_t>(std::clamp(2048 + (hil[k] - sil[k]), 0, 4095)));
  write_png(difference, "difference.png", {1848.0, 2248.0, 1e-3});
}

/// The figures of a scene by testbed and twin.
struct Both {
  Seen hil, sil;
};

inline Both look(Chain& chain, test::ImageChain& hil, test::ImageChain& sil, const test::Scene& scene) {
  const std::vector<std::uint16_t> dn = chain.image_of(scene), twin = sil.image_of(scene);
  write_pictures(dn, twin);
  return {seen_by(hil.look_at(scene, dn), scene), seen_by(sil.look_at(scene, twin), scene)};
}

inline void print(const char* name, const Seen& seen) {
  std::printf(
      "%-8s %3d objects %3d stars, attitude %6.2f arcsec, bearing %6.2f arcsec, background %.1f noise %.2f DN\n", name,
      seen.objects, seen.stars, seen.attitude_arcsec, seen.bearing_arcsec, seen.background_dn, seen.noise_dn);
}

// Accepted: criteria of the testbed, 2 arcsec of the attitude and 5 of a bearing (three sigma of its noise here), at
// least nine of ten of the stars that the twin's image gives.
inline void expect_images_as_of_the_twin(Chain& chain) {
  test::ImageChain hil, sil;
  hil.configure(chain.known(), 0.06);
  test::SceneMaker scenes;
  int stars_hil = 0, stars_sil = 0, bearings = 0;
  double attitude = 0.0;
  constexpr int kImages = 10;  // the first confirm the target
  for (int k = 0; k < kImages; ++k) {
    const test::Scene scene = scenes.next(50e3);
    const Both seen = look(chain, hil, sil, scene);
    print("testbed", seen.hil);
    print("twin", seen.sil);
    std::printf("         strip %.4f, %d points, light not shown %.3f\n", chain.brightness, chain.figures.points,
                chain.figures.clipped_electrons / chain.figures.wanted_electrons);
    EXPECT_NEAR(chain.brightness, 1.0, 0.03);
    stars_hil += seen.hil.stars;
    stars_sil += seen.sil.stars;
    attitude += seen.hil.attitude_arcsec / kImages;
    if (seen.hil.bearing_arcsec >= 0.0) {
      ++bearings;
      EXPECT_LT(seen.hil.bearing_arcsec, 15.0);
    }
  }
  EXPECT_GE(stars_hil, 0.9 * stars_sil);
  EXPECT_LE(attitude, 2.0);
  EXPECT_GE(bearings, 4);
}

}  // namespace vbar::optical_stimulator
