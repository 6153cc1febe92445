#include "host_sim/twins/camera/model/target_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/earth_disc.h"
#include "host_sim/twins/camera/model/distant_body.h"
#include "host_sim/twins/camera/model/gl_objects.h"
#include "host_sim/twins/camera/model/target_shaders.h"

namespace vbar::twins::camera {

namespace {

constexpr int kEarthSteps = 512;
constexpr double kMinRoughness = 0.02;  // a mirror image of the Sun, half a degree wide, is no narrower

}  // namespace

std::array<float, 4> shader_material(const Material& m) {
  const double specular = m.grey_specular();
  const double roughness = std::clamp(std::sqrt(2.0 / (m.exponent + 2.0)), kMinRoughness, 1.0);
  return {static_cast<float>(m.grey_diffuse()), static_cast<float>(specular),
          static_cast<float>(std::min(1.0, 25.0 * specular)), static_cast<float>(roughness)};
}

std::vector<float> earth_table(double sine_earth) {
  std::vector<float> table(kEarthSteps);
  for (int i = 0; i < kEarthSteps; ++i)
    table[static_cast<std::size_t>(i)] =
        static_cast<float>(earth_light_factor(2.0 * i / (kEarthSteps - 1) - 1.0, sine_earth));
  return table;
}

namespace {

using fsw::Matrix3;
using fsw::Vector3;
using Matrix3f = Eigen::Matrix<float, 3, 3>;
using Matrix4f = Eigen::Matrix<float, 4, 4>;

constexpr double kPi = std::numbers::pi;
constexpr int kFinePicture = 256;    // texels on a side; finer ones have texels enough without several samples each
constexpr int kFinestShadow = 2048;  // texels on a side of the shadow map

// The picture's axes: z to the middle of the sphere, x and y near the camera's.
Matrix3 axes_towards(const Vector3& direction) {
  const Vector3 across = std::abs(direction.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 x = (across - across.dot(direction) * direction).normalized();
  Matrix3 R_picture_camera;
  R_picture_camera << x.transpose(), direction.cross(x).transpose(), direction.transpose();
  return R_picture_camera;
}

// Sizes of pictures: powers of two and one and a half times them, so that framebuffers are rarely reallocated.
int texels_for(double wanted) {
  int size = TargetRenderer::kMinTexels;
  while (size < wanted && size < TargetRenderer::kMaxTexels) size = size % 3 == 0 ? size / 3 * 4 : size / 2 * 3;
  return size;
}

// A shadow's edge need not be much finer than a texel of the picture.
int shadow_size_for(int texels) {
  if (texels > kFinePicture) return std::clamp(3 * texels / 2, 4 * kFinePicture, kFinestShadow);
  return std::max(4 * texels, 512);
}

std::vector<float> surface_of(std::span<const Face> faces) {
  std::vector<float> floats;
  const auto add = [&floats](const glsl::vec3& v) { floats.insert(floats.end(), {v.x, v.y, v.z}); };
  for (const Face& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      add(face.corners[k]);
      add(face.normals[k]);
      add(face.flat_normal);
      floats.push_back(static_cast<float>(face.material));
    }
  return floats;
}

/// Buffers by size, kept from image to image: two cameras with different lenses use them in turn.
template <class Buffer>
class SizedBuffers {
 public:
  /// With the current context. The reference is valid until the next call.
  template <class... Settings>
  Buffer& of_size(int size, const Settings&... settings) {
    const auto known = buffers_.find(size);
    if (known != buffers_.end()) return known->second;
    if (buffers_.size() == kMaxSizes) buffers_.clear();
    return buffers_.try_emplace(size, size, settings...).first->second;
  }
  void clear() { buffers_.clear(); }

 private:
  static constexpr std::size_t kMaxSizes = 3;
  std::map<int, Buffer> buffers_;
};

void check(const TargetView& view) {
  const double sum = view.position_camera.sum() + view.R_camera_body.sum() + view.sun_camera.sum() +
                     view.nadir_camera.sum() + view.sun_photons_per_m2_s + view.sunlit + view.earth_photons_per_m2_s +
                     view.earth_half_angle + view.texel_pitch;
  if (!std::isfinite(sum)) throw std::invalid_argument("a number of a view of the target is not finite");
}

}  // namespace

double earth_edge(const TargetView& view) {
  return std::clamp(view.earth_half_angle, 1e-3, 0.5 * kPi);
}

namespace {

/// What is drawn with OpenGL.
struct Pictures {
  explicit Pictures(std::span<const Face> faces) {
    const GlContext::Current current(context);
    shadow_program.emplace(kShadowVertexShader, kShadowFragmentShader);
    surface_program.emplace(
        kSurfaceVertexShader,
        std::string(kSurfaceFragmentInputs).append(kReflectionFunctions).append(kSurfaceFragmentMain));
    triangles.emplace(surface_of(faces), std::array{3, 3, 4});
    earth_light.emplace();
  }
  ~Pictures() {
    const GlContext::Current current(context);
    pictures.clear();
    shadow_maps.clear();
    earth_light.reset();
    triangles.reset();
    surface_program.reset();
    shadow_program.reset();
  }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  /// Draws a picture of `size` texels a side.
  void draw(const TargetView& view, const PictureGeometry& geometry, std::span<const std::array<float, 4>> materials,
            std::span<const float> earth_table, int size);
  void draw_shadow(const Matrix3& R_sun_body) const;
  void draw_surface(const TargetView& view, const PictureGeometry& geometry,
                    std::span<const std::array<float, 4>> materials);

  GlContext context;
  std::optional<GlProgram> shadow_program, surface_program;
  std::optional<GlTriangles> triangles;
  SizedBuffers<GlShadowMap> shadow_maps;
  SizedBuffers<GlPicture> pictures;
  GlShadowMap* shadow_map = nullptr;  // shadow map of this image
  GlPicture* picture = nullptr;
  std::optional<GlTable> earth_light;
  std::vector<float> texels;
};

void Pictures::draw_shadow(const Matrix3& R_sun_body) const {
  shadow_map->bind_and_clear();
  gl().glEnable(GL_DEPTH_TEST);
  shadow_program->use();
  const Matrix3f rotation = R_sun_body.cast<float>();
  gl().glUniformMatrix3fv(shadow_program->uniform("R_sun_body"), 1, GL_FALSE, rotation.data());
  triangles->draw();
}

void Pictures::draw_surface(const TargetView& view, const PictureGeometry& geometry,
                            std::span<const std::array<float, 4>> materials) {
  // From body axes in radii to clip space. Everything is relative to the distance of the middle, so single precision
  // is enough at any range; depth runs from -1 to 1 through the sphere.
  const double reach = geometry.reach;
  const Matrix3& R_sun_body = geometry.R_sun_body;
  const Matrix3 R_picture_body = geometry.R_picture_camera * view.R_camera_body;
  Eigen::Matrix<double, 4, 4> clip_from_body = Eigen::Matrix<double, 4, 4>::Zero();
  clip_from_body.topLeftCorner<2, 3>() = reach / geometry.tan_half * R_picture_body.topRows<2>();
  clip_from_body.block<1, 3>(2, 0) = R_picture_body.row(2);
  clip_from_body(2, 3) = reach;
  clip_from_body.block<1, 3>(3, 0) = reach * R_picture_body.row(2);
  clip_from_body(3, 3) = 1.0;
  const Matrix4f clip = clip_from_body.cast<float>();
  const Matrix3f sun_rotation = R_sun_body.cast<float>();
  const auto set_vector = [this](const char* name, const Vector3& v) {
    gl().glUniform3f(surface_program->uniform(name), static_cast<float>(v.x()), static_cast<float>(v.y()),
                     static_cast<float>(v.z()));
  };
  const auto set_number = [this](const char* name, double value) {
    gl().glUniform1f(surface_program->uniform(name), static_cast<float>(value));
  };
  picture->bind_and_clear();
  gl().glEnable(GL_DEPTH_TEST);
  surface_program->use();
  gl().glUniformMatrix4fv(surface_program->uniform("clip_from_body"), 1, GL_FALSE, clip.data());
  gl().glUniformMatrix3fv(surface_program->uniform("R_sun_body"), 1, GL_FALSE, sun_rotation.data());
  gl().glUniform4fv(surface_program->uniform("materials"), static_cast<GLsizei>(materials.size()), materials[0].data());
  gl().glUniform1i(surface_program->uniform("shadow_map"), 0);
  set_vector("camera", -view.R_camera_body.transpose() * geometry.centre_camera / geometry.radius_m);
  set_vector("sun", -R_sun_body.row(2).transpose());
  set_vector("nadir", view.R_camera_body.transpose() * view.nadir_camera.normalized());
  set_number("sun_irradiance", view.sunlit * view.sun_photons_per_m2_s / geometry.scale);
  set_number("earth_irradiance", view.earth_photons_per_m2_s / geometry.scale);
  const double sine_earth = std::sin(earth_edge(view));
  set_number("earth_edge", earth_edge(view));
  set_number("earth_radiance", 1.0 / (kPi * sine_earth * sine_earth));
  gl().glUniform1i(surface_program->uniform("shadow_reach"), picture->size() < shadow_map->size() ? 0 : 1);
  gl().glUniform1i(surface_program->uniform("earth_light"), 1);
  shadow_map->bind_texture();
  earth_light->bind_texture();
  triangles->draw();
}

void Pictures::draw(const TargetView& view, const PictureGeometry& geometry,
                    std::span<const std::array<float, 4>> materials, std::span<const float> earth_table, int size) {
  const GlContext::Current current(context);
  picture = &pictures.of_size(size, size > kFinePicture ? 1 : 4);
  shadow_map = &shadow_maps.of_size(shadow_size_for(size));
  earth_light->set(earth_table);
  draw_shadow(geometry.R_sun_body);
  draw_surface(view, geometry, materials);
  picture->read(texels);
}

}  // namespace

struct TargetRenderer::Drawing {
  explicit Drawing(const CadModel& model)
      : centre(model.centre), radius_m(model.radius_m), faces(faces_of(model)), distant(faces) {}

  Vector3 centre;
  double radius_m;
  std::vector<std::array<float, 4>> materials;
  std::vector<Face> faces;
  DistantBody distant;
  std::optional<Pictures> pictures;  // from the first picture on
  std::vector<float> earth_light;    // for the Earth's half-angle whose sine is:
  double earth_table_sine = -1.0;
  int texels = 0;
};

TargetRenderer::TargetRenderer(const CadModel& model) : drawing_(std::make_unique<Drawing>(model)) {
  GlContext::prepare();
  set_materials(model.materials);
}

TargetRenderer::~TargetRenderer() = default;

void TargetRenderer::set_materials(std::span<const Material> materials) {
  check_materials("materials of a target", {materials.begin(), materials.end()});
  if (!drawing_->materials.empty() && materials.size() != drawing_->materials.size())
    throw std::runtime_error("materials of a target: " + std::to_string(materials.size()) + " given, the model has " +
                             std::to_string(drawing_->materials.size()));
  drawing_->materials.clear();
  for (const Material& m : materials) drawing_->materials.push_back(shader_material(m));
}

int TargetRenderer::texels() const {
  return drawing_->texels;
}

void TargetRenderer::render(const TargetView& view, std::vector<LightSample>& out) {
  check(view);
  out.clear();
  Drawing& d = *drawing_;
  const Vector3 centre_camera = view.position_camera + view.R_camera_body * d.centre;
  const double distance = centre_camera.norm();
  if (distance < 1.01 * d.radius_m)
    throw std::invalid_argument("the camera is inside the sphere around the target, " + std::to_string(d.radius_m) +
                                " m in radius");
  const double scale = std::max(view.sunlit * view.sun_photons_per_m2_s, view.earth_photons_per_m2_s);
  if (scale <= 0.0) return;
  PictureGeometry geometry;
  geometry.centre_camera = centre_camera;
  geometry.radius_m = d.radius_m;
  geometry.reach = d.radius_m / distance;
  geometry.tan_half =
      1.002 * geometry.reach / std::sqrt(1.0 - geometry.reach * geometry.reach);  // a margin for single precision
  geometry.R_picture_camera = axes_towards(centre_camera / distance);
  geometry.R_sun_body = axes_towards(-view.sun_camera.normalized()) * view.R_camera_body;
  geometry.scale = scale;
  const double sine_earth = std::sin(earth_edge(view));
  if (sine_earth != d.earth_table_sine) {
    d.earth_light = earth_table(sine_earth);
    d.earth_table_sine = sine_earth;
  }
  const double wanted = view.texel_pitch > 0.0 ? 2.0 * geometry.tan_half / view.texel_pitch : 0.0;
  if (wanted <= DistantBody::kSamples) {
    d.texels = DistantBody::kTexels;
    d.distant.draw(view, geometry, d.materials, d.earth_light, out);
    return;
  }
  const int n = d.texels = texels_for(wanted);
  if (!d.pictures) d.pictures.emplace(d.faces);
  d.pictures->draw(view, geometry, d.materials, d.earth_light, n);

  // A texel's solid angle: its area on the plane at unit distance times the cube of the cosine of the angle to the
  // axis.
  const Matrix3 R_camera_picture = geometry.R_picture_camera.transpose();
  const double pitch = 2.0 * geometry.tan_half / n;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double radiance = static_cast<double>(
          d.pictures->texels[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)]);
      if (!(radiance > 0.0)) continue;
      const Vector3 at((i + 0.5) * pitch - geometry.tan_half, (j + 0.5) * pitch - geometry.tan_half, 1.0);
      const double length = at.norm();
      out.push_back({R_camera_picture * (at / length), scale * radiance * pitch * pitch / (length * length * length)});
    }
}

}  // namespace vbar::twins::camera
