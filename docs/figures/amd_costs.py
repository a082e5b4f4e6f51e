#!/usr/bin/python3
"""Instructions, registers and inverse throughput of every form and lighting shader on an AMD GPU.

    docs/figures/amd_costs.py build ../shared/data
    docs/figures/amd_costs.py build                    the first three rows, as a test

No card is needed: Mesa's driver compiles for the one that RADV_FORCE_FAMILY names (navi21 unless
set; `tests/gpu/shaders/amd_costs`). `build` is the folder of the build with `hshfit` and that
program; further ones are glslangValidator (with --target-env vulkan1.1) and spirv-opt -O. Each
shader is a compute shader that reads a pair and writes three numbers; one that does only this is
the first row, and the second is the formula of GGX with Lambert. Inverse throughput is in cycles of
the busiest unit for a wave of 64 threads, as the compiler estimates it.
"""

import json
import os
import subprocess
import sys
import tempfile

import form_shaders
from form_shaders import EVAL, OF_FORM, OF_LIBRARY, row

GGX = """
vec3 hsh_eval(vec3 wo, vec3 wi) {
    vec3 h = normalize(wo + wi);
    float a2 = 0.04, t = h.z * h.z * (a2 - 1.0) + 1.0;
    float d = a2 / (3.14159265 * t * t);
    float v = 0.5 / (wi.z * sqrt(wo.z * wo.z * (1.0 - a2) + a2)
                     + wo.z * sqrt(wi.z * wi.z * (1.0 - a2) + a2));
    float c = 1.0 - dot(wi, h), c2 = c * c;
    vec3 f0 = vec3(0.9, 0.6, 0.3);
    return vec3(0.1, 0.05, 0.02) + d * v * (f0 + (1.0 - f0) * (c2 * c2 * c));
}
"""
FORMS = (("--form halfway", ("constants", "texture")),
         ("--form halfway --halfway 4,3,3", ("constants", "texture")),
         ("--form halfway --halfway 5,4,3", ("constants", "texture")),
         ("--form halfway --halfway 8,4,3", ("constants", "texture")),
         ("--form halfway --halfway 13,12,8", ("constants", "texture")),
         ("--form basis --basis zernike --order 4 --reciprocal", ("constants",)),
         ("--form basis --basis zernike --order 8 --reciprocal", ("constants",)),
         ("--basis hsh --order 8 --outgoing 16", ("texture",)))
# The call of each lighting function; light is in the buffer.
LIGHTING = (("prefiltered", "hsh_prefiltered(wi, wo)", ""),
            ("split-sum", "hsh_splitSum(wi, wo, light)", "vec3 light[9];"),
            ("coefficients", "hsh_coefficients(wi, wo, light)", "vec3 light[25];"),
            ("ltc", "hsh_ltc(wi, wo, light[0], light[1], light[2], light[3])", "vec3 light[4];"))


def run(program, *arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def text(path):
    with open(path, encoding="ascii") as file:
        return file.read()


class Shaders:
    """Shaders to be compiled, by name."""

    def __init__(self, folder):
        self.folder, self.names = folder, []

    def add(self, name, snippet, body):
        form_shaders.compiled(snippet, body, self.folder, str(len(self.names)))
        self.names.append(name)

    def table(self, build):
        paths = ["%s/%d.spv" % (self.folder, k) for k in range(len(self.names))]
        try:
            device, *lines = run(build + "/tests/gpu/shaders/amd_costs", *paths).splitlines()
        except subprocess.CalledProcessError as error:
            print(error.stderr, end="", file=sys.stderr)
            return error.returncode
        print(row(("shader", "instructions", "vector registers", "spilled", "inverse throughput")))
        print("|" + "---|" * 5)
        for name, line in zip(self.names, lines):
            print(row([name] + line.split()[:4]))
        print("\n" + device)
        return 0


def main(build, data):
    program = build + "/hshfit"
    with tempfile.TemporaryDirectory() as folder:
        shaders = Shaders(folder)
        shaders.add("nothing", form_shaders.COPY, OF_FORM)
        shaders.add("GGX + Lambert", GGX, OF_FORM)
        shaders.add("network, 675 weights", form_shaders.network(), OF_FORM)
        if not data:
            return shaders.table(build)
        satin = data + "/rgl/satin_rosaline_rgb.bsdf"
        for words, storages in FORMS:
            path = folder + "/form.json"
            # The basis form does not hold satin; its cost is that of any isotropic BRDF.
            source = "ggx:alpha=.6,F0=.9/.6/.3" if "form basis" in words else satin
            run(program, "project", source, *words.split(), "--precision", "half", "-o", path,
                "--force", "--quiet")
            for storage in storages:
                where = ["--storage", storage] if "form" in words else []
                run(program, "export", path, "-o", folder, "--name", "x", "--force", "--quiet",
                    "--target", "bin,glsl", "--no-error", "--no-sampling", *where)
                shaders.add("`%s`, %s" % (words, storage), text(folder + "/x_hsh.glsl"),
                            OF_FORM)
            if "8,4,3" in words:
                run(program, "export", path, "-o", folder, "--name", "lit", "--force", "--quiet",
                    "--target", "glsl", "--no-error", "--lighting",
                    ",".join(name for name, _, _ in LIGHTING))
        planes = data + "/merl_slices/"
        materials = sorted(planes + name for name in os.listdir(planes) if name.endswith(".slice"))
        for count in (10, 20, 40):
            path = folder + "/planes.library"
            run(program, "library", "learn", *materials, "--components", str(count), "--bytes",
                str(6 * count), "--limit", "1", "--limit-maximum", "10", "--limit-flip", "1", "-o",
                path, "--force", "--quiet")
            for name, error in (("constants", "0"), ("table", "0.1")):
                answer = json.loads(run(program, "library", "export", path, "-o", folder,
                                        "--target", "glsl", "--table-error", error, "--force",
                                        "--json"))
                # The compiler takes a loop of unknown length to be taken once or a few times.
                shader = text("%s/%s" % (folder, answer["files"][0])).replace(
                    "int(bound.w)", str((count + 4) // 4))
                shaders.add("library, %d components, %s" % (count, name), shader, OF_LIBRARY)
        for name, call, light in LIGHTING:
            fill = "for (int i = 0; i < light.length(); ++i) light[i] = inputs[2 * k + i].xyz;"
            shaders.add("lighting `%s`" % name, text("%s/lit_hsh_%s.glsl" % (folder, name)),
                        light + (fill if light else "") + EVAL % call)
        return shaders.table(build)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else None))
