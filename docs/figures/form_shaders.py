#!/usr/bin/python3
"""The table of docs/shaders.md: forms as shaders, and a published network by the same rules.

    docs/figures/form_shaders.py build/hshfit FILE.json…

For each coefficient file: its error and that of its export, bytes, and the instructions of a SPIR-V
function around `eval`, with numbers as constants and as a texture. The last row is the network of
Sztrajman et al. 2021 (6, 21, 21 and 3 values a layer, 675 weights in single precision, ReLU),
unrolled as constants, with the half and the difference vector that it takes; the count does not
depend on the weights. Programs: glslangValidator (with --target-env vulkan1.1), spirv-opt -O and
spirv-dis.
"""

import json
import os
import random
import subprocess
import sys
import tempfile

COLUMNS = ("file", "numbers", "bytes", "mean log, file", "mean log, export",
           "instructions, constants", "instructions, texture")
MAIN = """#version 450
%s
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Input { vec4 inputs[]; };
layout(std430, binding = 4) writeonly buffer Output { vec4 outputs[]; };
void main() {
    int k = int(gl_GlobalInvocationID.x);
    outputs[k] = vec4(hsh_eval(inputs[2 * k].xyz, inputs[2 * k + 1].xyz), 0.0);
}
"""


def row(cells):
    return "| " + " | ".join(cells) + " |"


def instructions(snippet, folder):
    """Instructions within functions, after optimisation for speed."""
    source, code = folder + "/s.comp", folder + "/s.spv"
    with open(source, "w", encoding="ascii") as file:
        file.write(MAIN % snippet)
    subprocess.run(["glslangValidator", "-V", "--target-env", "vulkan1.1", source, "-o", code],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["spirv-opt", "-O", code, "-o", code], check=True)
    text = subprocess.run(["spirv-dis", "--no-color", code], check=True, capture_output=True,
                          text=True).stdout
    inside, count = False, 0
    for line in text.splitlines():
        words = line.split()
        inside = inside or "OpFunction" in words
        count += inside and not line.startswith(";")
        inside = inside and "OpFunctionEnd" not in words
    return count


def export(program, path, folder, storage):
    subprocess.run([program, "export", path, "-o", folder, "--name", "x", "--force", "--quiet",
                    "--target", "bin,glsl", "--no-error", "--storage", storage], check=True,
                   stdout=subprocess.DEVNULL)
    with open(folder + "/x_hsh.glsl", encoding="ascii") as file:
        return file.read()


def number(generator):
    return "%.8g" % generator.uniform(-1, 1)


def layer(names, size, out, generator, relu):
    """A layer in four-vectors, the zeros of the last one left out."""
    lines = []
    for i in range(size):
        terms = [number(generator)]
        for k in range(0, len(names) - 3, 4):
            weights = ", ".join(number(generator) for _ in range(4))
            terms.append("dot(vec4(%s), vec4(%s))" % (weights, ", ".join(names[k:k + 4])))
        for k in range(len(names) - len(names) % 4, len(names)):
            terms.append("%s * %s" % (number(generator), names[k]))
        total = " + ".join(terms)
        lines.append("    float %s%d = %s;" % (out, i, "max(%s, 0.0)" % total if relu else total))
    return lines, ["%s%d" % (out, i) for i in range(size)]


def network():
    generator = random.Random(1)
    lines = [
        "vec3 hsh_eval(vec3 wo, vec3 wi) {",
        "    if (wo.z <= 0.0 || wi.z <= 0.0) { return vec3(0.0); }",
        "    vec3 h = normalize(wo + wi);",
        "    float across = max(sqrt(h.x * h.x + h.y * h.y), 1e-12);",
        "    vec3 d = vec3(h.z * (h.x * wi.x + h.y * wi.y) / across - across * wi.z,",
        "                  (h.x * wi.y - h.y * wi.x) / across, dot(h, wi));",
    ]
    names = ["h.x", "h.y", "h.z", "d.x", "d.y", "d.z"]
    for size, out, relu in ((21, "a", True), (21, "b", True), (3, "c", False)):
        more, names = layer(names, size, out, generator, relu)
        lines += more
    lines.append("    return exp(max(vec3(c0, c1, c2), 0.0)) - 1.0;")
    return "\n".join(lines + ["}"])


def measured(program, path, folder):
    answer = json.loads(subprocess.run(
        [program, "export", path, "-o", folder, "--name", "x", "--force", "--quiet", "--json",
         "--target", "bin"], check=True, capture_output=True, text=True).stdout)
    error = answer["fit_error"]
    shown = [("%.4g" % error[key]) if key in error else "unknown" for key in ("file", "mean_log")]
    return [str(answer["numbers"]), str(answer["bytes"])] + shown


def main(program, paths):
    print(row(COLUMNS))
    print("|" + "---|" * len(COLUMNS))
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            cells = measured(program, path, folder)
            for storage in ("constants", "texture"):
                snippet = export(program, path, folder, storage)
                cells.append(str(instructions(snippet, folder)))
            print(row(["`%s`" % os.path.basename(path)] + cells), flush=True)
        print(row(["network, 675 weights", "675", str(4 * 675), "", "",
                   str(instructions(network(), folder)), ""]))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
