#!/bin/sh
# Builds the core of the program into build-core, without its wings and for this machine alone, as
# ./run demo does, and checks what the program says of the wings. The compiler cache has most
# objects if the whole program was built in build, beside this folder.
set -eu
cd "$(dirname "$0")/.."
folder=build-core
fail() {
    echo "core_alone: $*" >&2
    exit 1
}

# As in the presets (CMakePresets.json), which name the folder build.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=true CCACHE_SLOPPINESS=pch_defines,time_macros
cmake --preset release -B "$folder" --log-level=WARNING -DHSHFIT_WINGS=core -DHSHFIT_TESTS=OFF \
    -DHSHFIT_BENCH=OFF -DHSHFIT_FIGURES=OFF -DHSHFIT_PYTHON=OFF -DHSHFIT_MPI=OFF \
    -DHSHFIT_INSTRUCTION_SETS=own >/dev/null
cmake --build "$folder" --parallel "$(nproc)" --target hshfit
hshfit=$folder/hshfit
work=$folder/tried
rm -rf "$work"
mkdir -p "$work"

"$hshfit" project phong:exponent=22 -o "$work/phong.json" >/dev/null
"$hshfit" report phong:exponent=22 -o "$work/report" >/dev/null
"$hshfit" help | grep -q 'svbrdf *(not built: wing maps)' ||
    fail "help does not say which commands are not built"

# refuses WING FILE WORD…: the command ends with exit code 2 and one line that names the wing, and
# FILE is not written.
refuses() {
    wing=$1
    file=$2
    shift 2
    code=0
    "$hshfit" "$@" >"$work/answer" 2>"$work/message" || code=$?
    [ "$code" = 2 ] || fail "hshfit $*: exit code $code, not 2"
    [ "$(wc -l <"$work/message")" = 1 ] || fail "hshfit $*: more than one line"
    grep -q "the wing '$wing'.*HSHFIT_WINGS" "$work/message" ||
        fail "hshfit $*: does not name the wing $wing: $(cat "$work/message")"
    [ ! -e "$file" ] || fail "hshfit $*: wrote $file"
}
refuses maps "$work/out" svbrdf examples/maps/coin.json -o "$work/out" --form low-rank
refuses scenes "$work/out" plan examples/scenes/matte_room.json -o "$work/out"
refuses scenes "$work/out" illuminate examples/scenes/box.json -o "$work/out"
refuses scenes "$work/out" transfer examples/scenes/ball_and_wall.json -o "$work/out"
refuses studies "$work/out" tradeoff phong:exponent=22 -o "$work/out"
refuses studies "$work/out" choose phong:exponent=22
refuses studies "$work/out" stress
refuses batches "$work/out" batch examples/batch/materials.jsonl -o "$work/out"
refuses library "$work/out" library learn lambert -o "$work/out"
# Files of the wings are known.
printf '{"format": "hshfit-material-map", "version": 1}' >"$work/map.json"
refuses maps "$work/out" eval "$work/map.json:x=1,y=1" --wi 30,0 --wo 30,180
refuses maps "$work/out" export "$work/map.json" -o "$work/out"
# The tensor file of a library of materials: its mark, its version, and the name of its first field.
printf 'tensor_file\0\001\000\001\000\000\000\016\000hshfit_library' >"$work/studio.library"
refuses library "$work/out" info "$work/studio.library:paint"

cmake --install "$folder" --prefix "$work/installed" >/dev/null
[ -x "$work/installed/bin/hshfit" ] || fail "the program is not installed"
[ ! -e "$work/installed/include" ] || fail "headers are installed without their libraries"
echo "core_alone: the core stands by itself"
