#!/usr/bin/python3
"""The tables of docs/results/shaders.md: forms as shaders, and a published network by the same
rules.

    docs/figures/form_shaders.py build FILE.json…

`build` is the folder of the build, with `hshfit`, `tests/gpu/shaders/shader_times` and
`tests/gpu/forms/form_errors`. For each coefficient file: its bytes, its error and the largest
relative change of that error by export, over all languages and storages; the instructions of a
SPIR-V function around `eval` by storage; the time of a pair less that of reading and writing it, on
the Vulkan device of shader_times, and the network's time over it. The last row is the network of
Sztrajman et al. 2021 (6, 21, 21 and 3 values a layer, 675 weights in single precision, ReLU),
unrolled as constants, with the half and the difference vector that it takes; count and time do not
depend on the weights. Programs: glslangValidator (with --target-env vulkan1.1), spirv-opt -O and
spirv-dis. All shaders are timed in turns in one run; on a software device the time is that of the
processor, by all threads.
"""

import json
import os
import random
import subprocess
import sys
import tempfile

COLUMNS = ("file", "bytes", "mean log, file", "change by export", "instructions, constants",
           "texture", "ns a pair, constants", "network's over it")
REPEATS = 41
COPY = "vec3 hsh_eval(vec3 wo, vec3 wi) { return wo + wi; }"
MAIN = """#version 450
%s
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Input { vec4 inputs[]; };
layout(std430, binding = 4) writeonly buffer Output { vec4 outputs[]; };
void main() {
    int k = int(gl_GlobalInvocationID.x);
    vec3 wo = inputs[2 * k].xyz, wi = inputs[2 * k + 1].xyz;
    int material = int(inputs[2 * k].w);
    %s
}
"""
EVAL = "outputs[k] = vec4(%s, 0.0);"
OF_FORM, OF_LIBRARY = EVAL % "hsh_eval(wo, wi)", EVAL % "hsh_material(material, wo, wi)"


def row(cells):
    return "| " + " | ".join(cells) + " |"


def compiled(snippet, body, folder, name):
    """NAME.spv, after optimisation for speed, of a snippet and the work of a pair."""
    source, code = "%s/%s.comp" % (folder, name), "%s/%s.spv" % (folder, name)
    with open(source, "w", encoding="ascii") as file:
        file.write(MAIN % (snippet, body))
    subprocess.run(["glslangValidator", "-V", "--target-env", "vulkan1.1", source, "-o", code],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["spirv-opt", "-O", code, "-o", code], check=True)
    return code


def instructions(snippet, folder, name="s"):
    """Instructions within functions; leaves NAME.spv."""
    code = compiled(snippet, OF_FORM, folder, name)
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
                    "--target", "bin,glsl", "--no-error", "--no-sampling", "--storage", storage],
                   check=True, stdout=subprocess.DEVNULL)
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


def errors(build, paths):
    """For each file bytes, error, and the largest relative change of the error by export."""
    text = subprocess.run([build + "/tests/gpu/forms/form_errors"] + paths, check=True,
                          capture_output=True, text=True).stdout
    rows = []
    for line in text.splitlines():
        answer = json.loads(line)
        error = answer["error"]
        others = [answer[key] for key in answer if key not in ("file", "bytes", "error")]
        change = max(abs(other / error - 1) for other in others)
        rows.append([str(answer["bytes"]), "%.4g" % error, "%.1e" % change])
    return rows


def times(build, folder, names):
    """The device, and for each shader the median of its time in nanoseconds."""
    paths = ["%s/%s.spv" % (folder, name) for name in names]
    lines = subprocess.run([build + "/tests/gpu/shaders/shader_times", str(REPEATS)] + paths,
                           check=True, capture_output=True, text=True).stdout.splitlines()
    return lines[0], [float(line.split()[-2]) for line in lines[1:]]


def main(build, paths):
    print(row(COLUMNS))
    print("|" + "---|" * len(COLUMNS))
    with tempfile.TemporaryDirectory() as folder:
        counts, names = [], ["copy", "network"]
        instructions(COPY, folder, "copy")
        weights = str(instructions(network(), folder, "network"))
        for k, path in enumerate(paths):
            names.append("form%d" % k)
            counts.append([str(instructions(export(build + "/hshfit", path, folder, storage),
                                            folder,
                                            names[-1] if storage == "constants" else "s"))
                           for storage in ("constants", "texture")])
        device, found = times(build, folder, names)
        found = [time - found[0] for time in found]
        for k, cells in enumerate(errors(build, paths)):
            speed = ["%.1f" % found[k + 2], "%.2f" % (found[1] / found[k + 2])]
            print(row(["`%s`" % os.path.basename(paths[k])] + cells + counts[k] + speed))
        print(row(["network, 675 weights", str(4 * 675), "", "", weights, "",
                   "%.1f" % found[1], ""]))
        print("\n" + device)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
