// f from the reference table: cube roots of f cos(theta_d), bilinear in the texture, linear by hand
// between its layers (lib/hshfit/gpu/viewer_reference.h has the layout).
uniform sampler2DArray exactTable;

// Two neighbours and the share of the way between them, from 0 to 1.
vec3 nodesAbout(float x, int count) {
    float place = clamp(x, 0.0, 1.0) * float(count - 1);
    float first = min(floor(place), float(max(count - 2, 0)));
    return vec3(first, min(first + 1.0, float(count - 1)), place - first);
}

vec3 azimuthNodes(float angle) {
    float period = EXACT_MIRRORED ? 2.0 * EXACT_RANGE : EXACT_RANGE;
    float rest = angle - period * floor(angle / period);
    if (EXACT_MIRRORED) return nodesAbout(min(rest, period - rest) / EXACT_RANGE, EXACT_AZIMUTHS);
    float place = rest / EXACT_RANGE * float(EXACT_AZIMUTHS);
    float first = min(floor(place), float(EXACT_AZIMUTHS - 1));
    return vec3(first, mod(first + 1.0, float(EXACT_AZIMUTHS)), place - first);
}

vec2 halfPlace(vec2 h) {
    vec2 s = sqrt(abs(h));
    return EXACT_BILATERAL ? s : 0.5 + 0.5 * sign(h) * s;
}

vec3 exactBrdf(vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    vec3 sum = wi + wo;
    float across = length(sum.xy), along = length(sum);
    vec2 turn = across > 0.0 ? sum.xy / across : vec2(1.0, 0.0);
    float thetaD = atan(length(wi - wo), along) / EXACT_LAST_THETA;
    float phi = atan(along * (turn.x * wi.y - turn.y * wi.x),
                     sum.z * dot(turn, wi.xy) - across * wi.z);
    vec2 place;
    vec3 rest = vec3(0.0);
    if (EXACT_ISOTROPIC) {
        place = vec2(sqrt(atan(across, sum.z) / (0.5 * PI)), thetaD);
    } else {
        phi += atan(turn.y, turn.x);
        if (EXACT_BILATERAL && sum.x < 0.0) phi = PI - phi;
        if (EXACT_BILATERAL && sum.y < 0.0) phi = -phi;
        place = halfPlace(sum.xy / along);
        rest = nodesAbout(thetaD, EXACT_REST);
        rest.xy *= float(EXACT_AZIMUTHS);
    }
    vec3 azimuth = azimuthNodes(phi);
    vec2 size = vec2(textureSize(exactTable, 0).xy);
    vec2 uv = (clamp(place, 0.0, 1.0) * (size - 1.0) + 0.5) / size;
    vec3 root = mix(textureLod(exactTable, vec3(uv, rest.x + azimuth.x), 0.0).rgb,
                    textureLod(exactTable, vec3(uv, rest.x + azimuth.y), 0.0).rgb, azimuth.z);
    if (!EXACT_ISOTROPIC) {
        vec3 next = mix(textureLod(exactTable, vec3(uv, rest.y + azimuth.x), 0.0).rgb,
                        textureLod(exactTable, vec3(uv, rest.y + azimuth.y), 0.0).rgb, azimuth.z);
        root = mix(root, next, rest.z);
    }
    return root * root * root / (0.5 * along);
}

vec3 materialBrdf(vec3 wo, vec3 wi) { return exactBrdf(wo, wi); }
