// What the exported snippet above gives, as the viewer asks for it.
uniform bool clampNegative;
uniform float skyZonal[SKY_LIGHTS * SKY_ORDER];  // [light][l]

{{addLight}}
vec3 asColour(float value) { return vec3(value); }
vec3 asColour(vec3 value) { return value; }

vec3 pointResponse(vec3 wo, vec3 wi) {
    vec3 value = clampNegative ? asColour(FIT_EVAL(wo, wi)) : asColour(FIT_RAW(wo, wi));
    return FIT_HAS_COSINE ? value : value * wi.z;
}

vec3 environmentResponse(vec3 wo, mat3 frame) {
    vec3 sky[SKY_ORDER * SKY_ORDER];
    for (int j = 0; j < SKY_ORDER * SKY_ORDER; ++j) sky[j] = vec3(0.0);
    for (int k = 0; k < SKY_LIGHTS; ++k) {
        addLight(transpose(frame) * skyAxis[k], skyColour[k], k * SKY_ORDER, sky);
    }
    vec3 value = asColour(FIT_SHADE(wo, sky));
    return clampNegative ? max(value, vec3(0.0)) : value;
}
