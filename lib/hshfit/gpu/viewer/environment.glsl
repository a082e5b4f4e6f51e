// The light: a latitude-longitude picture in a world of its own with +z up, constant within a texel;
// the fourth number is the density by which skyDirection() chooses directions.
uniform highp sampler2D skyPicture, skyAlias;
uniform mat3 skyToWorld;

vec4 skyTexel(vec3 direction) {
    vec3 d = transpose(skyToWorld) * direction;
    vec2 size = vec2(textureSize(skyPicture, 0));
    vec2 place = vec2(0.5 - atan(d.y, d.x) / 6.28318530717959,
                      acos(clamp(d.z, -1.0, 1.0)) / 3.14159265358979);
    return texelFetch(skyPicture, ivec2(clamp(place * size, vec2(0.0), size - 1.0)), 0);
}

// A direction by the light that comes from it (Walker's alias method): `u` chooses a texel, `share`
// that or its alias, `within` the place in it; all in [0, 1).
vec3 skyDirection(float u, float share, vec2 within) {
    ivec2 size = textureSize(skyPicture, 0);
    int count = size.x * size.y, k = min(int(u * float(count)), count - 1);
    vec2 choice = texelFetch(skyAlias, ivec2(k % size.x, k / size.x), 0).xy;
    if (share >= choice.x) k = int(choice.y);
    ivec2 at = ivec2(k % size.x, k / size.x);
    vec2 rows = cos(3.14159265358979 * (float(at.y) + vec2(0.0, 1.0)) / float(size.y));
    float z = mix(rows.x, rows.y, within.y), r = sqrt(max(0.0, 1.0 - z * z));
    float phi = 3.14159265358979 - 6.28318530717959 * (float(at.x) + within.x) / float(size.x);
    return skyToWorld * vec3(r * cos(phi), r * sin(phi), z);
}
