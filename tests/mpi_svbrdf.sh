#!/bin/sh
# mpi_svbrdf.sh PROGRAM: `hshfit-mpi svbrdf` with 1 to 4 processes writes the bytes of
# `hshfit svbrdf`; a process that fails or is killed leaves nothing.
# Ends with 77, and the reason, where MPI is absent.
set -eu
program=$1
alone=$(dirname "$program")/hshfit
command -v mpirun >/dev/null || { echo "skipped: mpirun is not installed"; exit 77; }
[ -x "$program" ] || { echo "skipped: built without -DHSHFIT_MPI=ON"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none

fail() { echo "$1" >&2; exit 1; }
# ranks COUNT ARGUMENT…: hshfit-mpi svbrdf with so many processes, one thread each.
ranks() {
    count=$1
    shift
    mpirun --oversubscribe -n "$count" "$program" svbrdf "$@" --threads 1 --quiet
}

# Grey PFM maps of 256 x 256 texels, one of them with a NaN.
python=$(command -v python3) || { echo "skipped: python3 is not installed"; exit 77; }
"$python" - "$work" <<'END'
import json, math, struct, sys
side, folder = 256, sys.argv[1]
def write(name, value):
    with open(f"{folder}/{name}.pfm", "wb") as file:
        file.write(f"Pf\n{side} {side}\n-1.0\n".encode())
        for y in reversed(range(side)):
            file.write(struct.pack(f"<{side}f", *(value(x, y) for x in range(side))))
write("alpha", lambda x, y: 0.4 + 0.3 * math.sin(x * 0.11) * math.cos(y * 0.07))
write("kd", lambda x, y: 0.2 + 0.1 * math.sin(x * y * 0.001))
parameters = {"alpha": {"map": "alpha.pfm"}, "kd": {"map": "kd.pfm"}, "ks": 0.5}
head = {"format": "hshfit-svbrdf", "version": 1, "model": "ggx"}
json.dump(head | {"parameters": parameters}, open(f"{folder}/d.json", "w"))
write("bad", lambda x, y: math.nan if (x, y) == (3, 250) else 0.5)
json.dump(head | {"parameters": parameters | {"kd": {"map": "bad.pfm"}}},
          open(f"{folder}/bad.json", "w"))
# Normals, of 50 x 261 texels: sides that are odd. One of the second map points downwards.
def normals(name, spoilt):
    with open(f"{folder}/{name}.pfm", "wb") as file:
        file.write(b"PF\n50 261\n-1.0\n")
        for y in reversed(range(261)):
            for x in range(50):
                u, v = 0.3 * math.sin(x * 1.7 + y * 0.1), 0.2 * math.cos(y * 1.3)
                length = math.sqrt(1 + u * u + v * v) * (-1 if (x, y) == spoilt else 1)
                file.write(struct.pack("<3f", u / length, v / length, 1 / length))
    json.dump(head | {"parameters": {"alpha": 0.3, "kd": 0.2}, "normal": {"map": f"{name}.pfm"}},
              open(f"{folder}/{name}.json", "w"))
normals("turned", None)
normals("below", (7, 200))
END

# Three processes have unequal shares of each map; the first map of each kind has one, two and four
# as well.
counts="1 2 4"
# shellcheck disable=SC2086  # a form with its options
for form in outgoing low-rank "clusters --clusters 32" "halfway --clusters 2 --halfway 3,2,1"; do
    rm -rf "$work/alone" "$work/shared"
    "$alone" svbrdf "$work/d.json" -o "$work/alone" --form $form --quiet >/dev/null
    for count in 3 $counts; do
        ranks $count "$work/d.json" -o "$work/shared" --form $form --force --json --memory 16 \
            >"$work/said"
        grep -q "\"processes\": $count," "$work/said" || fail "$count processes do not say so"
        diff -r "$work/alone" "$work/shared" || fail "$form with $count processes"
    done
    counts=
done

# Coordinates in a library, of fewer texels, which take longer.
maps=$(dirname "$0")/../examples/maps
in_library="--form library --components 3 --checks 2 --force"
# shellcheck disable=SC2086
"$alone" svbrdf "$maps/coin.json" -o "$work/library" $in_library --quiet >/dev/null
# shellcheck disable=SC2086
ranks 3 "$maps/coin.json" -o "$work/shared-library" $in_library >/dev/null
diff -r "$work/library" "$work/shared-library" || fail "library with 3 processes"

# Forms of turned texels: the choice by measurement, measured levels, and their picture.
counts="1 2 4"
# shellcheck disable=SC2086
for call in "$work/turned.json --form harmonics --harmonics 5 --checks 0" \
    "$work/turned.json --checks 8" \
    "$work/turned.json --form ellipse --mips none" \
    "$maps/bumpy.json --form ellipse --checks 1" \
    "$maps/brushed.json --form harmonics --harmonics 9 --checks 1"; do
    rm -rf "$work/alone" "$work/shared"
    "$alone" svbrdf $call -o "$work/alone" --quiet --json >"$work/said.alone"
    for count in 3 $counts; do
        ranks $count $call -o "$work/shared" --force --json >"$work/said"
        grep -q "\"processes\": $count," "$work/said" || fail "$count processes do not say so"
        diff -r "$work/alone" "$work/shared" || fail "$call with $count processes"
        # Numbers of the answer, but for times and places.
        for file in said said.alone; do
            grep -vE '"(processes|seconds|texels_per_second)"|/material|/harmonics|/errors' \
                "$work/$file" | grep -v '"folder"' >"$work/$file.numbers"
        done
        diff "$work/said.alone.numbers" "$work/said.numbers" || fail "the answer to $call"
    done
    counts=
done

# One line, the exit code, and nothing on the disk.
broken() {
    code=0
    ranks 3 "$work/$1.json" -o "$work/bad" >"$work/said" 2>"$work/errors" || code=$?
    [ $code = 3 ] || fail "a broken map ends with $code"
    [ "$(grep -c '^hshfit: ' "$work/errors")" = 1 ] || fail "not one line: $(cat "$work/errors")"
    grep -q "$2" "$work/errors" || fail "$(cat "$work/errors")"
    [ ! -e "$work/bad" ] || fail "a broken map leaves a folder"
}
broken bad 'texel (3, 250): kd is nan'
broken below 'texel (7, 200): the normal is'

# A process that fails in the middle: only one has a limit on the size of files.
# shellcheck disable=SC2016  # expanded by the inner shell
limited='[ "$OMPI_COMM_WORLD_RANK" != 1 ] || { trap "" XFSZ; ulimit -f 64; }; exec "$@"'
# shellcheck disable=SC2086
for call in "$work/d.json --writes cached" \
    "$work/turned.json --form harmonics --harmonics 5 --checks 0"; do
    code=0
    mpirun --oversubscribe -n 2 sh -c "$limited" sh "$program" svbrdf $call -o "$work/cut" \
        --threads 1 >"$work/said" 2>"$work/errors" || code=$?
    [ $code = 5 ] || fail "a full disk ends with $code: $(cat "$work/errors")"
    [ "$(grep -c '^hshfit: ' "$work/errors")" = 1 ] || fail "not one line: $(cat "$work/errors")"
    grep -q 'process 2 of 2: .*File too large' "$work/errors" || fail "$(cat "$work/errors")"
    [ ! -e "$work/cut" ] || fail "a full disk leaves a folder"
done

# One that is killed takes the others along, and the file under its temporary name.
# shellcheck disable=SC2016
killed='[ "$OMPI_COMM_WORLD_RANK" != 1 ] || { (sleep 0.3; kill -9 $$) & }; exec "$@"'
for form in outgoing clusters; do
    if mpirun --oversubscribe -n 2 sh -c "$killed" sh "$program" svbrdf "$work/d.json" \
        -o "$work/killed" --form $form --checks 4096 --threads 1 >/dev/null 2>&1; then
        echo "ended before it was killed"
    fi
    if [ -e "$work/killed" ] && [ "$(find "$work/killed" -type f | wc -l)" != 3 ]; then
        fail "a killed process leaves $(ls -A "$work/killed")"
    fi
    rm -rf "$work/killed"
done

# The plain program does not do the work twice, nor does hshfit-mpi with another command.
code=0
mpirun --oversubscribe -n 2 "$alone" svbrdf "$work/d.json" -o "$work/twice" 2>"$work/errors" ||
    code=$?
[ $code = 2 ] || fail "the plain program ends with $code"
grep -q 'hshfit-mpi svbrdf' "$work/errors" || fail "$(cat "$work/errors")"
[ ! -e "$work/twice" ] || fail "the plain program writes under mpirun"
code=0
mpirun --oversubscribe -n 2 "$program" info ggx:alpha=0.2 >"$work/said" 2>&1 || code=$?
[ $code = 2 ] || fail "a command that is not shared ends with $code"
echo "1 to 4 processes give the same bytes"
