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
uniform vec4 materials[64];  // albedo, reflectivity, reflectivity at grazing incidence, roughness
uniform float earth_edge;    // half-angle of the Earth's disc
centroid out vec3 p;
centroid out vec3 smooth_normal;
flat out vec3 plane_normal;
flat out vec4 material;
flat out vec2 mirror_edge;   // cosines between which the Earth comes into a mirror this rough
void main() {
  p = position;
  smooth_normal = normal;
  plane_normal = flat_normal_and_material.xyz;
  material = materials[int(flat_normal_and_material.w + 0.5)];
  float blur = 1.5 * material.w;
  mirror_edge = vec2(cos(min(earth_edge + blur, 3.14159)), cos(max(earth_edge - blur, 0.0)));
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
// The Earth is a disc of even radiance: its light scattered by the Lambert part, horizon included, and its mirror image,
// as much of the lobe about the mirrored view as falls on the disc.
inline constexpr std::string_view kSurfaceFragmentShader = R"glsl(#version 330 core
centroid in vec3 p;
centroid in vec3 smooth_normal;
flat in vec3 plane_normal;
flat in vec4 material;
flat in vec2 mirror_edge;
out float radiance;

uniform vec3 camera;           // where it is
uniform vec3 sun;              // unit, towards it
uniform float sun_irradiance;
uniform vec3 nadir;            // unit, towards the Earth's centre
uniform float earth_radiance;  // of its disc, per irradiance
uniform sampler1D earth_light; // irradiance by it over the cosine of a normal to the nadir, from -1 to 1
uniform float earth_irradiance;  // on an area that faces the nadir
uniform mat3 R_sun_body;
uniform float shadow_texel;    // side of a texel of the shadow map
uniform int shadow_reach;      // comparisons on each side of the middle one
uniform sampler2DShadow shadow_map;

const float kPi = 3.14159265358979;

float grazing(float cosine) {
  float c = clamp(1.0 - cosine, 0.0, 1.0), c2 = c * c;
  return c2 * c2 * c;
}

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

// Share of the Sun that reaches p: one or nine comparisons, each of four texels. Each compares with the depth that the plane of
// the face has there, and is nearer by what that changes within the four: no face shades itself, and the edges of
// shadows stay where they are. Where the Sun only grazes a face the slope is limited, and so is the light.
float sunlight(vec3 flat_normal) {
  vec3 normal_sun = R_sun_body * flat_normal;
  vec2 slope = normal_sun.xy / max(-normal_sun.z, 0.05);
  vec3 place = 0.5 * (R_sun_body * p) + 0.5;
  float texel = 0.5 * shadow_texel;
  float nearer = texel * (abs(slope.x) + abs(slope.y) + 0.5);
  float sum = 0.0;
  for (int i = -shadow_reach; i <= shadow_reach; ++i)
    for (int j = -shadow_reach; j <= shadow_reach; ++j) {
      vec2 off = texel * vec2(float(i), float(j));
      sum += texture(shadow_map, vec3(place.xy + off, place.z + dot(slope, off) - nearer));
    }
  return sum / float((2 * shadow_reach + 1) * (2 * shadow_reach + 1));
}

float earthshine(vec3 n, vec3 v, vec4 m) {
  float nv = max(dot(n, v), 1e-4);
  float size = float(textureSize(earth_light, 0));
  float place = (0.5 + (size - 1.0) * (0.5 + 0.5 * dot(n, nadir))) / size;
  float lambert = m.x / kPi * (1.0 - m.z * grazing(nv)) * texture(earth_light, place).r;
  float covered = smoothstep(mirror_edge.x, mirror_edge.y, dot(reflect(-v, n), nadir));
  float fresnel = m.y + (m.z - m.y) * grazing(nv);
  return lambert + fresnel * covered * earth_radiance;
}

void main() {
  vec4 m = material;
  vec3 v = normalize(camera - p);
  vec3 flat_normal = plane_normal;
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
