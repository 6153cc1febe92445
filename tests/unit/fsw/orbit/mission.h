#pragma once
// The paper's mission as the tests of the orbit and safety libraries need it.

#include <array>

#include "fsw/math/math.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit::mission {

inline constexpr double kDegree = math::kDegree;

/// The servicer's orbit of the paper's table of initial elements, taken as osculating.
inline constexpr QnsElements kServicerOsculating{
    .a = 7087.30e3, .ex = 0.0015, .ey = -4.17e-8, .i = 98.18 * kDegree, .raan = -90.0 * kDegree, .u = -0.69 * kDegree};

/// Its mean elements, from an independent implementation of Brouwer's theory (class code, fixed-point inversion).
inline constexpr QnsElements kServicerMean{.a = 7078138.944,
                                           .ex = 0.00104134174,
                                           .ey = 1.5923745e-5,
                                           .i = 98.1853293 * kDegree,
                                           .raan = -90.0001291 * kDegree,
                                           .u = -0.6886792 * kDegree};

/// Semi-major axis that turns the waypoint table's metres into ROE.
inline constexpr double kReferenceA = 7078138.944;

/// A row of the paper's table "End-to-end Mission ROE Waypoints".
struct Waypoint {
  double time_h;
  std::array<double, 6> a_roe_m;

  [[nodiscard]] Vector6 roe() const { return Vector6(a_roe_m.data()) / kReferenceA; }
};

inline constexpr std::array<Waypoint, 11> kWaypoints{{
    {0.0, {-2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0}},
    {6.0, {-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0}},
    {12.0, {-70.0, -25000.0, 0.0, 500.0, 0.0, 500.0}},
    {18.0, {-17.0, -5000.0, 0.0, 500.0, 0.0, 500.0}},
    {24.0, {0.0, -1000.0, 0.0, 30.0, 0.0, 30.0}},
    {28.0, {0.0, -600.0, 0.0, 18.0, 0.0, 18.0}},
    {32.0, {0.0, -200.0, 0.0, 6.0, 0.0, 6.0}},
    {36.0, {0.0, -100.0, 0.0, 3.0, 0.0, 3.0}},
    {39.0, {-0.5, -10.0, 0.0, 2.0, 0.0, 1.0}},
    {40.0, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}},
    {41.25, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}},
}};

}  // namespace vbar::fsw::orbit::mission
