#version 300 es
// Radiance of a vertex: albedo T L, or with GLOSSY response^T M L with M by clustered components.
precision highp float;
precision highp int;
precision highp sampler2D;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint vertex;
layout(location = 3) in vec3 vector;  // T L

uniform mat4 camera;
uniform vec3 eye;
#ifdef GLOSSY
uniform int localOrder, components;
uniform sampler2D incident;   // [cluster][mean, components][local slot]
uniform sampler2D weights;    // [vertex][cluster, components]
uniform sampler2D responses;  // [material][elevation, or row and column of the map][local slot]
uniform int elevations;
uniform int row;   // of the material's first elevation or direction
uniform int side;  // of the map of an anisotropic material, else 0
#else
uniform vec3 albedo;
#endif

out vec3 radiance;

#ifdef GLOSSY

vec3 at(sampler2D where, int k) {
  int width = textureSize(where, 0).x;
  return texelFetch(where, ivec2(k % width, k / width), 0).rgb;
}

float weightOf(int k) {
  int first = int(vertex) * (components + 1) + k, width = textureSize(weights, 0).x;
  return texelFetch(weights, ivec2(first % width, first / width), 0).r;
}

// The light that comes to the vertex, in one function above it.
vec3 local(int j, int cluster) {
  int functions = localOrder * localOrder;
  int first = cluster * (components + 1) * functions + j;
  vec3 sum = at(incident, first);
  for (int k = 1; k <= components; ++k) sum += weightOf(k) * at(incident, first + k * functions);
  return sum;
}

// Coefficients by elevation, turned to the viewer's azimuth.
vec3 byElevation(vec3 wo, int cluster, int functions) {
  float sine = length(wo.xy);
  float along = min(sine / (1.0 + wo.z) * (float(elevations) - 0.5), float(elevations - 1));
  int lower = min(int(along), elevations - 2);
  float share = along - float(lower);
  vec2 turn = sine > 1e-7 ? wo.xy / sine : vec2(1.0, 0.0);
  int first = (row + lower) * functions;
  vec3 sum = vec3(0.0);
  vec2 multiple = vec2(1.0, 0.0);
  for (int m = 0; m < localOrder; ++m) {
    for (int l = m; l < localOrder; ++l) {
      int slot = l * (l + 1) + m;
      vec3 even = mix(at(responses, first + slot), at(responses, first + functions + slot), share);
      if (m == 0) {
        sum += even * local(slot, cluster);
        continue;
      }
      int other = slot - 2 * m;
      vec3 odd = mix(at(responses, first + other), at(responses, first + functions + other), share);
      sum += (even * multiple.x - odd * multiple.y) * local(slot, cluster);
      sum += (even * multiple.y + odd * multiple.x) * local(other, cluster);
    }
    multiple = vec2(multiple.x * turn.x - multiple.y * turn.y,
                    multiple.x * turn.y + multiple.y * turn.x);
  }
  return sum;
}

// Coefficients between the four nearest directions of the parabolic map.
vec3 byDirection(vec3 wo, int cluster, int functions) {
  vec2 place = (wo.xy / (1.0 + wo.z) * float(side - 2) + float(side - 1)) / 2.0;
  ivec2 lower = min(ivec2(place), ivec2(side - 2));
  vec2 share = place - vec2(lower);
  int first = (row + lower.y * side + lower.x) * functions, below = side * functions;
  vec3 sum = vec3(0.0);
  for (int slot = 0; slot < functions; ++slot) {
    vec3 upper = mix(at(responses, first + slot), at(responses, first + functions + slot), share.x);
    vec3 under = mix(at(responses, first + below + slot),
                     at(responses, first + below + functions + slot), share.x);
    sum += mix(upper, under, share.y) * local(slot, cluster);
  }
  return sum;
}

vec3 reflected() {
  vec3 n = normalize(normal), across = vec3(-n.y, n.x, 0.0);
  vec3 tangent = dot(across, across) > 1e-24 ? normalize(across) : vec3(1.0, 0.0, 0.0);
  vec3 view = normalize(eye - position);
  vec3 wo = vec3(dot(view, tangent), dot(view, cross(n, tangent)), dot(view, n));
  if (wo.z <= 0.0) wo = vec3(normalize(wo.xy), 0.0);
  int cluster = int(weightOf(0) + 0.5), functions = localOrder * localOrder;
  return side > 0 ? byDirection(wo, cluster, functions) : byElevation(wo, cluster, functions);
}

#else
vec3 reflected() {
  return albedo * vector;
}
#endif

void main() {
  gl_Position = camera * vec4(position, 1.0);
  radiance = reflected();
}
