#version 450
#define HSH_BASIS_BINDING binding = 2
{{snippet}}
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Input { float inputs[]; };
layout(std430, binding = 4) writeonly buffer Output { float outputs[]; };

void main() {
    int k = int(gl_GlobalInvocationID.x);
    vec3 wo = vec3(inputs[6 * k], inputs[6 * k + 1], inputs[6 * k + 2]);
    vec3 wi = vec3(inputs[6 * k + 3], inputs[6 * k + 4], inputs[6 * k + 5]);
    {{lightElement}} env[{{environment}}];
    for (int j = 0; j < {{environment}}; ++j) {
        for (int i = 0; i < {{lights}}; ++i) env[j]{{v}}[i] = inputs[{{first}} + j * {{lights}} + i];
    }
    {{type}} raw = hsh_evalRaw(wo, wi);
    {{type}} q = hsh_eval(wo, wi);
    {{lightElement}} lit = hsh_shade(wo, env);
    int o = k * {{outputs}};
    for (int i = 0; i < {{channels}}; ++i) {
        outputs[o + i] = raw{{of}};
        outputs[o + {{channels}} + i] = q{{of}};
    }
    for (int i = 0; i < {{lights}}; ++i) outputs[o + 2 * {{channels}} + i] = lit{{v}}[i];
}
