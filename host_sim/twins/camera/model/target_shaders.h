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

// Reflection: Lambert plus Cook and Torrance (1982), "A reflectance model for computer graphics", with the distribution
// and masking of Walter, Marschner, Li, Torrance (2007), "Microfacet models for refraction through rough surfaces"
// (GGX, eqs. 33 and 34) and Schlick's (1994) Fresnel term. Light that the surface reflects specularly at grazing angles
// is not scattered: the Lambert part falls as the Fresnel term rises, in both directions, so that reciprocity holds.
inline constexpr std::string_view kReflectionFunctions = R"glsl(
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
)glsl";

// Light reflected towards the camera, 1/sr times irradiance. Followed by kReflectionFunctions and
// kSurfaceFragmentMain.
//
// The Earth is a disc of even radiance: its light scattered by the Lambert part, horizon included, and its mirror
// image, as much of the lobe about the mirrored view as falls on the disc.
inline constexpr std::string_view kSurfaceFragmentInputs = R"glsl(#version 330 core
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
uniform int shadow_reach;      // of the mean, in texels: 0 for 2 x 2 of them, 1 for 4 x 4
uniform sampler2D shadow_map;  // depths, 0 to 1 through the sphere
)glsl";

inline constexpr std::string_view kSurfaceFragmentMain = R"glsl(
// Sunlit fraction at p: a mean over the texels of the shadow map around it, their weights moving with p. Each
// texel is compared with the depth that the plane of the face has at the texel's middle: no face shades itself, and
// shadows begin where bodies touch. Where the Sun only grazes a face the slope is limited, and so is the light.
float sunlight(vec3 flat_normal) {
  vec3 normal_sun = R_sun_body * flat_normal;
  vec2 slope = normal_sun.xy / max(-normal_sun.z, 0.02);
  vec3 place = 0.5 * (R_sun_body * p) + 0.5;
  int size = textureSize(shadow_map, 0).x;
  float texel = 1.0 / float(size);
  vec2 at = place.xy * float(size) - 0.5;
  ivec2 first = ivec2(floor(at));
  vec2 part = at - vec2(first);
  float depth = place.z - 0.1 * texel * (1.0 + abs(slope.x) + abs(slope.y));
  int r = shadow_reach;
  float sum = 0.0;
  for (int i = -r; i <= r + 1; ++i)
    for (int j = -r; j <= r + 1; ++j) {
      float across = i == -r ? 1.0 - part.x : i > r ? part.x : 1.0;
      float along = j == -r ? 1.0 - part.y : j > r ? part.y : 1.0;
      float seen = texelFetch(shadow_map, clamp(first + ivec2(i, j), 0, size - 1), 0).r;
      sum += depth + texel * dot(slope, vec2(float(i), float(j)) - part) <= seen ? across * along : 0.0;
    }
  return sum / float((2 * r + 1) * (2 * r + 1));
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
