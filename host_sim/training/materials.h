#pragma once
// Surface materials of the target in one crop: they have not been measured, so the network is trained with many.

#include <span>
#include <vector>

#include "host_sim/engine/random_stream.h"
#include "host_sim/training/crop_kind.h"
#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::training {

inline constexpr double kOwnFamily = 0.3;  ///< share of a value, either way: limit of what counts as near the file's

/// Draws grey materials for the faces, one for each of `file`'s. Training and calibration: diffuse and specular part a
/// third to three times those of the material itself or (three in ten) of another one, exponents a fifth to five times;
/// never both parts within kOwnFamily of the material itself. Held out: both parts and the exponent within kOwnFamily.
[[nodiscard]] std::vector<twins::camera::Material> draw_materials(CropKind kind,
                                                                  std::span<const twins::camera::Material> file,
                                                                  engine::RandomStream& stream);

/// Whether both parts of `drawn` are within kOwnFamily of `own`.
[[nodiscard]] bool is_of_own_family(const twins::camera::Material& drawn, const twins::camera::Material& own);

}  // namespace vbar::training
