#include "osl_stub.h"
{{snippet}}

int main(int, char** arguments) {
    return stub::runAll(arguments[1], arguments[2], [](int k, float* out) {
        const stub::Array* map = &stub::job.coefficients;
        const float* n = stub::job.numbers.data();
        const vector wo(n[6 * k], n[6 * k + 1], n[6 * k + 2]);
        const vector wi(n[6 * k + 3], n[6 * k + 4], n[6 * k + 5]);
        {{lightElement}} env[{{environment}}];
        for (int j = 0; j < {{environment}}; ++j) {
            for (int i = 0; i < {{lights}}; ++i) env[j]{{v}}[i] = n[{{first}} + j * {{lights}} + i];
        }
        {{type}} raw = hsh_evalRaw(map, wo, wi);
        {{type}} q = hsh_eval(map, wo, wi);
        {{lightElement}} lit = hsh_shade(map, wo, env);
        for (int i = 0; i < {{channels}}; ++i) {
            out[i] = raw{{of}};
            out[{{channels}} + i] = q{{of}};
        }
        for (int i = 0; i < {{lights}}; ++i) out[2 * {{channels}} + i] = lit{{v}}[i];
    });
}
