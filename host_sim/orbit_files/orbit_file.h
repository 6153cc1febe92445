#pragma once
// Orbits from files in published formats: each format is recognised by its contents, whatever the name of the file;
// each has its functions here and its line in the list.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/earth_rotation.h"

namespace vbar::orbit_files {

enum class Frame { kGcrf, kItrf };

struct TimedState {
  fsw::GpsTime time;
  fsw::orbit::CartesianState state;  ///< in the frame of the track; relative to that frame if it is Earth-fixed
  std::optional<double> clock_s{};   ///< of the object ahead of GPS time, without relativity, where the file has one
};

enum class Polynomial {
  kHermite,   ///< through positions with their velocities
  kLagrange,  ///< through positions, and another one through velocities, where there are any
};

struct InterpolationRule {
  Polynomial polynomial = Polynomial::kHermite;
  int degree = 7;
  bool is_published = false;  ///< by the file itself
};

inline constexpr int kMaxInterpolationDegree = 15;

/// Instants between which a file permits the use of its states.
struct UseableTime {
  fsw::GpsTime from, to;
};

/// States of one object that follow each other, at least one.
struct Track {
  std::string object{};   ///< name in the file
  std::string object_id;  ///< another name, may be empty
  Frame frame = Frame::kGcrf;
  bool has_velocities = true;
  double largest_step_s = 0.0;  ///< more than it between two states is a gap; 0: the steps beside it decide
  std::vector<TimedState> states{};
  std::optional<InterpolationRule> published_rule{};
  std::optional<UseableTime> useable{};
};

struct OrbitFile {
  std::string file;
  std::string format;
  std::vector<Track> tracks;
};

struct OrbitFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  std::vector<Track> (*read)(std::string_view text, const std::string& file);  ///< throws files::FormatError
};

// CCSDS Orbit Ephemeris Message (502.0-B-3, section 5) in KVN, versions 1.0 to 3.0: REF_FRAME GCRF, ICRF, EME2000 or
// ITRF with or without a year, TIME_SYSTEM UTC, TAI, TT or GPS. Covariances are skipped unread.
[[nodiscard]] bool is_oem(std::string_view text);
[[nodiscard]] std::vector<Track> read_oem(std::string_view text, const std::string& file);

// CCSDS Orbit Parameter Message (502.0-B-3, section 3) in KVN, the same versions, frames and time systems: its state
// vector. A message with maneuvers is rejected; osculating elements, spacecraft parameters and covariance are skipped.
[[nodiscard]] bool is_opm(std::string_view text);
[[nodiscard]] std::vector<Track> read_opm(std::string_view text, const std::string& file);

// SP3-a to SP3-d (Hilla 2016), Earth-fixed, with or without velocities. Positions and velocities of 0 are missing ones;
// the positions alone are used of a satellite that lacks a velocity. Clocks of 999999 are missing ones.
[[nodiscard]] bool is_sp3(std::string_view text);
[[nodiscard]] std::vector<Track> read_sp3(std::string_view text, const std::string& file);

[[nodiscard]] std::span<const OrbitFormat> orbit_formats();

/// Returns the tracks of a text in any of the formats, which may begin with a byte order mark. Throws
/// files::FormatError; for an unknown format it names all.
[[nodiscard]] OrbitFile read_orbits(std::string_view text, const std::string& file);

/// Reads the tracks of a file, which becomes part of the run's provenance. Throws std::runtime_error.
[[nodiscard]] OrbitFile load_orbits(const std::filesystem::path& file);

/// Returns the tracks of one object: that named `object`, or, if `object` is empty, the only one of the file. Throws
/// std::runtime_error that names the objects of the file.
[[nodiscard]] OrbitFile tracks_of(const OrbitFile& file, std::string_view object);

/// Rule by which a state between those of a file was found, and bounds of its error.
struct InterpolationCheck {
  InterpolationRule rule;
  double step_s = 0.0;              ///< between the states on either side
  double bound_m = 0.0;             ///< bound of the position's error (error bound of the interpolation)
  std::optional<double> bound_mps;  ///< bound of the velocity's error; none without velocities in the file
};

/// A state and the frame it is in.
struct FramedState {
  Frame frame = Frame::kGcrf;
  fsw::orbit::CartesianState state;
  std::optional<InterpolationCheck> interpolation;  ///< none for a state of the file itself
};

/// Returns the state at `time` of a file of one object, interpolated by the rule that the file publishes, else with
/// velocities by the Hermite polynomial through four states, without them by that of degree 9 through ten positions.
/// Throws std::out_of_range that names file, time and reason: outside the states or the useable time, in a gap, or an
/// error that may exceed kMaxInterpolationErrorM.
[[nodiscard]] FramedState state_at(const OrbitFile& file, fsw::GpsTime time);

/// Returns a state of `frame` in GCRF, `seconds` after the epoch of the rotation, whose rate is a central difference:
/// over 0.1 s it is good to 1e-8 m/s in a low orbit.
[[nodiscard]] fsw::orbit::CartesianState gcrf_state(Frame frame, const fsw::orbit::CartesianState& state,
                                                    truth::EarthRotation& rotation, double seconds);

// Interpolation between the states of a track, checked against these states by leaving each of them out.
//
// Bound of the error. A polynomial through n nodes t_k (each of them twice for Hermite's) misses a smooth orbit f by
//   f^(m)(.)/m! w(t),  w(t) = product (t - t_k), each factor as often as its node, m = n or 2n.
// A state of the file left out and predicted from the n nearest of the others shows this error at twice the spacing:
// there |w| is 16 h^8 for four states with velocities and 14,400 h^10 for ten positions, against 0.32 h^8 and 872 h^10
// midway between two states of the complete file, and, at the ends of a track, 36 h^8 against 0.93 h^8 at most. So the
// error of the prediction exceeds that of the interpolation 16- to 60-fold for even steps; for uneven ones it is
// multiplied by |w(t)| over |w| of the state left out where that is more than 1. Errors of the states themselves
// (rounding, a maneuver, velocities that contradict the positions) enter the prediction in full. The bound is the
// largest over the states through which the polynomial passes. That of the velocity is the largest of the same states,
// but not below that of the position over the step: the derivative of w vanishes at a state left out between even ones
// (16 h^7 are above the 0.97 h^7 of the complete file, at its ends 36 h^7 above 4.2 h^7). It presumes that the states
// resolve the orbit: at steps of a period all are alike, whatever lies between, so a step may be a quarter of a
// revolution at most.

/// Largest bound of the position's error that is accepted. By the factor above the error itself is then below 1 m, the
/// accuracy of the orbits that operators publish, and far below what a wrong file shows (kilometres).
inline constexpr double kMaxInterpolationErrorM = 10.0;

/// Returns the state at a time between the first and the last of the track. Throws std::out_of_range that names `file`,
/// time and reason.
[[nodiscard]] FramedState interpolated(const Track& track, fsw::GpsTime time, const std::string& file);

/// Returns the name of a rule: "Hermite polynomial of degree 7".
[[nodiscard]] std::string name_of(const InterpolationRule& rule);

}  // namespace vbar::orbit_files
