#define HSH_SAMPLER s1
#define HSH_BASIS_TEXTURE t2
{{snippet}}
RWStructuredBuffer<float> inputs : register(u3);
RWStructuredBuffer<float> outputs : register(u4);

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {
    int k = int(id.x);
    float3 wo = float3(inputs[6 * k], inputs[6 * k + 1], inputs[6 * k + 2]);
    float3 wi = float3(inputs[6 * k + 3], inputs[6 * k + 4], inputs[6 * k + 5]);
    {{lightElement}} env[{{environment}}];
    for (int j = 0; j < {{environment}}; ++j) {
        for (int i = 0; i < {{lights}}; ++i) env[j]{{v}}[i] = inputs[{{first}} + j * {{lights}} + i];
    }
    {{type}} raw = hsh_evalRaw(wo, wi);
    {{type}} q = hsh_eval(wo, wi);
    {{lightElement}} lit = hsh_shade(wo, env);
    int o = k * {{outputs}};
    for (int c = 0; c < {{channels}}; ++c) {
        int i = c;
        outputs[o + i] = raw{{of}};
        outputs[o + {{channels}} + i] = q{{of}};
    }
    for (int l = 0; l < {{lights}}; ++l) outputs[o + 2 * {{channels}} + l] = lit{{v}}[l];
}
