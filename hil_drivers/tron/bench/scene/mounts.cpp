#include "hil_drivers/tron/bench/scene/mounts.h"

#include <algorithm>

#include "hil_drivers/tron/calibrate/board/board_design.h"

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;

constexpr double kPedestalRadiusM = 0.15;
constexpr double kBeforeLensM = 0.03;

double distance_from_axis(const Limb& limb, const Vector3& place) {
  const Vector3 along = limb.to_m - limb.from_m;
  const double length2 = along.squaredNorm();
  const double part = length2 > 0.0 ? std::clamp((place - limb.from_m).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (place - limb.from_m - part * along).norm();
}

Limb rod_of(const BenchFile& bench, const LabView& view) {
  const Eigen::Isometry3d T_L_F = view.T_L_board ? *view.T_L_board * calibrate::T_flange_board(bench).inverse()
                                                 : view.T_L_T * bench.target.T_flange_target(bench.scale).inverse();
  Limb rod;
  rod.radius_m = bench.target.rod_radius_m;
  rod.from_m = T_L_F.translation();
  // Its round end stays behind the face.
  rod.to_m = T_L_F * Vector3(0.0, 0.0, std::max(0.0, bench.target.stand_off_m - rod.radius_m - 0.01));
  return rod;
}

Limb pedestal_of(const BenchFile& bench) {
  Limb pedestal;
  pedestal.radius_m = kPedestalRadiusM;
  pedestal.to_m = bench.target_robot.base.position_m - Vector3(0.0, 0.0, kPedestalRadiusM);
  pedestal.from_m = pedestal.to_m;
  pedestal.from_m.z() = bench.room_low_m.z();
  return pedestal;
}

}  // namespace

std::vector<Limb> limbs_in_view(const BenchFile& bench, const LabView& view) {
  std::vector<Limb> limbs = view.arms;
  limbs.push_back(rod_of(bench, view));
  limbs.push_back(pedestal_of(bench));
  const Vector3 camera = view.T_L_C.translation();
  std::erase_if(limbs,
                [&](const Limb& limb) { return distance_from_axis(limb, camera) < limb.radius_m + kBeforeLensM; });
  return limbs;
}

}  // namespace vbar::tron::bench
