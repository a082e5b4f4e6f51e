#!/bin/sh
# Makes OUT/hshfit-VERSION-linux-ARCH.tar.xz of a build folder: the program with its libraries. It
# runs from any folder of a system with the C library that it was built with, or a later one.
#   packaging/tarball.sh BUILD OUT
# It holds bin/hshfit, the libraries other than those of glibc in lib/, found by run paths relative
# to the files themselves, and the licences of the Debian packages that the libraries come from. The
# module for pictures of light stays out: OpenImageIO would bring 250 libraries more.
set -eu
build=$1
out=$2
for tool in cmake ldd patchelf strip dpkg-query xz; do
    command -v "$tool" >/dev/null || { echo "tarball: $tool is not installed" >&2; exit 2; }
done
version=$("$build/hshfit" --version | awk '{ print $2 }')
name=hshfit-$version-linux-$(uname -m)
mkdir -p "$out"
work=$(mktemp -d "${TMPDIR:-/tmp}/tarball.XXXXXX")
trap 'rm -rf "$work"' EXIT
tree=$work/$name

cmake --install "$build" --component program --prefix "$tree" --strip >/dev/null
mkdir -p "$tree/lib" "$tree/share/doc/hshfit/licences"
cp LICENSE "$tree/share/doc/hshfit/LICENSE"
ldd "$tree/bin/hshfit" | awk '$2 == "=>" { print $3 }' |
    grep -vE '/(libc|libm|libdl|libpthread|librt|libresolv|libutil)\.so\.' >"$work/libraries"
while read -r library; do
    cp -L "$library" "$tree/lib/"
    # Libraries are known to dpkg by their path before or after the merge of /lib and /usr/lib.
    package=$({ dpkg-query -S "$(realpath "$library")" || dpkg-query -S "$library" ||
        dpkg-query -S "$(realpath "$library" | sed 's#^/usr##')"; } 2>/dev/null |
        sed -n '1s/:.*//p')
    cp -L "/usr/share/doc/$package/copyright" "$tree/share/doc/hshfit/licences/$package"
done <"$work/libraries"
chmod 644 "$tree"/lib/*
for library in "$tree"/lib/*; do
    # shellcheck disable=SC2016  # $ORIGIN is for the loader
    patchelf --set-rpath '$ORIGIN' "$library"
done
# shellcheck disable=SC2016
patchelf --set-rpath '$ORIGIN/../lib' "$tree/bin/hshfit"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -cJf "$out/$name.tar.xz" "$name"
echo "tarball: $out/$name.tar.xz, $(wc -l <"$work/libraries") libraries," \
    "$(du -sk "$tree" | cut -f1) kB unpacked, $(($(wc -c <"$out/$name.tar.xz") / 1000)) kB packed"
