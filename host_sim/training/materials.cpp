#include "host_sim/training/materials.h"

#include <algorithm>
#include <cmath>

#include "host_sim/training/draws.h"

namespace vbar::training {
namespace {

using twins::camera::Material;

constexpr double kMaxReflected = 0.95;
constexpr double kMaxExponent = 3000.0;

Material grey(const Material& like, double diffuse, double specular, double exponent) {
  const double sum = diffuse + specular;
  const double by = sum > kMaxReflected ? kMaxReflected / sum : 1.0;
  Material material = like;
  material.diffuse.fill(by * diffuse);
  material.specular.fill(by * specular);
  material.exponent = std::min(exponent, kMaxExponent);
  return material;
}

Material near(const Material& own, engine::RandomStream& stream) {
  // Inside the range that training excludes, also after rounding.
  constexpr double kNear = 0.999 * kOwnFamily;
  double diffuse = stream.uniform(-kNear, kNear) * own.grey_diffuse();
  double specular = stream.uniform(-kNear, kNear) * own.grey_specular();
  const double exponent = own.exponent * stream.uniform(1.0 - kNear, 1.0 + kNear);
  // Limited to physical reflectivities: then part of the way.
  const double own_sum = own.grey_diffuse() + own.grey_specular();
  const double part = std::min(1.0, (kMaxReflected - own_sum) / std::max(diffuse + specular, 1e-9));
  diffuse = own.grey_diffuse() + part * diffuse;
  specular = own.grey_specular() + part * specular;
  return grey(own, diffuse, specular, exponent);
}

Material far(std::span<const Material> file, std::size_t which, engine::RandomStream& stream) {
  constexpr double kSwapped = 0.3;
  constexpr int kTries = 100;  // one in ten is too close
  const Material& own = file[which];
  Material drawn;
  for (int i = 0; i < kTries; ++i) {
    const Material& like = stream.uniform() < kSwapped ? file[index_below(file.size(), stream)] : own;
    const double diffuse = like.grey_diffuse() * log_uniform(0.3, 3.0, stream);
    const double specular = like.grey_specular() * log_uniform(0.3, 3.0, stream);
    drawn = grey(own, diffuse, specular, like.exponent * log_uniform(0.2, 5.0, stream));
    if (!is_of_own_family(drawn, own)) return drawn;
  }
  return grey(own, 0.5 * own.grey_diffuse(), 0.5 * own.grey_specular(), own.exponent);
}

}  // namespace

bool is_of_own_family(const Material& drawn, const Material& own) {
  const auto is_near = [](double value, double reference) {
    return std::abs(value - reference) <= kOwnFamily * reference;
  };
  return is_near(drawn.grey_diffuse(), own.grey_diffuse()) && is_near(drawn.grey_specular(), own.grey_specular());
}

std::vector<Material> draw_materials(CropKind kind, std::span<const Material> file, engine::RandomStream& stream) {
  std::vector<Material> materials;
  for (std::size_t i = 0; i < file.size(); ++i)
    materials.push_back(kind == CropKind::kHeldOut ? near(file[i], stream) : far(file, i, stream));
  return materials;
}

}  // namespace vbar::training
