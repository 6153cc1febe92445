#pragma once
// Reflection of light by a surface, stated once: as text for shaders and compiled for the processor.

#include <cmath>
#include <string_view>

#include "host_sim/engine/wide_loops.h"

namespace vbar::twins::camera {

/// Types and functions of the OpenGL Shading Language that the statement uses, by their names there.
namespace glsl {

struct vec2 {
  float x, y;
};
struct vec3 {
  float x, y, z;
};
struct vec4 {
  float x, y, z, w;
};

VBAR_INLINE vec3 operator+(vec3 a, vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
VBAR_INLINE vec3 operator-(vec3 a, vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
VBAR_INLINE vec3 operator-(vec3 a) {
  return {-a.x, -a.y, -a.z};
}
VBAR_INLINE vec3 operator*(float factor, vec3 a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
VBAR_INLINE float dot(vec3 a, vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VBAR_INLINE float max(float a, float b) {
  return a < b ? b : a;
}
VBAR_INLINE float clamp(float a, float low, float high) {
  const float above = a > low ? a : low;  // NaN: the lower bound
  return above < high ? above : high;
}
VBAR_INLINE float sqrt(float a) {
  return std::sqrt(a);
}
VBAR_INLINE vec3 normalize(vec3 a) {
  return (1.0F / sqrt(dot(a, a))) * a;
}
VBAR_INLINE vec3 reflect(vec3 incident, vec3 normal) {
  return incident - 2.0F * dot(normal, incident) * normal;
}
VBAR_INLINE float smoothstep(float low, float high, float a) {
  const float t = clamp((a - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

// Declarations with the attribute that loops over texels need, which GLSL does not have.
VBAR_INLINE float grazing(float cosine);
VBAR_INLINE float masking(float cosine, float alpha2);
VBAR_INLINE float reflected(vec3 n, vec3 l, vec3 v, vec4 m);
VBAR_INLINE float earthshine(vec3 n, vec3 v, vec4 m, vec2 mirror_edge, vec3 nadir, float scattered, float radiance);

}  // namespace glsl

#define VBAR_GLSL_AND_CPP(name, ...)                          \
  inline constexpr std::string_view name = #__VA_ARGS__ "\n"; \
  namespace glsl {                                            \
  __VA_ARGS__                                                 \
  }

// A material m is albedo, reflectivity, reflectivity at grazing incidence, roughness.
//
// Reflection: Lambert plus Cook and Torrance (1982), "A reflectance model for computer graphics", with the distribution
// and masking of Walter, Marschner, Li, Torrance (2007), "Microfacet models for refraction through rough surfaces"
// (GGX, eqs. 33 and 34) and Schlick's (1994) Fresnel term. Light that the surface reflects specularly at grazing angles
// is not scattered: the Lambert part falls as the Fresnel term rises, in both directions, so that reciprocity holds.
//
// reflected(): reflected radiance per irradiance on an area that faces the light, from direction l to direction v: the
// reflection function times the cosine of incidence. masking(): Smith's masking of one direction, GGX.
//
// earthshine(): the same of the Earth, a disc of uniform radiance: its light scattered by the Lambert part, horizon
// included (`scattered`, its irradiance over that of an area facing the nadir), and its mirror image, as much of the
// lobe about the mirrored view as falls on the disc. mirror_edge: cosines between which the Earth comes into a mirror
// this rough; `radiance`: of the disc, per irradiance.
// clang-format off
VBAR_GLSL_AND_CPP(kReflectionFunctions,
const float kPi = 3.14159265358979F;

float grazing(float cosine) {
  float c = clamp(1.0F - cosine, 0.0F, 1.0F), c2 = c * c;
  return c2 * c2 * c;
}

float masking(float cosine, float alpha2) {
  return 2.0F * cosine / (cosine + sqrt(alpha2 + (1.0F - alpha2) * cosine * cosine));
}

float reflected(vec3 n, vec3 l, vec3 v, vec4 m) {
  float nl = dot(n, l), nv = max(dot(n, v), 1e-4F);
  if (nl <= 0.0F) return 0.0F;
  float lambert = m.x / kPi * (1.0F - m.z * grazing(nl)) * (1.0F - m.z * grazing(nv));
  vec3 h = normalize(l + v);
  float alpha2 = m.w * m.w;
  float nh = dot(n, h);
  float d = nh * nh * (alpha2 - 1.0F) + 1.0F;
  float distribution = alpha2 / (kPi * d * d);
  float fresnel = m.y + (m.z - m.y) * grazing(dot(v, h));
  float glossy = fresnel * distribution * masking(nl, alpha2) * masking(nv, alpha2) / (4.0F * nl * nv);
  return (lambert + glossy) * nl;
}

float earthshine(vec3 n, vec3 v, vec4 m, vec2 mirror_edge, vec3 nadir, float scattered, float radiance) {
  float nv = max(dot(n, v), 1e-4F);
  float lambert = m.x / kPi * (1.0F - m.z * grazing(nv)) * scattered;
  float covered = smoothstep(mirror_edge.x, mirror_edge.y, dot(reflect(-v, n), nadir));
  float fresnel = m.y + (m.z - m.y) * grazing(nv);
  return lambert + fresnel * covered * radiance;
}
)
// clang-format on
#undef VBAR_GLSL_AND_CPP

}  // namespace vbar::twins::camera
