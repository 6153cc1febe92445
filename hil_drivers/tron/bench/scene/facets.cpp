#include "hil_drivers/tron/bench/scene/facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;

constexpr double kShapeGrainM = 0.075;  // parts nearer to each other than this move together
constexpr double kPlateBehindM = 0.2e-3;

// A corner of a facet while it is divided.
struct Corner {
  Vector3 place, normal;
  double albedo;
};

Corner middle(const Corner& a, const Corner& b) {
  const Vector3 normal = a.normal + b.normal;
  return {0.5 * (a.place + b.place), normal.norm() > 0.0 ? Vector3(normal.normalized()) : Vector3(Vector3::Zero()),
          0.5 * (a.albedo + b.albedo)};
}

void divide(const Corner& a, const Corner& b, const Corner& c, std::size_t material, double longest_m,
            std::vector<Facet>& out) {
  const auto is_long = [longest_m](const Corner& p, const Corner& q) { return (p.place - q.place).norm() > longest_m; };
  const bool ab = is_long(a, b), bc = is_long(b, c), ca = is_long(c, a);
  const auto again = [&](const Corner& p, const Corner& q, const Corner& r) {
    divide(p, q, r, material, longest_m, out);
  };
  const int count = (ab ? 1 : 0) + (bc ? 1 : 0) + (ca ? 1 : 0);
  if (count == 0) {
    out.push_back(
        {{a.place, b.place, c.place}, {a.normal, b.normal, c.normal}, {a.albedo, b.albedo, c.albedo}, material});
    return;
  }
  if (count == 3) {
    const Corner p = middle(a, b), q = middle(b, c), r = middle(c, a);
    again(a, p, r);
    again(p, b, q);
    again(r, q, c);
    again(p, q, r);
    return;
  }
  // Rotate so that ab is long, and with two long ones ca is short.
  if (!ab || (count == 2 && ca)) return again(b, c, a);
  const Corner p = middle(a, b);
  if (count == 1) {
    again(a, p, c);
    again(p, b, c);
    return;
  }
  const Corner q = middle(b, c);
  again(p, b, q);
  again(a, p, q);
  again(a, q, c);
}

void add_quad(const std::array<Vector3, 4>& corners, std::size_t material, std::vector<Facet>& facets) {
  const Vector3 none = Vector3::Zero();
  facets.push_back({{corners[0], corners[1], corners[2]}, {none, none, none}, {1, 1, 1}, material});
  facets.push_back({{corners[0], corners[2], corners[3]}, {none, none, none}, {1, 1, 1}, material});
}

std::uint64_t mixed(std::uint64_t x) {  // the finaliser of splitmix64 (Steele, Lea, Flood 2014)
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace

double hashed(std::int64_t i, std::int64_t j, std::int64_t k, std::uint64_t seed) {
  std::uint64_t x = mixed(seed + 0x9e3779b97f4a7c15U);
  for (const std::int64_t part : {i, j, k}) x = mixed(x + static_cast<std::uint64_t>(part) + 0x9e3779b97f4a7c15U);
  return static_cast<double>(x >> 11U) * 0x1p-53;
}

double smooth_noise(const Vector3& place_m, double grain_m, std::uint64_t seed) {
  const Vector3 at = place_m / grain_m;
  const Vector3 low(std::floor(at.x()), std::floor(at.y()), std::floor(at.z()));
  const Vector3 part = at - low;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::int64_t, 3> node{};
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_far = ((corner >> axis) & 1) != 0;
      weight *= is_far ? part[axis] : 1.0 - part[axis];
      node[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(low[axis]) + (is_far ? 1 : 0);
    }
    sum += weight * (hashed(node[0], node[1], node[2], seed) - 0.5);
  }
  // Variance of a uniform number 1/12, of the mean of weights (2/3)^3 of that.
  static const double scale = std::sqrt(12.0 * 27.0 / 8.0);
  return scale * sum;
}

std::vector<Facet> scaled_facets(const twins::camera::CadModel& model, double scale) {
  std::vector<Facet> facets;
  facets.reserve(model.triangles.size());
  for (const twins::camera::Triangle& t : model.triangles)
    facets.push_back(
        {{scale * t.corners[0], scale * t.corners[1], scale * t.corners[2]}, t.normals, {1, 1, 1}, t.material});
  return facets;
}

void move_corners(std::vector<Facet>& facets, std::uint64_t seed) {
  const double along_axis = kCornerErrorM / std::numbers::sqrt3;
  for (Facet& facet : facets)
    for (Vector3& corner : facet.corners) {
      const Vector3 place = corner;
      for (int axis = 0; axis < 3; ++axis)
        corner[axis] += along_axis * smooth_noise(place, kShapeGrainM, mixed(seed) + static_cast<std::uint64_t>(axis));
    }
}

void add_albedo_noise(std::vector<Facet>& facets, std::uint64_t seed) {
  for (Facet& facet : facets)
    for (std::size_t k = 0; k < 3; ++k)
      facet.albedo_factors[k] =
          std::max(0.0, 1.0 + kAlbedoNoise * smooth_noise(facet.corners[k], kAlbedoGrainM, mixed(seed + 7)));
}

std::vector<Facet> subdivided(const std::vector<Facet>& facets, double longest_m) {
  std::vector<Facet> out;
  for (const Facet& f : facets)
    divide({f.corners[0], f.normals[0], f.albedo_factors[0]}, {f.corners[1], f.normals[1], f.albedo_factors[1]},
           {f.corners[2], f.normals[2], f.albedo_factors[2]}, f.material, longest_m, out);
  return out;
}

void add_limb(const Limb& limb, std::size_t material, std::vector<Facet>& facets) {
  constexpr int kAround = 16, kRings = 4;  // divisions of a hemisphere
  const Vector3 along = limb.to_m - limb.from_m;
  const Vector3 axis = along.norm() > 1e-9 ? Vector3(along.normalized()) : Vector3(Vector3::UnitZ());
  const Vector3 x = axis.unitOrthogonal(), y = axis.cross(x);
  // Rows of corners from the one pole to the other; the last of the first hemisphere and the first of the second make
  // the cylinder.
  const auto normal_of = [&](int row, int k) {
    const int step = row <= kRings ? row - kRings : row - kRings - 1;
    const double height = 0.5 * std::numbers::pi * step / kRings,
                 turn = 2.0 * std::numbers::pi * (k % kAround) / kAround;
    return Vector3(std::sin(height) * axis + std::cos(height) * (std::cos(turn) * x + std::sin(turn) * y));
  };
  const auto place_of = [&](int row, const Vector3& normal) {
    return Vector3((row <= kRings ? limb.from_m : limb.to_m) + limb.radius_m * normal);
  };
  for (int row = 0; row < 2 * kRings + 1; ++row)
    for (int k = 0; k < kAround; ++k) {
      const Vector3 a = normal_of(row, k), b = normal_of(row, k + 1), c = normal_of(row + 1, k + 1),
                    d = normal_of(row + 1, k);
      const Vector3 pa = place_of(row, a), pb = place_of(row, b), pc = place_of(row + 1, c), pd = place_of(row + 1, d);
      if (row > 0) facets.push_back({{pa, pb, pc}, {a, b, c}, {1, 1, 1}, material});
      if (row < 2 * kRings) facets.push_back({{pa, pc, pd}, {a, c, d}, {1, 1, 1}, material});
    }
}

std::vector<Facet> board_facets(const calibrate::BoardDesign& design, std::size_t white, std::size_t black,
                                double longest_m) {
  std::vector<Facet> facets;
  for (const calibrate::BoardQuad& quad : calibrate::board_quads(design))
    add_quad(quad.corners_B, quad.is_white ? white : black, facets);
  auto plate = calibrate::board_plate(design).corners_B;
  for (Vector3& corner : plate) corner.z() += kPlateBehindM;
  add_quad(plate, white, facets);
  for (Vector3& corner : plate) corner.z() += design.plate_thickness_m;
  add_quad(plate, black, facets);
  return subdivided(facets, longest_m);
}

std::vector<float> interleaved(const std::vector<Facet>& facets, const Vector3& origin) {
  std::vector<float> floats;
  floats.reserve(33 * facets.size());
  const auto add = [&floats](const Vector3& v) {
    for (int i = 0; i < 3; ++i) floats.push_back(static_cast<float>(v[i]));
  };
  for (const Facet& f : facets) {
    const Vector3 cross = (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]);
    const double area = cross.norm();
    if (!(area > 0.0)) continue;
    const Vector3 flat = cross / area;
    for (std::size_t k = 0; k < 3; ++k) {
      add(f.corners[k] - origin);
      add(f.normals[k].squaredNorm() > 0.0 ? f.normals[k] : flat);
      add(flat);
      floats.push_back(static_cast<float>(f.material));
      floats.push_back(static_cast<float>(f.albedo_factors[k]));
    }
  }
  return floats;
}

}  // namespace vbar::tron::bench
