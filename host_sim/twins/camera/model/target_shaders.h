#pragma once
// Shaders of the target renderer. All lengths are in radii of the body's sphere, all directions in the body frame, all
// positions from the sphere's centre.

#include <string_view>

namespace vbar::twins::camera {

inline constexpr std::string_view kShadowVertexShader = R"glsl(#version 330 core
layout(location = 0) in vec3 position;
uniform mat3 R_sun_body;  // rows: two axes across, then away from the Sun
void main() { gl_Position = vec4(R_sun_body * position, 1.0); }
)glsl";

inline constexpr std::string_view kShadowFragmentShader = R"glsl(#version 330 core
void main() {}
)glsl";

inline constexpr std::string_view kSurfaceVertexShader = R"glsl(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 flat_normal_and_material;
uniform mat4 clip_from_body;
centroid out vec3 p;
centroid out vec3 smooth_normal;
flat out vec4 flat_and_material;
void main() {
  p = position;
  smooth_normal = normal;
  flat_and_material = flat_normal_and_material;
  gl_Position = clip_from_body * vec4(position, 1.0);
}
)glsl";

// Light reflected towards the camera, 1/sr times irradiance.
//
// Reflection: Lambert plus Cook and Torrance (1982), "A reflectance model for computer graphics", with the distribution
// and masking of Walter, Marschner, Li, Torrance (2007), "Microfacet models for refraction through rough surfaces"
// (GGX, eqs. 33 and 34) and Schlick's (1994) Fresnel term. What the surface mirrors at grazing angles it does not
// scatter: the Lambert part fades as the Fresnel term rises, in both directions, so that reciprocity holds.
//
// The Earth: irradiance of a tilted area by a sphere of even radiance, horizon included: Snyder (1996), "Area light
// sources for real-time graphics", in the form of Lagarde and de Rousiers (2014), "Moving Frostbite to physically based
// rendering", listing 7. Its mirror image: the part of the lobe about the mirrored view that falls on the disc.
inline constexpr std::string_view kSurfaceFragmentShader = R"glsl(#version 330 core
centroid in vec3 p;
centroid in vec3 smooth_normal;
flat in vec4 flat_and_material;
out float radiance;

uniform vec4 materials[64];    // albedo, reflectivity, reflectivity at grazing incidence, roughness
uniform vec3 camera;           // where it is
uniform vec3 sun;              // unit, towards it
uniform float sun_irradiance;
uniform vec3 nadir;            // unit, towards the Earth's centre
uniform float sin2_earth;      // of the Earth's half-angle
uniform float earth_irradiance;  // on an area that faces the nadir
uniform mat3 R_sun_body;
uniform float shadow_texel;    // side of a texel of the shadow map
uniform sampler2DShadow shadow_map;

const float kPi = 3.14159265358979;

float grazing(float cosine) { return pow(clamp(1.0 - cosine, 0.0, 1.0), 5.0); }

// Smith's masking of one direction, GGX.
float masking(float cosine, float alpha2) {
  return 2.0 * cosine / (cosine + sqrt(alpha2 + (1.0 - alpha2) * cosine * cosine));
}

// Reflected radiance per irradiance on an area that faces the light, from direction l to direction v: the reflection
// function times the cosine of incidence.
float reflected(vec3 n, vec3 l, vec3 v, vec4 m) {
  float nl = dot(n, l), nv = max(dot(n, v), 1e-4);
  if (nl <= 0.0) return 0.0;
  float lambert = m.x / kPi * (1.0 - m.z * grazing(nl)) * (1.0 - m.z * grazing(nv));
  vec3 h = normalize(l + v);
  float alpha2 = m.w * m.w;
  float nh = dot(n, h);
  float d = nh * nh * (alpha2 - 1.0) + 1.0;
  float distribution = alpha2 / (kPi * d * d);
  float fresnel = m.y + (m.z - m.y) * grazing(dot(v, h));
  float glossy = fresnel * distribution * masking(nl, alpha2) * masking(nv, alpha2) / (4.0 * nl * nv);
  return (lambert + glossy) * nl;
}

// Share of the Sun that reaches p: nine comparisons, each of four texels. Each compares with the depth that the plane of
// the face has there, and is nearer by what that changes within the four: no face shades itself, and the edges of
// shadows stay where they are. Where the Sun only grazes a face the slope is limited, and so is the light.
float sunlight(vec3 flat_normal) {
  vec3 normal_sun = R_sun_body * flat_normal;
  vec2 slope = normal_sun.xy / max(-normal_sun.z, 0.05);
  vec3 place = 0.5 * (R_sun_body * p) + 0.5;
  float texel = 0.5 * shadow_texel;
  float nearer = texel * (abs(slope.x) + abs(slope.y) + 0.5);
  float sum = 0.0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      vec2 off = texel * vec2(float(i), float(j));
      sum += texture(shadow_map, vec3(place.xy + off, place.z + dot(slope, off) - nearer));
    }
  return sum / 9.0;
}

// Irradiance by the Earth of an area whose normal makes an angle of this cosine with the nadir, in units of that of an
// area which faces it.
float earth_factor(float cosine) {
  float sine_earth = sqrt(sin2_earth);
  if (cosine >= sine_earth) return cosine;
  if (cosine <= -sine_earth) return 0.0;
  float sine = sqrt(1.0 - cosine * cosine);
  float x = sqrt(1.0 / sin2_earth - 1.0);
  float y = -x * cosine / sine;
  float s = sine * sqrt(max(0.0, 1.0 - y * y));
  return max(0.0, ((cosine * acos(clamp(y, -1.0, 1.0)) - x * s) * sin2_earth + atan(s / max(x, 1e-6))) /
                      (kPi * sin2_earth));
}

float earthshine(vec3 n, vec3 v, vec4 m) {
  float nv = max(dot(n, v), 1e-4);
  float lambert = m.x / kPi * (1.0 - m.z * grazing(nv)) * earth_factor(dot(n, nadir));
  float from_centre = acos(clamp(dot(reflect(-v, n), nadir), -1.0, 1.0));
  float edge = asin(sqrt(sin2_earth));
  float covered = 1.0 - smoothstep(edge - 1.5 * m.w, edge + 1.5 * m.w, from_centre);
  float fresnel = m.y + (m.z - m.y) * grazing(nv);
  return lambert + fresnel * covered / (kPi * sin2_earth);
}

void main() {
  vec4 m = materials[int(flat_and_material.w + 0.5)];
  vec3 v = normalize(camera - p);
  vec3 flat_normal = flat_and_material.xyz;
  if (dot(flat_normal, v) < 0.0) flat_normal = -flat_normal;  // thin sheets are seen from both sides
  vec3 n = normalize(smooth_normal);
  if (dot(n, flat_normal) < 0.0) n = -n;
  radiance = 0.0;
  if (sun_irradiance > 0.0 && dot(flat_normal, sun) > 0.0)
    radiance += sun_irradiance * reflected(n, sun, v, m) * sunlight(flat_normal);
  if (earth_irradiance > 0.0) radiance += earth_irradiance * earthshine(n, v, m);
}
)glsl";

}  // namespace vbar::twins::camera
