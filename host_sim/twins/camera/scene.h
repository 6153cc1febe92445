#pragma once
// All that a camera sees, as expected photo-electrons: stars, spacecraft, Sun, Moon, Earth and stray light.

#include <filesystem>
#include <memory>
#include <vector>

#include "host_sim/twins/camera/earth_disc.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/object_view.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/photon_image.h"
#include "host_sim/twins/camera/point_spread.h"
#include "host_sim/twins/camera/star_sky.h"

namespace vbar::twins::camera {

/// Fraction of the light of Sun, Moon and Earth on the detector that lens and housing scatter uniformly over it
/// (veiling glare).
inline constexpr double kVeilingGlare = 1e-3;

/// Renders one image at a time.
///
/// - Stars, Sun and Moon move over the image by the rotation of the camera, objects by that and their own motion; the
///   limb of the Earth is fixed during an exposure, and is
///   not blurred by the lens.
/// - The Earth hides the background, and so does a spacecraft so near that a pixel subtends less than a centimetre of
///   it.
///   A star behind a farther one shines through it (a spacecraft at 1 km is 4 pixels wide, and a star in a thousand
///   images is behind it). Spacecraft do not hide each other.
/// - Sun and Earth on the detector outshine all other objects, as in a real camera, by kVeilingGlare.
class SceneRenderer {
 public:
  /// Reads the star catalogue of `data_directory`; throws std::runtime_error if it cannot be read. `objects` renders
  /// spacecraft; by default each is a Lambert sphere of 0.7 m and albedo 0.3. Without `covers` they hide nothing.
  /// `projection`: onto the image, whose size is that of the settings' detector; by default the lens of the settings.
  SceneRenderer(const CameraSettings& settings, const std::filesystem::path& data_directory,
                ObjectRenderer objects = {}, ObjectCover covers = {},
                std::shared_ptr<const Projection> projection = nullptr);

  /// Renders the expected photo-electrons of the region that is read, replacing `image`. No dark current, no noise.
  void render(const Exposure& exposure, PhotonImage& image);

 private:
  struct View;  // common quantities of an exposure

  [[nodiscard]] double electrons_of(const LightSample& light, const fsw::Vector2& pixel) const;
  void add_stars(const View& view, PhotonImage& image);
  [[nodiscard]] bool is_in_view(const View& view, const ObjectInView& object) const;
  [[nodiscard]] ObjectView view_of(const View& view, const ObjectInView& object) const;
  [[nodiscard]] bool hides(const View& view, const ObjectInView& object) const;
  void hide_behind(const View& view, const ObjectInView& object, PhotonImage& image);
  void add_object(const View& view, const ObjectInView& object, PhotonImage& image);
  double add_sun_and_moon(const View& view, PhotonImage& image);
  double add_disc(const View& view, const fsw::Vector3& velocity, PhotonImage& image);
  double add_earth(const View& view, PhotonImage& image);
  void add_background(const View& view, double scattered, PhotonImage& image);
  [[nodiscard]] double sun_in_sight(const View& view);

  CameraSettings settings_;
  double duration_s_ = 0.0;  ///< duration of the exposure being rendered
  std::shared_ptr<const Projection> projection_;
  PointSpread spread_;
  StarSky sky_;
  ObjectRenderer objects_;
  ObjectCover covers_;
  PixelDirections region_directions_;
  Cone region_cone_, detector_cone_;
  std::vector<ApparentStar> stars_;  // work space, as all below
  std::vector<LightSample> samples_;
  std::vector<ImagePoint> points_;
  std::vector<float> covered_;
};

}  // namespace vbar::twins::camera
