#include "hil_drivers/tron/bench/scene/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;

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

Room::Room(const BenchFile& bench) {
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
