#include "emulators/tron/scene/lab_drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "emulators/tron/scene/facets.h"
#include "emulators/tron/scene/gl_targets.h"
#include "emulators/tron/scene/radiometry.h"
#include "emulators/tron/scene/shaders.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/twins/camera/model/gl_objects.h"
#include "host_sim/twins/camera/model/reflection.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/model/target_shaders.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/photometry.h"

namespace vbar::tron::bench {
namespace {

namespace camera = twins::camera;
using camera::GlProgram;
using camera::GlTriangles;
using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;

constexpr int kCanvas = 1024;  // texels on a side
constexpr int kShadowMap = 768;
constexpr int kBoardSamples = 2;  // texels a pixel, each way: corners of the board are measured
constexpr double kMockUpEdgeM = 0.02, kBoardEdgeM = 0.01;
constexpr double kShadowReachM = 2.0;  // along the light; what is farther is clamped to it
constexpr double kRectMarginPx = 24.0;
constexpr double kEarthHalfAngle = 1.12;  // seen from an altitude of 710 km
constexpr double kSunRadiusRad = 0.00465;
constexpr double kLensLimit2 = 0.8;  // squared tangent, 42 deg: far beyond the field

// Materials of what is not the mock-up; indices follow those of the mock-up's materials.
enum ExtraMaterial : std::size_t { kArm, kRod, kWhite, kBlack };

std::vector<std::array<float, 4>> extra_materials() {
  const calibrate::BoardDesign board;
  const auto material = [](double albedo, double reflectivity, double exponent) {
    camera::Material m;
    m.diffuse.fill(albedo);
    m.specular.fill(reflectivity);
    m.exponent = exponent;
    return camera::shader_material(m);
  };
  return {material(0.45, 0.04, 20.0), material(0.05, 0.04, 20.0), material(board.white_albedo, 0.0, 0.0),
          material(board.black_albedo, 0.0, 0.0)};
}

struct Sphere {
  Vector3 centre = Vector3::Zero();  // origin of the body frame, m
  double radius_m = 0.0;
};

Sphere sphere_of(const std::vector<Facet>& facets) {
  Vector3 low = facets.at(0).corners[0], high = low;
  for (const Facet& facet : facets)
    for (const Vector3& corner : facet.corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  Sphere sphere{0.5 * (low + high), 0.0};
  for (const Facet& facet : facets)
    for (const Vector3& corner : facet.corners)
      sphere.radius_m = std::max(sphere.radius_m, (corner - sphere.centre).norm());
  return sphere;
}

// A body that can hang on the arm.
struct Body {
  Body(const std::vector<Facet>& coarse, const std::vector<Facet>& fine)
      : sphere(sphere_of(coarse)),
        drawn(interleaved(fine, sphere.centre), kFacetWidths),
        casting(interleaved(coarse, sphere.centre), kFacetWidths) {}
  Sphere sphere;
  GlTriangles drawn, casting;
};

// Rows: two axes across, then along `axis`.
Matrix3 axes_along(const Vector3& axis) {
  const Vector3 x = (std::abs(axis.z()) < 0.9 ? Vector3::UnitZ() : Vector3::UnitX()).cross(axis).normalized();
  Matrix3 R;
  R << x.transpose(), axis.cross(x).transpose(), axis.transpose();
  return R;
}

// Points of the lamp's disc: equal areas, the golden angle apart.
Vector2 point_of_disc(int k) {
  const double radius = std::sqrt((k + 0.5) / ShadowMaps::kCount), turn = k * 2.399963229728653;
  return {radius * std::cos(turn), radius * std::sin(turn)};
}

// Places of a lattice of rank 1 in a texel, in texels.
Vector2 shift_of(int k) {
  return {(k + 0.5) / ShadowMaps::kCount - 0.5, (k * 3 % ShadowMaps::kCount + 0.5) / ShadowMaps::kCount - 0.5};
}

struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

// The pixels that the sphere covers, within `area`; all of it where the lens is undefined.
PixelRect rect_of(const camera::CameraSettings& settings, const Vector3& centre_C, double radius_m,
                  const camera::Region& area) {
  const PixelRect all{area.x, area.y, area.width, area.height};
  const camera::Optics optics(settings);
  const double distance = centre_C.norm(), sine = radius_m / distance, cosine = std::sqrt(1.0 - sine * sine);
  const Vector3 axis = centre_C / distance, u = axis.unitOrthogonal(), v = axis.cross(u);
  // The whole sphere is behind the camera's plane.
  if (centre_C.z() < -radius_m) return {area.x, area.y, 0, 0};
  Vector2 low = Vector2::Constant(1e9), high = -low;
  constexpr int kAround = 48;
  for (int k = 0; k < kAround; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / kAround;
    const auto pixel = optics.project(cosine * axis + sine * (std::cos(turn) * u + std::sin(turn) * v));
    if (!pixel) return all;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  const auto clipped = [](double place, int first, int length) {
    return static_cast<int>(
        std::clamp(std::floor(place), static_cast<double>(first), static_cast<double>(first + length)));
  };
  const int left = clipped(low.x() - kRectMarginPx, area.x, area.width);
  const int right = clipped(high.x() + kRectMarginPx, area.x, area.width);
  const int top = clipped(low.y() - kRectMarginPx, area.y, area.height);
  const int bottom = clipped(high.y() + kRectMarginPx, area.y, area.height);
  return {left, top, right - left, bottom - top};
}

// Uniforms of a program by name.
class Inputs {
 public:
  explicit Inputs(const GlProgram& program) : program_(program) { program.use(); }
  void set(const char* name, double v) const { gl().glUniform1f(program_.uniform(name), static_cast<float>(v)); }
  void set(const char* name, int v) const { gl().glUniform1i(program_.uniform(name), v); }
  void set(const char* name, double x, double y) const {
    gl().glUniform2f(program_.uniform(name), static_cast<float>(x), static_cast<float>(y));
  }
  void set(const char* name, const Vector3& v) const {
    gl().glUniform3f(program_.uniform(name), static_cast<float>(v.x()), static_cast<float>(v.y()),
                     static_cast<float>(v.z()));
  }
  void set(const char* name, double x, double y, double z, double w) const {
    gl().glUniform4f(program_.uniform(name), static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                     static_cast<float>(w));
  }
  void set(const char* name, const Matrix3& m) const {
    const Eigen::Matrix<float, 3, 3> narrow = m.cast<float>();
    gl().glUniformMatrix3fv(program_.uniform(name), 1, GL_FALSE, narrow.data());
  }
  void set_vectors(const char* name, int width, const std::vector<float>& numbers) const {
    const auto count = static_cast<GLsizei>(numbers.size()) / width;
    if (count == 0) return;
    if (width == 2) gl().glUniform2fv(program_.uniform(name), count, numbers.data());
    if (width == 3) gl().glUniform3fv(program_.uniform(name), count, numbers.data());
    if (width == 4) gl().glUniform4fv(program_.uniform(name), count, numbers.data());
    if (width == 9) gl().glUniformMatrix3fv(program_.uniform(name), count, GL_FALSE, numbers.data());
  }

 private:
  const GlProgram& program_;
};

void push(std::vector<float>& numbers, const Vector3& v) {
  for (int i = 0; i < 3; ++i) numbers.push_back(static_cast<float>(v[i]));
}

// All light and poses of a drawing, in S: origin in the middle of the target, axes of L.
struct Stage {
  Vector3 origin_L, centre_C;
  double radius_m = 0.0;
  Matrix3 R_S_B, R_C_S;
  Vector3 camera_S;
  LampBeam beam;
  std::array<BoxLight, kBoxes> boxes;
  std::array<double, 6> reflected{};
  Vector3 earth = Vector3::Zero();  // vector of irradiance; zero: boxes shine as they are
  std::array<Matrix3, ShadowMaps::kCount> R_shadow_S;
  double shadow_half_m = 1.0, inverse_lamp_distance = 0.0;
  double unit = 1.0;
};

}  // namespace

struct LabDrawing::Gl {
  Gl(const TestbedDesign& file, const GapSettings& switches, std::uint64_t number, const std::filesystem::path& data);
  ~Gl();
  Gl(const Gl&) = delete;
  Gl& operator=(const Gl&) = delete;

  [[nodiscard]] Stage stage_of(const LabView& view) const;
  void draw_shadows(const Stage& stage, const Body& body) const;
  void set_lens(const GlProgram& program, const Stage& stage, const camera::CameraSettings& settings,
                const PixelRect& rect) const;
  static void set_beam(const GlProgram& program, const Stage& stage);
  void set_lights(const Stage& stage) const;
  void draw_rect(const LabView& view, const Stage& stage, const Body* body, const PixelRect& rect,
                 const camera::Region& area, int texels, int pixels, Plane& plane);
  void draw_tile(const LabView& view, const Stage& stage, const Body* body, const PixelRect& tile, int texels,
                 int pixels);

  TestbedDesign bench;
  GapSettings gap;
  std::uint64_t seed;
  Room room;
  std::vector<std::array<float, 4>> materials;
  std::size_t first_extra = 0;
  double unit = 1.0;
  camera::GlContext context;
  std::optional<GlProgram> shadow_program, surface_program, room_program;
  std::optional<Body> mock_up, board;
  std::optional<GlTriangles> limbs, walls;  // surfaces of the drawing
  std::optional<Canvas> canvas;
  std::optional<ShadowMaps> shadows;
  std::optional<camera::GlTable> earth_light;
  std::vector<float> texels_read;
};

LabDrawing::Gl::Gl(const TestbedDesign& file, const GapSettings& switches, std::uint64_t number,
                   const std::filesystem::path& data)
    : bench(file), gap(switches), seed(number), room(file) {
  const std::string name = file.target.model + (gap.surfaces ? "_mockup" : "");
  const camera::CadModel model = camera::load_cad_model(mission::cad_source_of(data, name));
  for (const camera::Material& material : model.materials) materials.push_back(camera::shader_material(material));
  first_extra = materials.size();
  for (const auto& material : extra_materials()) materials.push_back(material);
  if (materials.size() > camera::kMaxMaterials)
    throw std::runtime_error(name + ": too many materials for the laboratory");
  std::vector<Facet> coarse = scaled_facets(model, file.scale);
  if (gap.shape) move_corners(coarse, seed);
  std::vector<Facet> fine = subdivided(coarse, kMockUpEdgeM);
  if (gap.surfaces) add_albedo_noise(fine, seed);

  const camera::GlContext::Current current(context);
  const std::string version = "#version 330 core\n", lens(kLensFunctions), beam(kBeamFunctions);
  shadow_program.emplace(kLabShadowVertexShader, camera::kShadowFragmentShader);
  surface_program.emplace(version + lens + std::string(kLabSurfaceVertexMain),
                          std::string(kLabSurfaceFragmentInputs) + beam + std::string(camera::kReflectionFunctions) +
                              std::string(kLabSurfaceFragmentMain));
  room_program.emplace(version + lens + std::string(kRoomVertexMain),
                       std::string(kRoomFragmentInputs) + beam + std::string(kRoomFragmentMain));
  mock_up.emplace(coarse, fine);
  const auto squares = board_facets({}, first_extra + kWhite, first_extra + kBlack, kBoardEdgeM);
  board.emplace(squares, squares);
  canvas.emplace(kCanvas);
  shadows.emplace(kShadowMap);
  earth_light.emplace();
  earth_light->set(camera::earth_table(std::sin(kEarthHalfAngle)));
}

LabDrawing::Gl::~Gl() {
  const camera::GlContext::Current current(context);
  earth_light.reset();
  shadows.reset();
  canvas.reset();
  walls.reset();
  limbs.reset();
  board.reset();
  mock_up.reset();
  room_program.reset();
  surface_program.reset();
  shadow_program.reset();
}

Stage LabDrawing::Gl::stage_of(const LabView& view) const {
  const Body& body = view.T_L_board ? *board : *mock_up;
  const Eigen::Isometry3d& T_L_B = view.T_L_board ? *view.T_L_board : view.T_L_T;
  Stage stage;
  stage.origin_L = T_L_B * body.sphere.centre;
  stage.radius_m = body.sphere.radius_m;
  stage.R_S_B = T_L_B.linear();
  stage.R_C_S = view.T_L_C.linear().transpose();
  stage.camera_S = view.T_L_C.translation() - stage.origin_L;
  stage.centre_C = -(stage.R_C_S * stage.camera_S);
  if (!(stage.centre_C.norm() > 1.01 * stage.radius_m))
    throw std::invalid_argument("a view of the laboratory: the camera is inside the sphere around the target, " +
                                std::to_string(stage.radius_m) + " m in radius");
  const double sun = camera::sun_photons(view.camera.zero_magnitude_photons, camera::kAstronomicalUnit);
  stage.unit = std::max(bench.lamp.irradiance_ratio * sun, 1e-300);
  stage.beam = lamp_beam(bench, gap, seed, view, sun);
  stage.boxes = box_lights(bench, view.box_powers, sun);
  if (gap.room) stage.reflected = room.reflected(stage.beam, stage.boxes, stage.origin_L);
  if (!gap.earth_light) stage.earth = light_vector(stage.boxes, stage.origin_L);

  const double nearness = stage.beam.inverse_distance;
  const Vector3 to_lamp = stage.beam.direction - nearness * (stage.origin_L - stage.beam.centre_m);
  stage.inverse_lamp_distance = nearness / to_lamp.norm();
  stage.shadow_half_m = 1.05 * stage.radius_m / (1.0 - stage.radius_m * stage.inverse_lamp_distance);
  const Matrix3 R = axes_along(-to_lamp.normalized());
  for (int k = 0; k < ShadowMaps::kCount; ++k) {
    const Vector2 tilt = stage.beam.source_radius_rad * point_of_disc(k);
    const Vector3 away = R.row(2) + tilt.x() * R.row(0) + tilt.y() * R.row(1);
    stage.R_shadow_S[static_cast<std::size_t>(k)] = axes_along(away.normalized());
  }
  return stage;
}

void LabDrawing::Gl::draw_shadows(const Stage& stage, const Body& body) const {
  shadows->bind_and_clear();
  gl().glEnable(GL_DEPTH_TEST);
  gl().glEnable(GL_DEPTH_CLAMP);
  const Inputs inputs(*shadow_program);
  inputs.set("shadow_view", 1.0 / stage.shadow_half_m, 1.0 / kShadowReachM, stage.inverse_lamp_distance, 0.0);
  for (int k = 0; k < ShadowMaps::kCount; ++k) {
    const Matrix3& R_shadow_S = stage.R_shadow_S[static_cast<std::size_t>(k)];
    const Vector2 shift = 2.0 / kShadowMap * shift_of(k);
    shadows->draw_into(k);
    inputs.set("shadow_shift", shift.x(), shift.y());
    inputs.set("R_shadow_S", Matrix3(R_shadow_S * stage.R_S_B));
    body.casting.draw();
    if (!limbs) continue;
    inputs.set("R_shadow_S", R_shadow_S);
    limbs->draw();
  }
  gl().glDisable(GL_DEPTH_CLAMP);
}

void LabDrawing::Gl::set_lens(const GlProgram& program, const Stage& stage, const camera::CameraSettings& settings,
                              const PixelRect& rect) const {
  const Inputs inputs(program);
  const auto& [k1, k2, p1, p2, k3] = settings.optics.distortion;
  inputs.set("R_C_S", stage.R_C_S);
  inputs.set("origin_C", stage.centre_C);
  inputs.set("lens_k", k1, k2, k3, kLensLimit2);
  inputs.set("lens_p", p1, p2);
  inputs.set("focal_px", settings.focal_length_px());
  inputs.set("centre_px", settings.optics.principal_point_px[0] - rect.x + 0.5,
             settings.optics.principal_point_px[1] - rect.y + 0.5);
  inputs.set("size_px", static_cast<double>(rect.width), static_cast<double>(rect.height));
}

void LabDrawing::Gl::set_beam(const GlProgram& program, const Stage& stage) {
  const Inputs inputs(program);
  inputs.set("beam_centre", Vector3(stage.beam.centre_m - stage.origin_L));
  inputs.set("beam_direction", stage.beam.direction);
  inputs.set("beam_across", stage.beam.across);
  inputs.set("beam_up", stage.beam.up);
  inputs.set("beam_shape", stage.beam.inverse_distance, stage.beam.radius_m, kBeamEdgeM,
             stage.beam.irradiance / stage.unit);
  inputs.set("beam_uneven", Vector3(stage.beam.uneven[0], stage.beam.uneven[1], stage.beam.uneven[2]));
}

void LabDrawing::Gl::set_lights(const Stage& stage) const {
  const Inputs inputs(*surface_program);
  inputs.set("camera", stage.camera_S);
  const double lamp_excess = std::max(0.0, stage.beam.source_radius_rad - kSunRadiusRad);
  inputs.set("lamp_roughness", 0.5 * lamp_excess);
  inputs.set("shadow_view", 1.0 / stage.shadow_half_m, 1.0 / kShadowReachM, stage.inverse_lamp_distance, 0.0);
  inputs.set("shadow_half", stage.shadow_half_m);
  inputs.set("shadow_maps", 0);
  inputs.set("earth_light", 1);
  std::vector<float> rotations, shifts, all_materials;
  for (int k = 0; k < ShadowMaps::kCount; ++k) {
    const Eigen::Matrix<float, 3, 3> R = stage.R_shadow_S[static_cast<std::size_t>(k)].cast<float>();
    rotations.insert(rotations.end(), R.data(), R.data() + 9);
    const Vector2 shift = 2.0 / kShadowMap * shift_of(k);
    shifts.push_back(static_cast<float>(shift.x()));
    shifts.push_back(static_cast<float>(shift.y()));
  }
  for (const auto& material : materials) all_materials.insert(all_materials.end(), material.begin(), material.end());
  inputs.set_vectors("R_shadow_S", 9, rotations);
  inputs.set_vectors("shadow_shift", 2, shifts);
  inputs.set_vectors("materials", 4, all_materials);
  const std::array<double, 6>& r = stage.reflected;
  inputs.set("reflected_high", Vector3(Vector3(r[0], r[2], r[4]) / stage.unit));
  inputs.set("reflected_low", Vector3(Vector3(r[1], r[3], r[5]) / stage.unit));

  std::vector<float> places, normals, box_places, box_normals, box_across;
  if (gap.earth_light)
    for (const BoxLight& box : stage.boxes) {
      if (!(box.radiance > 0.0)) continue;
      for (const Emitter& emitter : emitters_of(box)) {
        push(places, emitter.place_m - stage.origin_L);
        places.push_back(static_cast<float>(emitter.radiance_area / stage.unit));
        push(normals, emitter.normal);
      }
      push(box_places, box.centre_m - stage.origin_L);
      box_places.push_back(static_cast<float>(box.radiance / stage.unit));
      push(box_normals, box.normal);
      push(box_across, box.across);
    }
  inputs.set_vectors("emitter_place", 4, places);
  inputs.set_vectors("emitter_normal", 3, normals);
  inputs.set("emitters", static_cast<int>(places.size() / 4));
  inputs.set_vectors("box_place", 4, box_places);
  inputs.set_vectors("box_normal", 3, box_normals);
  inputs.set_vectors("box_across", 3, box_across);
  inputs.set("boxes", static_cast<int>(box_places.size() / 4));
  inputs.set("box_half", stage.boxes[0].half_side_m);
  const double earth = stage.earth.norm();
  inputs.set("earth_irradiance", earth / stage.unit);
  inputs.set("nadir", earth > 0.0 ? Vector3(stage.earth / earth) : Vector3(Vector3::UnitZ()));
  const double sine = std::sin(kEarthHalfAngle);
  inputs.set("earth_disc", kEarthHalfAngle, 1.0 / (std::numbers::pi * sine * sine));
}

// `texels` of the canvas for `pixels` of the detector.
void LabDrawing::Gl::draw_tile(const LabView& view, const Stage& stage, const Body* body, const PixelRect& tile,
                               int texels, int pixels) {
  const int width = tile.width * texels / pixels, height = tile.height * texels / pixels;
  canvas->bind_and_clear(width, height);
  gl().glEnable(GL_DEPTH_TEST);
  if (walls) {
    set_lens(*room_program, stage, view.camera, tile);
    walls->draw();
  }
  set_lens(*surface_program, stage, view.camera, tile);
  const Inputs inputs(*surface_program);
  shadows->bind_texture();
  earth_light->bind_texture();
  if (limbs) {
    inputs.set("R_S_B", Matrix3(Matrix3::Identity()));
    limbs->draw();
  }
  if (body != nullptr) {
    inputs.set("R_S_B", stage.R_S_B);
    body->drawn.draw();
  }
  canvas->read(width, height, texels_read);
}

void LabDrawing::Gl::draw_rect(const LabView& view, const Stage& stage, const Body* body, const PixelRect& rect,
                               const camera::Region& area, int texels, int pixels, Plane& plane) {
  const int step = kCanvas * pixels / texels;
  for (int y = 0; y < rect.height; y += step)
    for (int x = 0; x < rect.width; x += step) {
      const PixelRect tile{rect.x + x, rect.y + y, std::min(step, rect.width - x), std::min(step, rect.height - y)};
      draw_tile(view, stage, body, tile, texels, pixels);
      const int across = tile.width * texels / pixels, down = tile.height * texels / pixels;
      // Into a plane of the same raster, or the mean of texels into one of pixels.
      const int mean = std::max(texels / pixels, 1), offset = pixels > 1 ? pixels : 1;
      const int left = (tile.x - area.x) / offset, top = (tile.y - area.y) / offset;
      for (int j = 0; j < down; j += mean)
        for (int i = 0; i < across; i += mean) {
          float sum = 0.0F;
          for (int v = 0; v < mean; ++v)
            for (int u = 0; u < mean; ++u)
              sum += texels_read[static_cast<std::size_t>(j + v) * static_cast<std::size_t>(across) +
                                 static_cast<std::size_t>(i + u)];
          plane.values[static_cast<std::size_t>(top + j / mean) * static_cast<std::size_t>(plane.width) +
                       static_cast<std::size_t>(left + i / mean)] = sum / static_cast<float>(mean * mean);
        }
    }
}

LabDrawing::LabDrawing(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed,
                       const std::filesystem::path& data_directory)
    : gl_(std::make_unique<Gl>(bench, gap, seed, data_directory)) {}

LabDrawing::~LabDrawing() = default;

double LabDrawing::unit() const {
  return gl_->unit;
}

double LabDrawing::draw(const LabView& view, const camera::Region& area, Plane& plane) {
  Gl& gl = *gl_;
  const Stage stage = gl.stage_of(view);
  const Body& body = view.T_L_board ? *gl.board : *gl.mock_up;
  gl.unit = stage.unit;
  plane.width = area.width;
  plane.height = area.height;
  plane.values.assign(static_cast<std::size_t>(area.width) * static_cast<std::size_t>(area.height), 0.0F);

  const camera::GlContext::Current current(gl.context);
  gl.limbs.reset();
  gl.walls.reset();
  if (gl.gap.room) {
    std::vector<Facet> facets;
    const std::vector<Limb> limbs = limbs_in_view(gl.bench, view);
    for (std::size_t i = 0; i < limbs.size(); ++i)
      add_limb(limbs[i], gl.first_extra + (i + 2 < limbs.size() ? kArm : kRod), facets);
    gl.limbs.emplace(interleaved(facets, stage.origin_L), kFacetWidths);
    gl.walls.emplace(gl.room.corners(stage.boxes, stage.origin_L, stage.unit), Room::kWidths);
    Gl::set_beam(*gl.room_program, stage);
  }
  Gl::set_beam(*gl.surface_program, stage);
  gl.set_lights(stage);
  gl.draw_shadows(stage, body);
  if (gl.gap.room) {
    Plane coarse;
    coarse.width = area.width / kCoarseStep;
    coarse.height = area.height / kCoarseStep;
    coarse.values.resize(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
    gl.draw_rect(view, stage, nullptr, {area.x, area.y, area.width, area.height}, area, 1, kCoarseStep, coarse);
    mix_coarse(coarse, 0.0F, 1.0F, plane);
  }
  const PixelRect rect = rect_of(view.camera, stage.centre_C, stage.radius_m, area);
  gl.draw_rect(view, stage, &body, rect, area, view.T_L_board ? kBoardSamples : 1, 1, plane);
  return stage.centre_C.norm();
}

}  // namespace vbar::tron::bench
