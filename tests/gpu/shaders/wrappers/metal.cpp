{{snippet}}

int main(int, char** arguments) {
    return stub::runAll(arguments[1], arguments[2], [](int k, float* out) {
        const texture2d_array<float> coefficients{&stub::job.coefficients}, basis{&stub::job.basis};
        const sampler s;
        const float* n = stub::job.numbers.data();
        const float3 wo(n[6 * k], n[6 * k + 1], n[6 * k + 2]);
        const float3 wi(n[6 * k + 3], n[6 * k + 4], n[6 * k + 5]);
        hsh_Environment env;
        for (int j = 0; j < {{environment}}; ++j) {
            for (int i = 0; i < {{lights}}; ++i) env.sh[j]{{v}}[i] = n[{{first}} + j * {{lights}} + i];
        }
        (void)basis;
        {{type}} raw = hsh_evalRaw(coefficients, {{#tabulated}}basis, {{/tabulated}}s, wo, wi);
        {{type}} q = hsh_eval(coefficients, {{#tabulated}}basis, {{/tabulated}}s, wo, wi);
        {{lightElement}} lit = hsh_shade(coefficients, s, wo, env);
        for (int i = 0; i < {{channels}}; ++i) {
            out[i] = raw{{of}};
            out[{{channels}} + i] = q{{of}};
        }
        for (int i = 0; i < {{lights}}; ++i) out[2 * {{channels}} + i] = lit{{v}}[i];
    });
}
