#!/bin/sh
# Shaders of the tests on the GPU of another machine, which needs a driver with Vulkan or EGL and
# nothing else: no network, no compiler, no display.
#
#     tests/gpu/device.sh pack build shaders.tar.gz   here, where the tests are built
#     tests/gpu/device.sh check shaders.tar.gz        there
#     device.sh check                                 there, in the unpacked folder
#
# pack runs the tests on the renderers in software; each shader that gives what the library computes
# is kept with its inputs and these values. A third argument is a filter of GoogleTest in place of
# the tests of all shaders. check runs them on GPUs where there are any, compares, times functions
# and prints tables (device/device_check.cpp); it takes at most four minutes. Exit codes: 1, a
# shader is out of its bound or the time is over; 2, there is neither Vulkan nor EGL.
set -eu

fail() {
    echo "device.sh: $*" >&2
    exit 2
}

pack() {
    source=$(cd "$(dirname "$0")/../.." && pwd)
    build=$(cd "$1" && pwd)
    filter=${3:-*Vulkan:*OpenGl:*OpenGlEs:SplitShader.*:IrradianceShaders.Run*}
    HSHFIT_KEEP_SHADERS=$folder/device/shaders
    export HSHFIT_KEEP_SHADERS
    mkdir -p "$HSHFIT_KEEP_SHADERS" "$folder/device/lib" "$folder/device/spare"
    for test in shaders/shader_proof shaders/shader_world shaders/irradiance_shader \
        forms/form_shader forms/library_shader lighting/lighting_shader maps/map_shader \
        maps/library_map_shader filtered_maps/filtered_shader proposals/proposal_shader \
        binaries/spirv_module; do
        "$build/tests/gpu/${test}_test" --gtest_filter="$filter-*Slang*" >"$folder/log" ||
            { cat "$folder/log"; fail "$test: a test fails"; }
        grep -A 1 ': Skipped' "$folder/log" | grep -v ': Skipped' | sort -u || true
    done
    PYTHONPATH=$source/docs/figures python3 -c '
import form_shaders
print(form_shaders.network())' >"$folder/network.glsl"
    "$build/tests/gpu/device/timed_forms" "$folder/network.glsl"
    ls "$HSHFIT_KEEP_SHADERS"/*.json >/dev/null 2>&1 || fail "no shader was kept"
    program=$build/tests/gpu/device/device_check
    strip -o "$folder/device/device_check" "$program"
    # The system's libraries of C stay there; those that a driver may need in its own version, and
    # the loaders of Vulkan and EGL, are carried for machines without them.
    libraries="$(ldd "$program" | awk '/=> \// { print $3 }')
        $(/sbin/ldconfig -p | awk '/libvulkan\.so\.1 .*x86-64/ { print $NF }')"
    for library in $libraries; do
        case ${library##*/} in
        libc.so* | libm.so* | libdl.so* | librt.so* | libpthread.so*) ;;
        libstdc++* | libgcc_s* | libEGL* | libGLdispatch* | libvulkan*)
            cp -L "$library" "$folder/device/spare" ;;
        *) cp -L "$library" "$folder/device/lib" ;;
        esac
    done
    cp "$0" "$folder/device/device.sh"
    tar -C "$folder" -czf "$2" device
    echo "$2: $(find "$HSHFIT_KEEP_SHADERS" -name '*.json' | wc -l) shaders," \
        "$(du -m "$2" | cut -f 1) MB"
}

# The first of the files that stands.
first() {
    for file in "$@"; do
        [ ! -e "$file" ] || { echo "$file"; return; }
    done
}

check() {
    if [ $# -gt 0 ]; then
        [ -r "$1" ] || fail "$1: no such bundle; device.sh pack makes one"
        tar -C "$folder" -xzf "$1" 2>/dev/null || fail "$1: no bundle of device.sh pack"
        device=$folder/device
    else
        device=$(cd "$(dirname "$0")" && pwd)
    fi
    [ -x "$device/device_check" ] || fail "$device: no program device_check"
    mkdir "$folder/lib"
    for library in "$device/spare"/*; do
        /sbin/ldconfig -p | grep -qF "${library##*/} " || ln -s "$library" "$folder/lib"
    done
    # Drivers in a folder of their own, as containers have them.
    if [ -z "$(first /usr/share/vulkan/icd.d/*nvidia* /etc/vulkan/icd.d/*nvidia*)" ]; then
        driver=$(first /usr/local/*/share/vulkan/icd.d/*nvidia*)
        [ -z "$driver" ] || export VK_ADD_DRIVER_FILES="${VK_ADD_DRIVER_FILES:-$driver}"
    fi
    if [ -z "$(first /usr/share/glvnd/egl_vendor.d/*nvidia* /etc/glvnd/egl_vendor.d/*nvidia*)" ]
    then
        driver=$(first /usr/local/*/share/glvnd/egl_vendor.d/*nvidia*)
        other=$(first /usr/share/glvnd/egl_vendor.d/*)
        [ -z "$driver" ] || export \
            __EGL_VENDOR_LIBRARY_FILENAMES="${__EGL_VENDOR_LIBRARY_FILENAMES:-$driver:$other}"
    fi
    LD_LIBRARY_PATH=$folder/lib:$device/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} \
        timeout 230 "$device/device_check" "$device/shaders" || {
        code=$?
        [ $code -ne 124 ] || echo "device.sh: the time of 230 s is over" >&2
        [ $code -ne 2 ] || fail "neither Vulkan nor EGL has a device here"
        exit 1
    }
}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
case ${1:-} in
pack)
    shift
    [ $# -ge 2 ] || fail "pack BUILD BUNDLE.tar.gz [FILTER]"
    pack "$@"
    ;;
check)
    shift
    check "$@"
    ;;
*)
    sed -n '2,/^set/{s/^# \{0,1\}//p}' "$0"
    exit 2
    ;;
esac
