#pragma once
// Shaders of the laboratory. All positions are in metres from the middle of the target in axes of L, all light in the
// unit that the caller chose. The reflection functions are those of the digital twin's target.

#include <string_view>

namespace vbar::tron::bench {

// Projection by the lens, distortion included. The distorted place is given in homogeneous coordinates, so that the
// clipping of triangles that reach behind the camera is correct; beyond the field the distortion stops growing.
inline constexpr std::string_view kLensFunctions = R"glsl(
uniform mat3 R_C_S;
uniform vec3 origin_C;
uniform vec4 lens_k;      // k1, k2, k3, largest squared radius
uniform vec2 lens_p;      // p1, p2
uniform float focal_px;
uniform vec2 centre_px;   // principal point from the picture's first corner
uniform vec2 size_px;     // of the picture

vec4 clip_of(vec3 place) {
  vec3 c = R_C_S * place + origin_C;
  float limit = lens_k.w;
  vec2 q = c.xy / max(c.z, 1e-4);
  float r2 = dot(q, q);
  float near_r2 = min(r2, limit);
  float radial = 1.0 + near_r2 * (lens_k.x + near_r2 * (lens_k.y + near_r2 * lens_k.z));
  vec2 t = r2 > limit ? q * sqrt(limit / r2) : q;
  vec2 tangential = vec2(2.0 * lens_p.x * t.x * t.y + lens_p.y * (near_r2 + 2.0 * t.x * t.x),
                         lens_p.x * (near_r2 + 2.0 * t.y * t.y) + 2.0 * lens_p.y * t.x * t.y);
  vec2 plane_z = c.xy * radial + tangential * max(c.z, 0.0);
  vec2 pixel_z = focal_px * plane_z + centre_px * c.z;
  const float kNear = 0.05, kFar = 15.0;
  return vec4(2.0 * pixel_z / size_px - c.z, (c.z * (kFar + kNear) - 2.0 * kFar * kNear) / (kFar - kNear), c.z);
}
)glsl";

// Irradiance of the lamp's beam.
inline constexpr std::string_view kBeamFunctions = R"glsl(
uniform vec3 beam_centre, beam_direction, beam_across, beam_up;
uniform vec4 beam_shape;       // 1/distance, radius (0: no edge), half width of the edge, irradiance
uniform vec3 beam_uneven;

vec3 lamp_direction(vec3 p) { return normalize(beam_direction - beam_shape.x * (p - beam_centre)); }

float lamp_irradiance(vec3 p) {
  vec3 from = p - beam_centre;
  vec3 way = beam_direction - beam_shape.x * from;
  float light = beam_shape.w / dot(way, way);
  if (beam_shape.y <= 0.0) return light;
  float spread = 1.0 - beam_shape.x * dot(from, beam_direction);
  if (spread <= 0.0) return 0.0;
  vec2 at = vec2(dot(from, beam_across), dot(from, beam_up)) / (spread * beam_shape.y);
  float r2 = dot(at, at);
  float edge = 1.0 - smoothstep(beam_shape.y - beam_shape.z, beam_shape.y + beam_shape.z, beam_shape.y * sqrt(r2));
  return light * edge * (1.0 + dot(beam_uneven.xy, at) + beam_uneven.z * r2);
}
)glsl";

inline constexpr std::string_view kLabShadowVertexShader = R"glsl(#version 330 core
layout(location = 0) in vec3 position;
uniform mat3 R_shadow_S;   // rows: two axes across, then away from the lamp
uniform vec4 shadow_view;  // 1/half width, 1/largest distance along, 1/distance of the lamp, 0
uniform vec2 shadow_shift; // of the raster, in the map's coordinates
void main() {
  vec3 s = R_shadow_S * position;
  float w = 1.0 + s.z * shadow_view.z;
  gl_Position = vec4(s.xy * shadow_view.x + shadow_shift * w, s.z * shadow_view.y, w);
}
)glsl";

inline constexpr std::string_view kLabSurfaceVertexMain = R"glsl(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 flat_normal_and_material;
layout(location = 3) in float albedo_factor;
uniform mat3 R_S_B;             // of the body that is drawn
uniform vec4 materials[64];     // albedo, reflectivity, reflectivity at grazing incidence, roughness
uniform vec3 camera;
uniform int emitters;
uniform vec4 emitter_place[40]; // and radiance times area
uniform vec3 emitter_normal[40];
uniform vec3 reflected_high, reflected_low;  // irradiance by the room of areas that face +x, +y, +z and -x, -y, -z
uniform sampler1D earth_light;
uniform float earth_irradiance;
uniform vec3 nadir;
centroid out vec3 p;
centroid out vec3 smooth_normal;
centroid out vec2 scattered;    // irradiance of all light but the lamp's; factor of the albedo
flat out vec3 plane_normal;
flat out vec4 material;

float even_light(vec3 n) {
  float sum = 0.0;
  for (int i = 0; i < emitters; ++i) {
    vec3 to = emitter_place[i].xyz - p;
    float inverse = 1.0 / dot(to, to);
    sum += emitter_place[i].w * max(0.0, dot(n, to)) * max(0.0, -dot(emitter_normal[i], to)) * inverse * inverse;
  }
  vec3 squares = n * n;
  sum += dot(squares, mix(reflected_low, reflected_high, step(0.0, n)));
  if (earth_irradiance > 0.0) {
    float size = float(textureSize(earth_light, 0));
    float place = (0.5 + (size - 1.0) * (0.5 + 0.5 * dot(n, nadir))) / size;
    sum += earth_irradiance * textureLod(earth_light, place, 0.0).r;
  }
  return sum;
}

void main() {
  p = R_S_B * position;
  plane_normal = R_S_B * flat_normal_and_material.xyz;
  material = materials[int(flat_normal_and_material.w + 0.5)];
  smooth_normal = R_S_B * normal;
  vec3 n = dot(plane_normal, camera - p) < 0.0 ? -plane_normal : plane_normal;
  vec3 seen_normal = dot(smooth_normal, n) < 0.0 ? -smooth_normal : smooth_normal;
  scattered = vec2(even_light(seen_normal), albedo_factor);
  gl_Position = clip_of(p);
}
)glsl";

inline constexpr std::string_view kLabSurfaceFragmentInputs = R"glsl(#version 330 core
centroid in vec3 p;
centroid in vec3 smooth_normal;
centroid in vec2 scattered;
flat in vec3 plane_normal;
flat in vec4 material;
out float radiance;
uniform vec3 camera;
uniform float lamp_roughness;   // what the lamp's size adds to that of a surface
uniform mat3 R_shadow_S[8];
uniform vec4 shadow_view;
uniform vec2 shadow_shift[8];
uniform float shadow_half;      // half width of a map, m
uniform sampler2D shadow_maps;  // 4 x 2 of them
uniform int boxes;
uniform vec4 box_place[10];     // and radiance
uniform vec3 box_normal[10];
uniform vec3 box_across[10];
uniform float box_half;
uniform vec3 reflected_high, reflected_low;
uniform vec3 nadir;
uniform float earth_irradiance;
uniform vec2 earth_disc;        // half-angle, radiance per irradiance
)glsl";

inline constexpr std::string_view kLabSurfaceFragmentMain = R"glsl(
// Seen fraction of the lamp: eight points of it, each with a map whose raster is shifted by another part of a texel.
// The depth compared is that of the face's plane in the middle of the texel, so that no face shades itself.
float lamplight(vec3 flat_normal) {
  int size = textureSize(shadow_maps, 0).x / 4;
  float sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    vec3 s = R_shadow_S[k] * p;
    vec3 n = R_shadow_S[k] * flat_normal;
    vec2 slope = n.xy / max(-n.z, 0.02);
    float w = 1.0 + s.z * shadow_view.z;
    vec2 at = (0.5 * (s.xy * shadow_view.x / w + shadow_shift[k]) + 0.5) * float(size);
    ivec2 texel = ivec2(floor(at));
    if (texel.x < 0 || texel.y < 0 || texel.x >= size || texel.y >= size) {
      sum += 1.0;
      continue;
    }
    float texel_m = 2.0 * shadow_half * w / float(size);
    vec2 off = (vec2(texel) + 0.5 - at) * texel_m;
    float z = s.z + dot(slope, off) - 0.1 * texel_m * (1.0 + abs(slope.x) + abs(slope.y));
    float depth = 0.5 * z * shadow_view.y / (1.0 + z * shadow_view.z) + 0.5;
    float seen = texelFetch(shadow_maps, texel + ivec2((k & 3) * size, (k >> 2) * size), 0).r;
    sum += depth <= seen ? 1.0 : 0.0;
  }
  return 0.125 * sum;
}

// Radiance of what stands in the mirrored line of sight of a surface this rough, in part.
float mirrored(vec3 n, vec3 v, vec4 m) {
  vec3 r = reflect(-v, n);
  float sum = dot(r * r, mix(reflected_low, reflected_high, step(0.0, r))) / kPi;
  float blur = 1.5 * m.w;
  for (int i = 0; i < boxes; ++i) {
    float towards = dot(box_normal[i], r);
    vec3 to = box_place[i].xyz - p;
    float way = dot(box_normal[i], to) / min(towards, -1e-4);
    if (towards >= 0.0 || way <= 0.0) continue;
    vec3 off = way * r - to;
    float spread = max(blur * way, 1e-3);
    float x = abs(dot(off, box_across[i])), y = length(off - dot(off, box_across[i]) * box_across[i]);
    sum += box_place[i].w * (1.0 - smoothstep(box_half - spread, box_half + spread, x)) *
           (1.0 - smoothstep(box_half - spread, box_half + spread, y));
  }
  if (earth_irradiance > 0.0) {
    float low = cos(min(earth_disc.x + blur, kPi)), high = cos(max(earth_disc.x - blur, 0.0));
    sum += earth_irradiance * earth_disc.y * smoothstep(low, high, dot(r, nadir));
  }
  return sum;
}

void main() {
  vec4 m = material;
  m.x *= scattered.y;
  vec3 v = normalize(camera - p);
  vec3 flat_normal = plane_normal;
  if (dot(flat_normal, v) < 0.0) flat_normal = -flat_normal;  // thin sheets are seen from both sides
  vec3 n = normalize(smooth_normal);
  if (dot(n, flat_normal) < 0.0) n = -n;
  float nv = max(dot(n, v), 1e-4);
  radiance = m.x / kPi * (1.0 - m.z * grazing(nv)) * scattered.x +
             (m.y + (m.z - m.y) * grazing(nv)) * mirrored(n, v, m);
  vec3 l = lamp_direction(p);
  if (beam_shape.w > 0.0 && dot(flat_normal, l) > 0.0) {
    m.w = sqrt(m.w * m.w + lamp_roughness * lamp_roughness);
    radiance += lamp_irradiance(p) * reflected(n, l, v, m) * lamplight(flat_normal);
  }
}
)glsl";

inline constexpr std::string_view kRoomVertexMain = R"glsl(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 light;  // albedo, irradiance by the boxes, emitted radiance
out vec3 p;
flat out vec3 n;
out vec3 wall;
void main() {
  p = position;
  n = normal;
  wall = light;
  gl_Position = clip_of(position);
}
)glsl";

inline constexpr std::string_view kRoomFragmentInputs = R"glsl(#version 330 core
in vec3 p;
flat in vec3 n;
in vec3 wall;
out float radiance;
)glsl";

inline constexpr std::string_view kRoomFragmentMain = R"glsl(
void main() {
  float lamp = lamp_irradiance(p) * max(0.0, dot(n, lamp_direction(p)));
  radiance = wall.z + wall.x / 3.14159265358979 * (wall.y + lamp);
}
)glsl";

}  // namespace vbar::tron::bench
