#!/bin/sh
# Tries the packages of `./run package` in a minimal Debian 12 that never saw the project: installs
# hshfit with what it depends on, runs it and the commands of the tutorial as they are printed,
# installs the other packages, builds an outside project against libhshfit-dev, uses the Python
# package, makes a map by two processes of hshfit-mpi, uninstalls all of them, and compares the
# files with those before. The relocatable archive is unpacked into a root without a single package
# more, and run. Needs root, debootstrap, Python and an apt mirror.
#   tests/bare_package.sh [FOLDER]    default: out/packages
# With BARE_ROOT=FOLDER a minimal root that is there already is copied, and made there if it is not.
set -eu
cd "$(dirname "$0")/.."
packages=$(cd "${1:-out/packages}" && pwd)
[ "$(id -u)" = 0 ] || { echo "bare_package: has to run as root" >&2; exit 2; }

work=$(mktemp -d "${TMPDIR:-/tmp}/bare_package.XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT
# A root without the project: it is there as little as its packages' libraries are.
minimal=${BARE_ROOT:-$work/minimal}
BARE_ROOT=$minimal tests/bare_root.sh true >"$work/log" 2>&1 ||
    { tail -n 5 "$work/log" >&2; exit 1; }
cp -a "$minimal" "$work/archive"
cp -a "$minimal" "$work/root"
rm -rf "$work/archive/src" "$work/root/src"

# inside ROOT COMMAND…: as root of ROOT, with /proc and /dev of its own.
inside() {
    root=$1
    shift
    # shellcheck disable=SC2016  # expanded by the inner shell
    unshare --mount sh -c '
        root=$1
        shift
        mount -t proc proc "$root/proc"
        mount --rbind /dev "$root/dev"
        mount --rbind /sys "$root/sys"
        exec chroot "$root" /usr/bin/env -i HOME=/root LANG=C.UTF-8 \
            DEBIAN_FRONTEND=noninteractive \
            PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
    ' sh "$root" "$@"
}
apt() {
    inside "$work/root" apt-get -q -y -o Dpkg::Use-Pty=0 --no-install-recommends "$@" \
        >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
}
seconds() { date +%s; }

# 1. The archive, in a root without any package of ours or of its libraries.
tar -xJf "$packages"/hshfit-*-linux-*.tar.xz -C "$work/archive/opt"
# shellcheck disable=SC2016  # expanded by the shell of the root
inside "$work/archive" sh -ec '
    cd /tmp
    mv /opt/hshfit-* /opt/moved
    /opt/moved/bin/hshfit project phong:exponent=22 -o phong.json --quiet >/dev/null
    /opt/moved/bin/hshfit info phong.json --quiet >/dev/null
    ldd /opt/moved/bin/hshfit | grep "not found" && exit 1
    ldd /opt/moved/bin/hshfit | awk "\$2 == \"=>\" { print \$3 }" | grep -v ^/opt/moved/ |
        sed "s/^/bare_package: from the system: /"'
cp "$work/archive/tmp/phong.json" "$work/from_archive.json"
echo "bare_package: the archive runs from a folder that it was moved to"

# 2. The packages. Every file of the root counts, except for apt's and dpkg's own records.
list() {
    (cd "$work/root" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./sys -o -path ./tmp \
        -o -path ./var/lib/apt -o -path ./var/lib/dpkg -o -path ./var/cache/apt -o -path ./var/log \
        \) -prune -o -print | sort)
}
apt update
dependencies() {
    for package in "$packages"/*.deb; do
        dpkg-deb -f "$package" Depends | tr ',' '\n' | sed 's/(.*//; s/|.*//; s/ //g'
    done | grep -v hshfit | sort -u
}
installed() {
    for package in "$packages"/*.deb; do dpkg-deb -f "$package" Package; done
}
start=$(seconds)
mkdir "$work/root/tmp/packages"
cp "$packages"/*.deb "$work/root/tmp/packages/"
(cd "$packages" && echo hshfit_*.deb) >"$work/name"
apt install "/tmp/packages/$(cat "$work/name")"
echo "bare_package: installed hshfit with its dependencies in $(($(seconds) - start)) s"
inside "$work/root" sh -ec '
    cd /tmp
    hshfit project phong:exponent=22 -o phong.json --quiet >/dev/null
    hshfit info phong.json --quiet >/dev/null'
cmp "$work/root/tmp/phong.json" "$work/from_archive.json"
tests/docs/run_pages.py --script docs/tutorial.md >"$work/root/tmp/tutorial.sh"
start=$(seconds)
inside "$work/root" sh -ec 'mkdir /tmp/tutorial && cd /tmp/tutorial && bash ../tutorial.sh' \
    >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
[ -s "$work/root/tmp/tutorial/page/gold_viewer.html" ] ||
    { echo "bare_package: the tutorial left no page to open" >&2; exit 1; }
echo "bare_package: the commands of the tutorial took $(($(seconds) - start)) s"
apt remove --purge hshfit
# Packages that ours depend on stay while the files of ours are compared.
# shellcheck disable=SC2046  # a list of words
apt install $(dependencies) g++ cmake make
list >"$work/before"
start=$(seconds)
inside "$work/root" sh -c 'dpkg -i /tmp/packages/*.deb' >"$work/log" 2>&1 ||
    { tail -n 20 "$work/log" >&2; exit 1; }
echo "bare_package: installed $(find "$packages" -name '*.deb' | wc -l) packages by dpkg in" \
    "$(($(seconds) - start)) s"
[ "$(list | wc -l)" -gt "$(wc -l <"$work/before")" ] ||
    { echo "bare_package: the packages installed no file" >&2; exit 1; }
cp -r tests/install/outside "$work/root/tmp/outside"
# shellcheck disable=SC2016  # expanded by the shell of the root
inside "$work/root" sh -ec '
    cd /tmp
    cmake -S outside -B outside/build >/dev/null
    cmake --build outside/build >/dev/null
    outside/build/outside
    cmake -S outside -B outside/all -DPROGRAM=all_parts "-DCOMPONENTS=lib;brdfs" >/dev/null
    cmake --build outside/all >/dev/null
    outside/all/all_parts
    cmake -S /usr/share/doc/hshfit/examples -B examples >/dev/null
    cmake --build examples >/dev/null
    examples/quick_start_example phong:exponent=22 quick.json
    cd /
    PYTHONDONTWRITEBYTECODE=1 python3 -c "
import hshfit
assert hshfit.project(\"phong:exponent=22\").accuracy > 0.5"
    cd /tmp
    map=/usr/share/doc/hshfit/examples/maps/coin.json
    hshfit svbrdf "$map" -o one --form low-rank --quiet >/dev/null
    mpirun --allow-run-as-root --oversubscribe -n 2 \
        hshfit-mpi svbrdf "$map" -o two --form low-rank --quiet >/dev/null
    cmp one/material.ktx2 two/material.ktx2'
echo "bare_package: two processes of hshfit-mpi write the texels of hshfit"
# shellcheck disable=SC2046  # a list of words
inside "$work/root" dpkg --purge $(installed) \
    >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
list >"$work/after"
diff "$work/before" "$work/after" ||
    { echo "bare_package: files are left after the packages are gone" >&2; exit 1; }
echo "bare_package: no file is left after uninstalling"
