#!/bin/sh
# The steps of the tests Installed.*: the build folder BUILD is installed into BUILD/installed, and
# outside projects are built against that.
#   tests/install/installed.sh STEP BUILD
set -eu
step=$1
build=$(cd "$2" && pwd)
source=$(cd "$(dirname "$0")/../.." && pwd)
work=$build/installed
prefix=$work/prefix
# Objects of an earlier run serve again where nothing that they include has changed.
if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
strict='-Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion -Wshadow -Werror'

fail() {
    echo "installed: $1" >&2
    exit 1
}
# block LANGUAGE: the blocks of docs/reference/library.md in a language.
block() { "$source/tests/docs/run_pages.py" --script "$source/docs/reference/library.md" "$1"; }
# makeProject NAME FOLDER OPTION…: configures and builds an outside project in $work/NAME.
makeProject() {
    name=$1
    folder=$2
    shift 2
    rm -rf "${work:?}/$name"
    cmake -G Ninja -S "$folder" -B "$work/$name" -DCMAKE_BUILD_TYPE=Release "$@" \
        --no-warn-unused-cli --log-level=WARNING
    cmake --build "$work/$name"
}

case $step in
# The prefix is moved after the installation, so that nothing can depend on its first place.
install)
    rm -rf "$prefix" "$work/first"
    mkdir -p "$work"
    cmake --install "$build" --prefix "$work/first" >"$work/log"
    mv "$work/first" "$prefix"
    ;;
# After `./run demo all` the target hshfit is built and nothing else: a folder with the files of
# this target, those of the configuration and the scripts of the installation installs all but
# Python's.
demo)
    demo=$work/demo
    rm -rf "$demo" "$work/of_demo"
    mkdir -p "$demo"
    cd "$build"
    {
        ninja -t inputs hshfit | grep -v '^/' | grep -v '\.o$'
        find hshfit cli/share package lib/include CMakeFiles/Export -type f
    } | while read -r file; do
        [ ! -f "$file" ] || cp -l --parents "$file" "$demo"
    done
    find . -path ./installed -prune -o -name cmake_install.cmake -print | while read -r script; do
        mkdir -p "$demo/$(dirname "$script")"
        sed "s#$build/#$demo/#g" "$script" >"$demo/$script"
    done
    cmake --install "$demo" --prefix "$work/of_demo" >"$work/log"
    # hshfit-mpi and the package for Python are other targets.
    (cd "$prefix" && find . -type f ! -path '*/dist-packages/*' ! -path './bin/hshfit-mpi') | sort \
        >"$work/list"
    (cd "$work/of_demo" && find . -type f) | sort | diff "$work/list" - ||
        fail "the installation after ./run demo all differs from the whole one in the files above"
    ;;
# Installed headers are the list of public ones and nothing else, and compile with warnings.
headers)
    list=$("$source"/tests/public_headers.py --list | sort)
    found=$(cd "$prefix/include" && { find hshfit -name '*.h'
        cd hshfit-brdfs && find brdfs -name '*.h'; } | sort)
    [ "$list" = "$found" ] || {
        echo "$list" >"$work/list"
        echo "$found" | diff "$work/list" - >&2
        fail "these headers differ from tests/public_headers.py --list"
    }
    [ -z "$(find "$prefix" -type d -empty)" ] || fail "empty folders are installed"
    echo "$list" | sed 's/.*/#include <&>/' >"$work/headers.cpp"
    # shellcheck disable=SC2086  # a list of flags
    c++ -std=c++20 -fsyntax-only $strict -I"$prefix/include" -I"$prefix/include/hshfit-brdfs" \
        "$work/headers.cpp"
    ;;
# The examples, and the quick start against the program: the same bytes.
examples)
    makeProject examples "$prefix/share/doc/hshfit/examples" -DCMAKE_PREFIX_PATH="$prefix" \
        -DCMAKE_CXX_FLAGS="$strict"
    cd "$work/examples"
    "$prefix"/bin/hshfit convert phong:kd=0.1,exponent=8 phong.bsdf --force --quiet
    ./quick_start_example phong.bsdf library.json
    "$prefix"/bin/hshfit project phong.bsdf --cosine --outgoing 32x32 --quiet -o - \
        >program.json
    cmp library.json program.json
    ./project_example phong:exponent=22 phong.json >/dev/null
    # One pair by the fast path, in single precision, against the program.
    echo '20 0 30 180' | ./one_pair_example library.json >pair
    "$prefix"/bin/hshfit eval library.json --wi 20,0 --wo 30,180 --quiet | cat pair - |
        awk 'NR == 1 { f = $1 } END { exit !((f / $NF - 1) ^ 2 < 1e-9) }' ||
        fail "one_pair.cpp prints $(cat pair) of the coefficients of a Phong BRDF"
    # Without its module beside it the program says where that belongs; cli_install_test has it.
    {
        printf 'Pf\n4 2\n-1.0\n'
        printf '\000\000\000\077%.0s' 1 2 3 4 5 6 7 8
    } >grey.pfm
    mkdir -p alone
    cp "$prefix"/bin/hshfit alone/
    code=0
    alone/hshfit irradiance grey.pfm --quiet >alone/log 2>&1 || code=$?
    grep -q 'libhshfit_openimageio.so .* belongs beside' alone/log || code=$code,
    [ "$code" = 3 ] || [ -e /usr/lib/hshfit ] || [ -e /usr/local/lib/hshfit ] ||
        fail "a program without its module ends with $code: $(cat alone/log)"
    # The closed form: 2 pi int_0^1 (mu (1 + 3 mu) / (4 pi))^2 d mu = 109 / (240 pi).
    ./own_brdf_example |
        awk '{ exit !(($1 / (109 / (240 * 3.14159265358979)) - 1) ^ 2 < 1e-18 && $2 <= 1) }' ||
        fail "the energy of own_brdf.cpp differs from 109 / (240 pi)"
    ;;
# The quick start from the text of docs/reference/library.md, by the commands of that page.
page)
    rm -rf "$work/page"
    mkdir "$work/page"
    cd "$work/page"
    block cpp >quick_start.cpp
    block cmake >CMakeLists.txt
    "$prefix"/bin/hshfit convert phong:kd=0.1,exponent=8 gold.bsdf --quiet
    block sh | PREFIX=$prefix bash >log
    tail -n 1 log | grep -qx '[01]\.[0-9]*'
    "$prefix"/bin/hshfit info gold.json --quiet >log
    ;;
# The CMakeLists.txt of the page with another component alone, and every object of ours on its line:
# none may miss a library. Together the components have all libraries.
components)
    components=$(sed -n 's/^set(hshfit_built \(.*\))/\1/p' "$prefix"/lib/cmake/hshfit/*Config.cmake)
    rm -rf "$work/alone" "$work/linked"
    for component in $(echo "$components" | tr ';' ' '); do
        grep -q "^| \`$component\` | \`hshfit::$component\` |" \
            "$source/docs/reference/library.md" ||
            fail "docs/reference/library.md lacks the component $component"
        mkdir -p "$work/alone/$component"
        cd "$work/alone/$component"
        block cmake | sed "s/brdfs/$component/" >CMakeLists.txt
        echo 'int main() {}' >quick_start.cpp
        cmake -G Ninja -B build -DCMAKE_PREFIX_PATH="$prefix" --log-level=WARNING
        grep -o "$prefix/lib/libhshfit_[a-z_0-9]*\.a" build/build.ninja | sort -u >archives
        cmake -B build --log-level=WARNING -DCMAKE_EXE_LINKER_FLAGS="-Wl,--whole-archive $(
            tr '\n' ' ' <archives) -Wl,--no-whole-archive"
        cmake --build build
        cat archives >>"$work/linked"
    done
    find "$prefix/lib" -name 'libhshfit_*.a' | sort >"$work/list"
    sort -u "$work/linked" | diff "$work/list" - ||
        fail "no component has the libraries above"
    ;;
# A component looks for its own packages only, names a component that is not there, and refuses
# another major version. Consumers get include folders, the standard and libraries, and no flag.
outside)
    absent=
    for package in OpenEXR PNG ZLIB Ceres pugixml glslang Eigen3 nlohmann_json CLI11; do
        absent="$absent -DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"
    done
    # shellcheck disable=SC2086  # a list of options
    makeProject outside "$source/tests/install/outside" -DCMAKE_PREFIX_PATH="$prefix" $absent \
        -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
    "$work/outside/outside"
    ! grep -E -e '-fno-math-errno|-Winvalid-pch|-DHWY' "$work/outside/compile_commands.json" ||
        fail "flags of ours reach an outside project"
    makeProject all_parts "$source/tests/install/outside" -DCMAKE_PREFIX_PATH="$prefix" \
        -DPROGRAM=all_parts "-DCOMPONENTS=lib;brdfs"
    "$work/all_parts/all_parts"
    ! cmake -G Ninja -S "$source/tests/install/outside" -B "$work/wrong" \
        -DCMAKE_PREFIX_PATH="$prefix" -DCOMPONENTS=maths >"$work/log" 2>&1 ||
        fail "a component 'maths' is found"
    grep -q "no component 'maths'" "$work/log" || fail "the message does not name the component"
    ! grep -q "$build\|$source" "$prefix"/lib/cmake/hshfit/*.cmake "$prefix"/lib/pkgconfig/*.pc ||
        fail "the package files name the build or source folder"
    ;;
# Without CMake: the flags of pkg-config. Every object of ours among the flags of each module is
# linked by them alone, so that none misses a library.
pkgconfig)
    cd "$work"
    export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
    # shellcheck disable=SC2046,SC2086  # lists of flags
    {
        c++ -std=c++20 $strict "$source/tests/install/outside/outside.cpp" -o outside_by_flags \
            $(pkg-config --cflags --libs hshfit-math)
        c++ -std=c++20 $strict "$source/examples/quick_start.cpp" -o quick_start_by_flags \
            $(pkg-config --cflags --libs hshfit-brdfs)
    }
    echo 'int main() {}' >whole.cpp
    for file in "$PKG_CONFIG_PATH"/*.pc; do
        flags=$(pkg-config --libs "$(basename "$file" .pc)")
        ours=$(echo "$flags" | tr ' ' '\n' | grep -E '^(-L|-lhshfit)')
        # shellcheck disable=SC2086  # lists of flags
        c++ whole.cpp -o whole -Wl,--whole-archive $ours -Wl,--no-whole-archive $flags
        ./whole
    done
    ./outside_by_flags | grep -qF "hshfit $(pkg-config --modversion hshfit):"
    ./quick_start_by_flags lambert by_flags.json | grep -qx '[01]\.[0-9]*'
    ;;
# As a subfolder of another project: no package of the program is looked for, and neither flags nor
# tests nor installation of ours become its own.
subfolder)
    rm -rf "$work/subfolder"
    cmake -G Ninja -S "$source/tests/install/subfolder" -B "$work/subfolder" --log-level=WARNING \
        --no-warn-unused-cli -DHSHFIT="$source" -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON \
        -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON
    cmake --build "$work/subfolder" --target direction everything
    "$work/subfolder/direction"
    python3 - "$work/subfolder/compile_commands.json" <<'END'
import json
import sys
own = [entry for entry in json.load(open(sys.argv[1])) if "/everything.cpp" in entry["file"]]
flags = own[0]["command"].split() if len(own) == 1 else sys.exit("no command of everything.cpp")
ours = [flag for flag in flags if flag.startswith(("-W", "-f")) and flag not in
        ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")]
sys.exit(f"installed: flags of ours reach the project: {ours}" if ours else 0)
END
    cmake --install "$work/subfolder" --prefix "$work/nothing" >/dev/null
    [ ! -e "$work/nothing" ] || fail "hshfit is installed with the project that includes it"
    ;;
*) fail "unknown step '$step'" ;;
esac
