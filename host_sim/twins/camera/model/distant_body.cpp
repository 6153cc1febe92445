#include "host_sim/twins/camera/model/distant_body.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <tuple>

#include "host_sim/engine/wide_loops.h"

namespace vbar::twins::camera {

namespace {

using fsw::Matrix3;
using fsw::Vector3;
using glsl::vec2;
using glsl::vec3;
using glsl::vec4;

std::array<vec3, 3> rows_of(const Matrix3& R) {
  return {single(R.row(0)), single(R.row(1)), single(R.row(2))};
}

using Triple = std::array<vec3, 3>;

vec3 weighted(const Triple& of, vec3 weights) {
  return weights.x * of[0] + weights.y * of[1] + weights.z * of[2];
}

vec3 cross(vec3 a, vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The corner opposite to the longest side, and the square of that side.
struct Apex {
  std::size_t corner = 0;
  float square = 0.0F;
};

Apex apex_of(const Triple& corners) {
  Apex apex;
  for (std::size_t k = 0; k < 3; ++k) {
    const vec3 side = corners[(k + 2) % 3] - corners[(k + 1) % 3];
    if (dot(side, side) > apex.square) apex = {k, dot(side, side)};
  }
  return apex;
}

/// Halves of a triangle, or of other numbers of its corners.
std::array<Triple, 2> halves(const Triple& corners, std::size_t apex) {
  const vec3 a = corners[apex], b = corners[(apex + 1) % 3], c = corners[(apex + 2) % 3];
  const vec3 middle = 0.5F * (b + c);
  return {Triple{a, b, middle}, Triple{a, middle, c}};
}

/// Faces that no earlier one has the corners of, which is the one that is seen.
std::vector<std::uint32_t> different(std::span<const Face> faces) {
  const auto less = [](const vec3& a, const vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  const auto faces_less = [less](const Triple& a, const Triple& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  };
  std::set<Triple, decltype(faces_less)> known(faces_less);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    Triple corners = faces[i].corners;
    std::sort(corners.begin(), corners.end(), less);
    if (known.insert(corners).second) kept.push_back(i);
  }
  return kept;
}

}  // namespace

/// Directions in the body frame, as the shaders have them.
struct DistantBody::Light {
  vec3 camera{};  // place
  vec3 sun{}, nadir{};
  float sun_irradiance = 0.0F, earth_irradiance = 0.0F, earth_radiance = 0.0F;
  std::vector<vec4> materials;
  std::vector<vec2> mirror_edges;  // of each material
  std::span<const float> earth_table;
};

/// Pieces that are illuminated together.
struct DistantBody::Block {
  static constexpr std::size_t kCount = 128;
  using Numbers = std::array<float, kCount>;

  std::size_t count = 0;
  Numbers x{}, y{};                                      // in the camera's map
  Numbers visible{}, sunlit{};                           // areas that the camera sees, and sees in sunlight
  Numbers px{}, py{}, pz{};                              // places
  Numbers nx{}, ny{}, nz{}, fx{}, fy{}, fz{};            // normals of the smooth surface and of the face
  Numbers albedo{}, reflectivity{}, grazing{}, rough{};  // material
  Numbers edge_low{}, edge_high{};
  Numbers from_sun{}, from_earth{};  // photons/(m^2 s) over the scale, at the camera
};

DistantBody::DistantBody(std::span<const Face> faces)
    : faces_(faces),
      seen_by_camera_(kTexels),
      seen_by_sun_(kSunTexels),
      squares_(static_cast<std::size_t>(kSamples) * static_cast<std::size_t>(kSamples)) {
  const std::vector<std::uint32_t> kept = different(faces);
  for (float longest = kPiece; pieces_.empty(); longest *= 1.4F) {
    const bool is_last = longest > 1.0F;
    for (const std::uint32_t face : kept) {
      if (!is_last && pieces_.size() > kManyPieces) break;
      cut(face, {vec3{1.0F, 0.0F, 0.0F}, vec3{0.0F, 1.0F, 0.0F}, vec3{0.0F, 0.0F, 1.0F}}, longest);
    }
    if (!is_last && pieces_.size() > kManyPieces) pieces_.clear();
  }
  pieces_.shrink_to_fit();
}

/// Cuts a part of a face, its corners given by the weights of the face's corners, until no side is longer than
/// `longest` and no normals differ by more than kBend.
void DistantBody::cut(std::uint32_t face, const Triple& weights, float longest) {
  const Face& whole = faces_[face];
  Triple corners, normals;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = weighted(whole.corners, weights[k]);
    normals[k] = weighted(whole.normals, weights[k]);
  }
  const Apex apex = apex_of(corners), bend = apex_of(normals);
  const float length = apex.square / (longest * longest), curvature = bend.square / (kBend * kBend);
  if (std::max(length, curvature) > 1.0F) {
    for (const Triple& half : halves(weights, length > curvature ? apex.corner : bend.corner)) cut(face, half, longest);
    return;
  }
  const vec3 middle = 1.0F / 3.0F * (weights[0] + weights[1] + weights[2]);
  const vec3 across = cross(corners[1] - corners[0], corners[2] - corners[0]);
  Piece& piece = pieces_.emplace_back();
  piece.place = weighted(whole.corners, middle);
  piece.normal = weighted(whole.normals, middle);
  piece.area = 0.5F * glsl::sqrt(dot(across, across));
  piece.face = face;
  vec3* next = piece.points.data();
  spread(corners, kHalvings, next);
}

/// Places one point in each part of a triangle that is halved so often. It differs from part to part, evenly by the
/// additive recurrence of Roberts (2018): points in rows along a shadow's edge would all go dark at once.
void DistantBody::spread(const Triple& corners, int halvings, vec3*& next) {
  if (halvings > 0) {
    for (const Triple& half : halves(corners, apex_of(corners).corner)) spread(half, halvings - 1, next);
    return;
  }
  const auto part = [this](double step) {
    return static_cast<float>(std::fmod(0.5 + step * static_cast<double>(points_), 1.0));
  };
  float first = part(0.7548776662466927), second = part(0.5698402909980532);
  if (first + second > 1.0F) {
    first = 1.0F - first;
    second = 1.0F - second;
  }
  ++points_;
  *next++ = weighted(corners, {first, second, 1.0F - first - second});
}

DistantBody::Light DistantBody::light_of(const TargetView& view, const PictureGeometry& geometry,
                                         std::span<const std::array<float, 4>> materials,
                                         std::span<const float> earth_table) const {
  const Matrix3 R_body_camera = view.R_camera_body.transpose();
  Light light;
  light.camera = single(-R_body_camera * geometry.centre_camera / geometry.radius_m);
  light.sun = single(-geometry.R_sun_body.row(2));
  light.nadir = single(R_body_camera * view.nadir_camera.normalized());
  light.sun_irradiance = static_cast<float>(view.sunlit * view.sun_photons_per_m2_s / geometry.scale);
  light.earth_irradiance = static_cast<float>(view.earth_photons_per_m2_s / geometry.scale);
  const double edge = earth_edge(view), sine = std::sin(edge);
  light.earth_radiance = static_cast<float>(1.0 / (std::numbers::pi * sine * sine));
  for (const std::array<float, 4>& m : materials) {
    light.materials.push_back({m[0], m[1], m[2], m[3]});
    const double blur = 1.5 * static_cast<double>(m[3]);
    light.mirror_edges.push_back({static_cast<float>(std::cos(std::min(edge + blur, std::numbers::pi))),
                                  static_cast<float>(std::cos(std::max(edge - blur, 0.0)))});
  }
  light.earth_table = earth_table;
  return light;
}

void DistantBody::take(const Light& light, const Piece& piece, Block& block) const {
  const FaceMap::Extent to_camera = seen_by_camera_.extent(piece.face);
  if (to_camera == FaceMap::Extent::kNone) return;
  const Face& face = faces_[piece.face];
  const float side = dot(face.flat_normal, light.camera - piece.place);
  const bool faces_sun = light.sun_irradiance > 0.0F && side * dot(face.flat_normal, light.sun) > 0.0F;
  const FaceMap::Extent to_sun = faces_sun ? seen_by_sun_.extent(piece.face) : FaceMap::Extent::kNone;
  float visible = 1.0F, sunlit = to_sun == FaceMap::Extent::kNone ? 0.0F : 1.0F;
  if (to_camera == FaceMap::Extent::kSome || to_sun == FaceMap::Extent::kSome) {
    visible = 0.0F;
    sunlit = 0.0F;
    const auto add_points = [&](std::size_t first) {
      for (std::size_t k = first; k < piece.points.size(); k += 2) {
        const vec3& point = piece.points[k];
        const float here = to_camera == FaceMap::Extent::kAll ? 1.0F : seen_by_camera_.visible(piece.face, point);
        visible += here;
        if (here > 0.0F && to_sun != FaceMap::Extent::kNone)
          sunlit += here * (to_sun == FaceMap::Extent::kAll ? 1.0F : seen_by_sun_.visible(piece.face, point));
      }
    };
    // Every other point shows whether the edge of a part or of a shadow crosses the piece.
    auto count = static_cast<float>(piece.points.size() / 2);
    add_points(0);
    if ((visible > 0.0F && visible < count) || (sunlit > 0.0F && sunlit < count)) {
      add_points(1);
      count *= 2.0F;
    }
    if (!(visible > 0.0F)) return;
    visible /= count;
    sunlit /= count;
  }
  const FaceMap::Place place = seen_by_camera_.place_of(piece.place);
  const std::size_t k = block.count++;
  block.x[k] = place.x;
  block.y[k] = place.y;
  block.visible[k] = visible * piece.area;
  block.sunlit[k] = sunlit * piece.area;
  block.px[k] = piece.place.x;
  block.py[k] = piece.place.y;
  block.pz[k] = piece.place.z;
  block.nx[k] = piece.normal.x;
  block.ny[k] = piece.normal.y;
  block.nz[k] = piece.normal.z;
  block.fx[k] = face.flat_normal.x;
  block.fy[k] = face.flat_normal.y;
  block.fz[k] = face.flat_normal.z;
  const vec4& material = light.materials[face.material];
  block.albedo[k] = material.x;
  block.reflectivity[k] = material.y;
  block.grazing[k] = material.z;
  block.rough[k] = material.w;
  block.edge_low[k] = light.mirror_edges[face.material].x;
  block.edge_high[k] = light.mirror_edges[face.material].y;
}

VBAR_WIDE_LOOPS void DistantBody::reflect_light(const Light& light, Block& block) {
  const vec3 camera = light.camera, sun = light.sun, nadir = light.nadir;
  const float sun_irradiance = light.sun_irradiance, earth_irradiance = light.earth_irradiance;
  const float earth_radiance = light.earth_radiance;
  const bool has_earth = earth_irradiance > 0.0F && !light.earth_table.empty();
  const float* const table = light.earth_table.data();
  const auto last = static_cast<float>(light.earth_table.size()) - 1.0F;
  for (std::size_t k = 0; k < Block::kCount; ++k) {
    const vec3 to_camera = camera - vec3{block.px[k], block.py[k], block.pz[k]};
    const float square = dot(to_camera, to_camera);
    const vec3 v = (1.0F / glsl::sqrt(square)) * to_camera;
    const float fx = block.fx[k], fy = block.fy[k], fz = block.fz[k];
    const float facing = dot(vec3{fx, fy, fz}, v);
    const float side = facing < 0.0F ? -1.0F : 1.0F;  // thin sheets are seen from both sides
    const vec3 flat = {side * fx, side * fy, side * fz};
    const vec3 smooth = normalize(vec3{block.nx[k], block.ny[k], block.nz[k]});
    const float agrees = dot(smooth, flat) < 0.0F ? -1.0F : 1.0F;
    const vec3 n = agrees * smooth;
    const vec4 m = {block.albedo[k], block.reflectivity[k], block.grazing[k], block.rough[k]};
    const float across = side * facing / square;
    const float of_sun = across * block.sunlit[k] * sun_irradiance * reflected(n, sun, v, m);
    block.visible[k] *= across;
    block.from_sun[k] = block.sunlit[k] > 0.0F ? of_sun : 0.0F;
    block.nx[k] = n.x;
    block.ny[k] = n.y;
    block.nz[k] = n.z;
  }
  block.from_earth.fill(0.0F);
  if (!has_earth) return;
  for (std::size_t k = 0; k < Block::kCount; ++k) {
    const vec3 v = normalize(camera - vec3{block.px[k], block.py[k], block.pz[k]});
    const vec3 n = {block.nx[k], block.ny[k], block.nz[k]};
    const vec4 m = {block.albedo[k], block.reflectivity[k], block.grazing[k], block.rough[k]};
    const float place = glsl::clamp(last * (0.5F + 0.5F * dot(n, nadir)), 0.0F, last);
    const int left = static_cast<int>(place);
    const int right = left + (static_cast<float>(left) < last ? 1 : 0);
    const float part = place - static_cast<float>(left);
    const float scattered = (1.0F - part) * table[left] + part * table[right];
    block.from_earth[k] =
        block.visible[k] * earth_irradiance *
        earthshine(n, v, m, vec2{block.edge_low[k], block.edge_high[k]}, nadir, scattered, earth_radiance);
  }
}

void DistantBody::add(const Block& block) {
  constexpr float kSquare = static_cast<float>(kTexels) / kSamples;
  const auto square_at = [](float along) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>((along + 0.5F * kTexels) / kSquare), 0, kSamples - 1));
  };
  for (std::size_t k = 0; k < block.count; ++k) {
    const float photons = block.from_sun[k] + block.from_earth[k];
    if (!(photons > 0.0F)) continue;
    Square& square = squares_[square_at(block.y[k]) * kSamples + square_at(block.x[k])];
    const auto light_here = static_cast<double>(photons);
    square.light += light_here;
    square.x += light_here * static_cast<double>(block.x[k]);
    square.y += light_here * static_cast<double>(block.y[k]);
  }
}

void DistantBody::give_samples(const PictureGeometry& geometry, std::vector<LightSample>& out) const {
  const Matrix3 R_camera_picture = geometry.R_picture_camera.transpose();
  const double pitch = 2.0 * geometry.tan_half / kTexels;
  for (const Square& square : squares_) {
    if (!(square.light > 0.0)) continue;
    const Vector3 at(pitch * square.x / square.light, pitch * square.y / square.light, 1.0);
    out.push_back({R_camera_picture * at.normalized(), geometry.scale * square.light});
  }
}

void DistantBody::draw(const TargetView& view, const PictureGeometry& geometry,
                       std::span<const std::array<float, 4>> materials, std::span<const float> earth_table,
                       std::vector<LightSample>& out) {
  const Light light = light_of(view, geometry, materials, earth_table);
  seen_by_camera_.draw(faces_,
                       {rows_of(geometry.R_picture_camera * view.R_camera_body), static_cast<float>(geometry.reach),
                        static_cast<float>(geometry.tan_half / geometry.reach)});
  if (light.sun_irradiance > 0.0F) seen_by_sun_.draw(faces_, {rows_of(geometry.R_sun_body), 0.0F, 1.0F});
  std::fill(squares_.begin(), squares_.end(), Square{});
  Block block;
  const auto finish = [&] {
    reflect_light(light, block);
    add(block);
    block.count = 0;
  };
  for (const Piece& piece : pieces_) {
    take(light, piece, block);
    if (block.count == Block::kCount) finish();
  }
  finish();
  give_samples(geometry, out);
}

}  // namespace vbar::twins::camera
