// Radiance of what the geometry pass left, averaged with the frames before. The material above
// defines pointResponse(wo, wi) = f cos(theta_i) and environmentResponse(wo, frame), both in RGB;
// frame has the tangent, bitangent and normal as columns.
uniform sampler2D positions, normals, before;
uniform vec3 eye, light;      // light: position
uniform vec3 pointStrength;   // radiance of white Lambert at `lightDistance`, face on
uniform float lightDistance, environmentStrength, frameShare;
layout(location = 0) out vec4 result;

vec4 radiance(ivec2 pixel) {
    vec4 found = texelFetch(positions, pixel, 0);
    if (found.a == 0.0) return vec4(0.0);
    vec3 position = found.xyz, n = normalize(texelFetch(normals, pixel, 0).xyz);
    // The tangent runs along the parallels of the vertical axis.
    vec3 t = vec3(n.z, 0.0, -n.x);
    t = dot(t, t) > 1e-12 ? normalize(t) : vec3(1.0, 0.0, 0.0);
    mat3 frame = mat3(t, cross(n, t), n);
    vec3 wo = transpose(frame) * normalize(eye - position);
    // Interpolated normals can turn away at the outline.
    wo = normalize(vec3(wo.xy, max(wo.z, 2e-3)));
    vec3 sum = vec3(0.0), toLight = light - position;
    float squared = dot(toLight, toLight);
    vec3 wi = transpose(frame) * (toLight * inversesqrt(squared));
    if (pointStrength != vec3(0.0) && wi.z > 0.0) {
        sum += 3.14159265358979 * pointStrength * (lightDistance * lightDistance / squared) *
               pointResponse(wo, wi);
    }
    if (environmentStrength > 0.0) sum += environmentStrength * environmentResponse(wo, frame);
    return vec4(sum, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 now = radiance(pixel);
    result = frameShare < 1.0 ? mix(texelFetch(before, pixel, 0), now, frameShare) : now;
}
