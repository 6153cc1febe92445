#include "hil_drivers/tron/lights/sphere_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr int kParts = 4;  // parts of an edge: 10 kParts^2 + 2 corners

std::array<Vector3, 12> icosahedron() {
  std::array<Vector3, 12> corners;
  std::size_t k = 0;
  for (const double one : {-1.0, 1.0})
    for (const double golden : {-std::numbers::phi, std::numbers::phi}) {
      corners[k++] = {0.0, one, golden};
      corners[k++] = {one, golden, 0.0};
      corners[k++] = {golden, 0.0, one};
    }
  return corners;
}

void add(const Vector3& point, std::vector<Vector3>& normals) {
  const Vector3 normal = point.normalized();
  const auto is_same = [&](const Vector3& other) { return (other - normal).squaredNorm() < 1e-12; };
  if (std::ranges::none_of(normals, is_same)) normals.push_back(normal);
}

std::vector<Vector3> divided_icosahedron() {
  const auto corners = icosahedron();
  const auto are_neighbours = [](const Vector3& a, const Vector3& b) { return std::abs((a - b).norm() - 2.0) < 1e-9; };
  std::vector<Vector3> normals;
  for (std::size_t a = 0; a < corners.size(); ++a)
    for (std::size_t b = a + 1; b < corners.size(); ++b)
      for (std::size_t c = b + 1; c < corners.size(); ++c) {
        if (!are_neighbours(corners[a], corners[b]) || !are_neighbours(corners[a], corners[c]) ||
            !are_neighbours(corners[b], corners[c]))
          continue;
        for (int i = 0; i <= kParts; ++i)
          for (int j = 0; i + j <= kParts; ++j)
            add(i * corners[a] + j * corners[b] + (kParts - i - j) * corners[c], normals);
      }
  return normals;
}

}  // namespace

const std::vector<Vector3>& sphere_normals() {
  static const std::vector<Vector3> normals = divided_icosahedron();
  return normals;
}

}  // namespace vbar::tron
