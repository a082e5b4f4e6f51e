// The values of tests, one in each pixel; a row of `tests` has u, v and lod, then wo, then wi.
uniform highp sampler2D tests;
out vec4 value;

void main() {
    int k = int(gl_FragCoord.x);
    vec4 place = texelFetch(tests, ivec2(0, k), 0);
    vec3 wo = texelFetch(tests, ivec2(1, k), 0).xyz, wi = texelFetch(tests, ivec2(2, k), 0).xyz;
    value = vec4(vec3(VALUE(place.xy, place.z, wo, wi)), 1.0);
}
