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

// Light reflected towards the camera, 1/sr times irradiance. Followed by kReflectionFunctions (reflection.h) and
// kSurfaceFragmentMain.
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

float scattered_earth(vec3 n) {
  float size = float(textureSize(earth_light, 0));
  float place = (0.5 + (size - 1.0) * (0.5 + 0.5 * dot(n, nadir))) / size;
  return texture(earth_light, place).r;
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
  if (earth_irradiance > 0.0) radiance += earth_irradiance * earthshine(n, v, m, mirror_edge, nadir, scattered_earth(n), earth_radiance);
}
)glsl";

}  // namespace vbar::twins::camera
