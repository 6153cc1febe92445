#include "emulators/tron/scene/facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil_drivers/tron/geometry/board_design.h"

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

namespace {

constexpr double kPedestalRadiusM = 0.15;
constexpr double kBeforeLensM = 0.03;

double distance_from_axis(const Limb& limb, const Vector3& place) {
  const Vector3 along = limb.to_m - limb.from_m;
  const double length2 = along.squaredNorm();
  const double part = length2 > 0.0 ? std::clamp((place - limb.from_m).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (place - limb.from_m - part * along).norm();
}

Limb rod_of(const TestbedDesign& bench, const LabView& view) {
  const Eigen::Isometry3d T_L_F = view.T_L_board ? *view.T_L_board * calibrate::T_flange_board(bench).inverse()
                                                 : view.T_L_T * bench.target.T_flange_target(bench.scale).inverse();
  Limb rod;
  rod.radius_m = bench.target.rod_radius_m;
  rod.from_m = T_L_F.translation();
  // Its round end stays behind the face.
  rod.to_m = T_L_F * Vector3(0.0, 0.0, std::max(0.0, bench.target.stand_off_m - rod.radius_m - 0.01));
  return rod;
}

Limb pedestal_of(const TestbedDesign& bench) {
  Limb pedestal;
  pedestal.radius_m = kPedestalRadiusM;
  pedestal.to_m = bench.target_robot.base.position_m - Vector3(0.0, 0.0, kPedestalRadiusM);
  pedestal.from_m = pedestal.to_m;
  pedestal.from_m.z() = bench.room_low_m.z();
  return pedestal;
}

}  // namespace

std::vector<Limb> limbs_in_view(const TestbedDesign& bench, const LabView& view) {
  std::vector<Limb> limbs = view.arms;
  limbs.push_back(rod_of(bench, view));
  limbs.push_back(pedestal_of(bench));
  const Vector3 camera = view.T_L_C.translation();
  std::erase_if(limbs,
                [&](const Limb& limb) { return distance_from_axis(limb, camera) < limb.radius_m + kBeforeLensM; });
  return limbs;
}

namespace {

constexpr double kCellM = 0.25;
constexpr double kBoxBeforeWallM = 0.005;
constexpr std::size_t kFloatsAVertex = 9;

void add_vertex(const Vector3& place, const Vector3& normal, const std::array<double, 3>& light,
                std::vector<float>& floats) {
  for (int i = 0; i < 3; ++i) floats.push_back(static_cast<float>(place[i]));
  for (int i = 0; i < 3; ++i) floats.push_back(static_cast<float>(normal[i]));
  for (const double number : light) floats.push_back(static_cast<float>(number));
}

constexpr std::array<std::size_t, 6> kTwoTriangles{0, 1, 2, 0, 2, 3};

void add_box(const BoxLight& box, const Vector3& origin, double unit, std::vector<float>& floats) {
  constexpr int kParts = 4;
  const auto at = [&](int i, int j) {
    return Vector3(box.centre_m + kBoxBeforeWallM * box.normal - origin +
                   box.half_side_m * ((2.0 * i / kParts - 1.0) * box.across + (2.0 * j / kParts - 1.0) * box.up));
  };
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; j < kParts; ++j) {
      const std::array<Vector3, 4> corners{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      for (const std::size_t k : kTwoTriangles)
        add_vertex(corners[k], box.normal, {kWallAlbedo, 0.0, box.radiance / unit}, floats);
    }
}

}  // namespace

Room::Room(const TestbedDesign& bench) {
  std::array<double, kBoxes> full;
  full.fill(1.0);
  auto boxes = box_lights(bench, full, 1.0);
  for (BoxLight& box : boxes) box.radiance = 1.0;
  const Vector3 low = bench.room_low_m, size = bench.room_high_m - bench.room_low_m;
  const Vector3 x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  // Seen from inside anticlockwise: the normal is u cross v.
  add_wall(low, x, y, boxes);      // floor
  add_wall(low + z, y, x, boxes);  // ceiling
  add_wall(low, z, x, boxes);      // -y wall
  add_wall(low + y, x, z, boxes);  // +y wall
  add_wall(low, y, z, boxes);      // end wall at low x
  add_wall(low + x, z, y, boxes);  // end wall at high x
}

void Room::add_wall(const Vector3& corner, const Vector3& u, const Vector3& v,
                    const std::array<BoxLight, kBoxes>& unit_boxes) {
  const int across = static_cast<int>(std::ceil(u.norm() / kCellM)),
            along = static_cast<int>(std::ceil(v.norm() / kCellM));
  const auto at = [&](int i, int j) { return Vector3(corner + i * u / across + j * v / along); };
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j) {
      Cell cell;
      cell.corners = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      cell.normal = u.cross(v).normalized();
      cell.area_m2 = u.cross(v).norm() / (across * along);
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t b = 0; b < kBoxes; ++b)
          cell.per_radiance[k][b] = irradiance_of(unit_boxes[b], cell.corners[k], cell.normal);
      cells_.push_back(cell);
    }
}

std::vector<float> Room::corners(const std::array<BoxLight, kBoxes>& boxes, const Vector3& origin, double unit) const {
  std::vector<float> floats;
  floats.reserve((cells_.size() + 16 * kBoxes) * 6 * kFloatsAVertex);
  for (const Cell& cell : cells_) {
    std::array<double, 4> irradiance{};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t b = 0; b < kBoxes; ++b) irradiance[k] += cell.per_radiance[k][b] * boxes[b].radiance;
    for (const std::size_t k : kTwoTriangles)
      add_vertex(cell.corners[k] - origin, cell.normal, {kWallAlbedo, irradiance[k] / unit, 0.0}, floats);
  }
  for (const BoxLight& box : boxes) add_box(box, origin, unit, floats);
  return floats;
}

std::array<double, 6> Room::reflected(const LampBeam& beam, const std::array<BoxLight, kBoxes>& boxes,
                                      const Vector3& place_m) const {
  std::array<double, 6> sum;
  sum.fill(kScatteredByEquipment * beam.irradiance);
  for (const Cell& cell : cells_) {
    const Vector3 centre = 0.5 * (cell.corners[0] + cell.corners[2]);
    const Vector3 from = place_m - centre;
    const double d2 = from.squaredNorm(), cosine = cell.normal.dot(from);
    if (!(cosine > 0.0) || d2 < 1e-4) continue;
    double irradiance = beam.irradiance_at(centre) * std::max(0.0, cell.normal.dot(beam.direction_at(centre)));
    for (std::size_t b = 0; b < kBoxes; ++b)
      irradiance +=
          boxes[b].radiance * 0.25 *
          (cell.per_radiance[0][b] + cell.per_radiance[1][b] + cell.per_radiance[2][b] + cell.per_radiance[3][b]);
    const double part = kWallAlbedo / std::numbers::pi * irradiance * cell.area_m2 * cosine / (d2 * d2);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = -from[static_cast<Eigen::Index>(axis)];
      sum[2 * axis] += part * std::max(0.0, along);
      sum[2 * axis + 1] += part * std::max(0.0, -along);
    }
  }
  return sum;
}

}  // namespace vbar::tron::bench
