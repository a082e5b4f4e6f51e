#!/bin/sh
# check.sh BUILD: packs the shaders of a few tests (../device.sh) and checks them on the renderers
# in software: unchanged, with a fault in one of them, which has to be found, and without any
# driver. 77 where nothing can be packed or run.
set -eu
script=$(dirname "$0")/../device.sh
skip() {
    echo "skipped: $1"
    exit 77
}
wrong() {
    cat "$folder/log"
    echo "check.sh: $1" >&2
    exit 1
}
# answer CODE COMMAND…: runs the command, whose exit code has to be CODE.
answer() {
    wanted=$1
    shift
    code=0
    "$@" >"$folder/log" 2>&1 || code=$?
    [ "$code" -eq "$wanted" ] || wrong "exit code $code of $*"
}
says() {
    grep -q "$1" "$folder/log" || wrong "no line with '$1'"
}

for tool in glslangValidator spirv-val python3; do
    command -v "$tool" >/dev/null || skip "$tool is not installed"
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
answer 0 "$script" pack "$1" "$folder/shaders.tar.gz" \
    'HalfwayShader.Glsl*On*:LightingShader.Glsl*:LightingShader.SpirvModules*'
answer 0 "$script" check "$folder/shaders.tar.gz"
says '^| halfway | [1-9][0-9]* of [1-9]'
says '^| lighting | 4 of 4, .*| 4 of 4, .*| 4 of 4, '
says '^| lighting, modules | 4 of 4, '
says '^| network, 675 weights | [0-9.e+]* | [0-9.]* | 1.00 |$'
cat "$folder/log"

# The program of one shader for OpenGL writes values that are a hundredth too large.
tar -C "$folder" -xzf "$folder/shaders.tar.gz"
shaders=$folder/device/shaders
for one in "$shaders"/halfway*OpenGL_glsl.json; do
    program=$shaders/numbers/$(sed -n 's/.*"program": "\(.*\)".*/\1/p' "$one")
    break
done
sed -i 's/outputs\[o + i\] = raw/outputs[o + i] = 1.01 * raw/' "$program"
grep -q '1\.01' "$program" || wrong "no place for the fault"
rm "$shaders"/timed*
answer 1 "$folder/device/device.sh" check
says '^FAILED: halfway, .*, OpenGL, glsl: differs by'
[ "$(grep -c '^FAILED' "$folder/log")" -eq 1 ] || wrong "more than one shader fails"

answer 2 env VK_DRIVER_FILES=/none VK_ICD_FILENAMES=/none __EGL_VENDOR_LIBRARY_FILENAMES=/none \
    "$folder/device/device.sh" check
says '^no Vulkan device: '
says '^no device of OpenGL: '
says '^device.sh: neither Vulkan nor EGL has a device here'
