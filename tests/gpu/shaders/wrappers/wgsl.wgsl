{{snippet}}
@group(0) @binding(3) var<storage, read_write> inputs: array<f32>;
@group(0) @binding(4) var<storage, read_write> outputs: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let k = i32(id.x);
    let wo = vec3<f32>(inputs[6 * k], inputs[6 * k + 1], inputs[6 * k + 2]);
    let wi = vec3<f32>(inputs[6 * k + 3], inputs[6 * k + 4], inputs[6 * k + 5]);
    var env: array<{{lightElement}}, {{environment}}>;
    for (var j = 0; j < {{environment}}; j++) {
        for (var i = 0; i < {{lights}}; i++) { env[j]{{v}}[i] = inputs[{{first}} + j * {{lights}} + i]; }
    }
    var raw = hsh_evalRaw(wo, wi);
    var q = hsh_eval(wo, wi);
    var lit = hsh_shade(wo, env);
    let o = k * {{outputs}};
    for (var i = 0; i < {{channels}}; i++) {
        outputs[o + i] = raw{{of}};
        outputs[o + {{channels}} + i] = q{{of}};
    }
    for (var i = 0; i < {{lights}}; i++) { outputs[o + 2 * {{channels}} + i] = lit{{v}}[i]; }
}
