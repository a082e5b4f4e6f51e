#!/bin/sh
# Checks that the parts math and files of the library are self-contained: copies the tracked files
# without the folders that a part must not use, builds the part there, and runs its tests. The
# part math comes first; the folders of files are then added, so that nothing is built twice.
set -eu
cd "$(dirname "$0")/.."
top=$PWD
copy=$top/build/parts/alone

# The rooms of lib/hshfit that a part of lib/CMakeLists.txt adds, and those before it.
roomsUpTo() {
    sed -n "1,/^hshfit_part($1 /p" lib/CMakeLists.txt |
        sed -n 's/^add_subdirectory(\(hshfit\/.*\))$/lib\/\1/p'
}

# Copies tracked files under PATH….
copyTracked() {
    git ls-files -z -- "$@" | xargs -0 cp --parents --update --target-directory="$copy"
}

mkdir -p "$copy"
ln -sfn "$top/../shared" "$top/build/parts/shared"
find "$copy" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
copyTracked CMakeLists.txt CMakePresets.json cmake lib/CMakeLists.txt 'lib/hshfit/*.h*' \
    tests/CMakeLists.txt 'tests/*.h' tests/places.cpp tests/lib tests/validate_schema.py \
    tests/long_filters.sh docs/figures docs/schemas
rm -rf "$copy/lib/hshfit/"*/

# Steps are joined by &&, because the shell ignores `set -e` in a function that is tested.
standsAlone() {
    cd "$copy" &&
        cmake --preset release --log-level=WARNING -DHSHFIT_PARTS="$1" -DHSHFIT_EXAMPLES=OFF \
            >/dev/null &&
        cmake --build --preset release --parallel "$(nproc)" &&
        ctest --preset release --parallel "$(nproc)" --no-tests=error >"$copy/build/$1.log"
}

# The objects are those of the whole project: the compiler cache has them if it was built before.
for part in math files; do
    for room in $(roomsUpTo "$part"); do copyTracked "$room"; done
    echo "parts_alone: $part with $(roomsUpTo "$part" | wc -l) rooms"
    if ! (standsAlone "$part"); then
        [ ! -e "$copy/build/$part.log" ] || cat "$copy/build/$part.log"
        echo "parts_alone: $part does not stand by itself" >&2
        exit 1
    fi
    grep -E 'tests passed|^Total' "$copy/build/$part.log"
done
