// What the exported snippet above gives, as the viewer asks for it.
uniform bool clampNegative;
uniform vec3 skyLight[SKY_ORDER * SKY_ORDER];  // coefficients in the world of the pictures

vec3 asColour(float value) { return vec3(value); }
vec3 asColour(vec3 value) { return value; }

vec3 pointResponse(vec3 wo, vec3 wi) {
    vec3 value = clampNegative ? asColour(FIT_EVAL(wo, wi)) : asColour(FIT_RAW(wo, wi));
    return FIT_HAS_COSINE ? value : value * wi.z;
}

vec3 environmentResponse(vec3 wo, mat3 frame) {
    vec3 value = asColour(FIT_SHADE(frame * wo, frame[0], frame[1], frame[2], skyLight));
    return clampNegative ? max(value, vec3(0.0)) : value;
}
