#!/bin/sh
# Checks that every optional part may be absent. In a bare root in which `./run test` has passed,
# it removes one package at a time, configures, builds and runs the tests that use it. No test
# may fail, and skipped ones have to name the missing part. It removes packages, so it runs in a
# bare root only, after a build there:
#   tests/bare_root.sh sh -c './run test && tests/optional_parts.sh'
set -eu
cd "$(dirname "$0")/.."
[ "${HSHFIT_BARE_ROOT:-}" = yes ] ||
    { echo "optional_parts: removes packages; run it through tests/bare_root.sh" >&2; exit 2; }

# Package or folder | tests that use it | text that a skipped test prints
parts='
libvulkan-dev|^ShaderProof.*Vulkan|built without Vulkan (libvulkan-dev)
glslang-dev|^SpirvModule|built without Vulkan (libvulkan-dev)
mesa-vulkan-drivers|^ShaderProof.*Vulkan|mesa-vulkan-drivers
libopengl-dev|^ShaderProof.*OpenGl|built without EGL (libegl-dev, libgl-dev, libopengl-dev)
libegl-dev|^ShaderProof.*OpenGl|built without EGL (libegl-dev, libgl-dev, libopengl-dev)
libgl-dev|^ShaderProof.*OpenGl|built without EGL (libegl-dev, libgl-dev, libopengl-dev)
glslang-tools|^ShaderProof.*Vulkan|glslangValidator is not installed (glslang-tools)
spirv-tools|^ShaderProof.*Vulkan|spirv-val is not installed (spirv-tools)
nodejs|^ShaderProof.Wgsl|^GpuBrowser.Web|nodejs
tests/gpu/node_modules|^Shader.*[Ww]gsl|^GpuIndependent|^GpuBrowser.Web|npm
chromium|^GpuBrowser.Web|chromium is not installed
openimageio-tools|Independent|no oiiotool (package openimageio-tools)
openexr|Independent|no exrheader (package openexr)
python3-numpy|Independent|MerlHybrid|numpy
python3-jsonschema|Schema|jsonschema
gnuplot-nox|Comparison|Render|Report|gnuplot
'

failed=0
log=$(mktemp)
echo "$parts" | while IFS= read -r row; do
    [ -n "$row" ] || continue
    part=${row%%|*}
    text=${row##*|}
    pattern=${row#*|}
    pattern=${pattern%|*}
    if [ -d "$part" ]; then
        mv "$part" "$part.away"
    else
        apt-get -q -y remove "$part" >"$log" 2>&1
    fi
    code=0
    { cmake --fresh --preset release --log-level=WARNING && cmake --build --preset release &&
        ctest --preset release -R "$pattern" --verbose; } >"$log" 2>&1 || code=$?
    skipped=$(grep -c '\*\*\*Skipped' "$log" || true)
    said=$(grep -cF "$text" "$log" || true)
    if [ -d "$part.away" ]; then
        mv "$part.away" "$part"
    else
        ./run configure test >/dev/null 2>&1
    fi
    if [ "$code" = 0 ] && [ "$skipped" -gt 0 ] && [ "$said" -gt 0 ]; then
        echo "optional_parts: without $part: configures, builds, $skipped tests skipped"
    else
        echo "optional_parts: without $part: code $code, $skipped skipped, '$text' $said times"
        tail -n 15 "$log"
        failed=1
    fi
    [ "$failed" = 0 ] || touch "$log.failed"
done
[ ! -e "$log.failed" ] || exit 1
echo "optional_parts: every part may be absent"
