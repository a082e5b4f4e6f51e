// A material by materialBrdf(wo, wi) = f in RGB, which the text above defines; light from all around
// is a mean over directions that grows with every frame.
uniform int frameIndex;
uniform float lobeRoughness;

vec3 pointResponse(vec3 wo, vec3 wi) { return materialBrdf(wo, wi) * wi.z; }

uint scrambled(uint x) {
    x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu; x ^= x >> 16;
    return x;
}

vec2 unit(uvec2 x) { return vec2(x >> 8) / 16777216.0; }

// A third of the directions by the cosine, a third about the mirror direction by the slopes of a GGX
// lobe, a third by the light; weighted by the mean of the densities (balance heuristic, Veach &
// Guibas 1995).
vec3 environmentResponse(vec3 wo, mat3 frame) {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uint seed = scrambled(pixel.x * 9277u + scrambled(pixel.y));
    uvec2 shift = uvec2(seed, scrambled(seed + 1u));
    float alpha2 = lobeRoughness * lobeRoughness;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < SAMPLES; ++i) {
        // The R2 sequence (Roberts 2018), turned per pixel, in units of 2^-32.
        uvec2 place = shift + uint(frameIndex * SAMPLES + i) * uvec2(3242174889u, 2447445414u);
        vec2 u = unit(place);
        vec3 wi;
        if (i % 3 == 2) {
            uint other = scrambled(place.x);
            vec2 rest = unit(uvec2(other, scrambled(other)));
            wi = transpose(frame) * skyDirection(u.x, rest.x, vec2(rest.y, u.y));
        } else {
            bool aboutMirror = i % 3 == 1;
            float phi = 2.0 * PI * u.y;
            float slope2 = aboutMirror ? alpha2 * u.x / max(1.0 - u.x, 1e-6) : 0.0;
            float z = aboutMirror ? inversesqrt(1.0 + slope2) : sqrt(1.0 - u.x);
            float r = sqrt(max(0.0, 1.0 - z * z));
            vec3 d = vec3(r * cos(phi), r * sin(phi), z);
            wi = aboutMirror ? reflect(-wo, d) : d;
        }
        if (wi.z <= 0.0) continue;
        vec3 h = normalize(wi + wo);
        float c = h.z * h.z * (alpha2 - 1.0) + 1.0;
        float lobe = alpha2 / (PI * c * c) * h.z / (4.0 * max(dot(wo, h), 1e-4));
        vec4 sky = skyTexel(frame * wi);
        float density = (wi.z / PI + lobe + sky.a) / 3.0;
        sum += materialBrdf(wo, wi) * (wi.z / density) * sky.rgb;
    }
    return sum / float(SAMPLES);
}
