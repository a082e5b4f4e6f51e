#version 300 es
{{snippet}}
uniform highp sampler2D wos, wis, lights;
layout(location = 0) out vec4 out0;
layout(location = 1) out vec4 out1;
layout(location = 2) out vec4 out2;
layout(location = 3) out vec4 out3;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 wo = texelFetch(wos, at, 0).xyz, wi = texelFetch(wis, at, 0).xyz;
    {{lightElement}} env[{{environment}}];
    for (int j = 0; j < {{environment}}; ++j) {
        for (int i = 0; i < {{lights}}; ++i) env[j]{{v}}[i] = texelFetch(lights, ivec2(j, i), 0).x;
    }
    {{type}} raw = hsh_evalRaw(wo, wi);
    {{type}} q = hsh_eval(wo, wi);
    {{lightElement}} lit = hsh_shade(wo, env);
    float o[16];
    for (int i = 0; i < 16; ++i) o[i] = 0.0;
    for (int i = 0; i < {{channels}}; ++i) {
        o[i] = raw{{of}};
        o[{{channels}} + i] = q{{of}};
    }
    for (int i = 0; i < {{lights}}; ++i) o[2 * {{channels}} + i] = lit{{v}}[i];
    out0 = vec4(o[0], o[1], o[2], o[3]);
    out1 = vec4(o[4], o[5], o[6], o[7]);
    out2 = vec4(o[8], o[9], o[10], o[11]);
    out3 = vec4(o[12], o[13], o[14], o[15]);
}
