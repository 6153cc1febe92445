#pragma once
// True phase centre of the antenna in the body, and the resulting error of a relative navigation that uses the nominal
// one. Appendix A of the paper, second table.

#include <numbers>
#include <string_view>

#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::twins::gnss {

inline constexpr double kArcsecond = std::numbers::pi / 648000.0;  ///< rad

/// One spacecraft's draws, constant through a run. SI, body frame.
struct BodyFrameErrors {
  fsw::Vector3 com_m = fsw::Vector3::Zero();              ///< true minus nominal centre of mass
  fsw::Vector3 pco_m = fsw::Vector3::Zero();              ///< true minus nominal phase centre
  fsw::Vector3 antenna_rotation = fsw::Vector3::Zero();   ///< rad, small: true from nominal antenna direction
  fsw::Vector3 attitude_rotation = fsw::Vector3::Zero();  ///< rad, small: true from known body axes
};

/// Draws from the stream "gnss/<spacecraft>/body_frame" of `seed`.
BodyFrameErrors draw_body_frame(const BodyFrameSettings& settings, std::uint64_t seed, std::string_view spacecraft);

/// Returns the true antenna phase centre from the true centre of mass, in the known body axes; without noise.
fsw::Vector3 antenna_from_com(const BodyFrameSettings& settings, const BodyFrameErrors& errors);

/// Returns the true boresight in the known body axes, unit vector.
fsw::Vector3 true_boresight(const BodyFrameSettings& settings, const BodyFrameErrors& errors);

/// Returns the root mean square length over all draws of the relative position error of two spacecraft that each use
/// the nominal antenna position, m: the static floor under any filter that does not estimate these errors. (Constant in
/// the body; for a pair that keeps parallel attitudes it is a constant vector, indistinguishable from a baseline.)
double static_floor_rms_m(const BodyFrameSettings& servicer, const BodyFrameSettings& target);

/// Returns the static floor of one run's draws for bodies with parallel axes: target's antenna error minus servicer's,
/// body frame, m.
fsw::Vector3 static_floor_m(const BodyFrameSettings& servicer_settings, const BodyFrameErrors& servicer,
                            const BodyFrameSettings& target_settings, const BodyFrameErrors& target);

}  // namespace vbar::twins::gnss
