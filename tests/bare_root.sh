#!/bin/sh
# Runs `./run test` (or the command given) as root in a fresh, minimal Debian 12, like a new
# user on a new machine. Needs root, debootstrap and an apt mirror.
#   tests/bare_root.sh [-k] [COMMAND…]    -k keeps the root; default command: ./run test
# The root is made under ${BARE_ROOT:-a temporary folder} and reused if it is there already.
# This machine's apt sources, keys, host table and certificates are copied into it when it is
# made, so that it finds the same mirror; none of that is part of the repository.
# With BARE_CCACHE=FOLDER the root uses that folder of ccache, and the copy of the project lies at
# the same path as here. Objects that were compiled here are then taken from the cache; a header
# that the root lacks is still noticed, because ccache compares every header with the root's own.
set -eu

keep=no
if [ "${1:-}" = -k ]; then
    keep=yes
    shift
fi
[ $# -gt 0 ] || set -- ./run test
[ "$(id -u)" = 0 ] || { echo "bare_root: has to run as root" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "bare_root: debootstrap is not installed" >&2; exit 2; }

project=$(cd "$(dirname "$0")/.." && pwd)
place=/src/hshfit
[ -z "${BARE_CCACHE:-}" ] || place=$project
root=${BARE_ROOT:-$(mktemp -d "${TMPDIR:-/tmp}/bare_root.XXXXXX")}

# Copies PATH… to the same places in the root; absent paths are left out.
carry() {
    for path in "$@"; do
        [ -e "$path" ] || continue
        mkdir -p "$root$(dirname "$path")"
        cp -rL "$path" "$root$(dirname "$path")/"
    done
}

if [ ! -e "$root/etc/debian_version" ]; then
    # shellcheck disable=SC2016  # apt expands these, not the shell
    mirror=$(apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
        awk '$1 == "bookworm" { print $2; exit }')
    echo "bare_root: minimal Debian 12 from ${mirror:-the default mirror} into $root"
    # shellcheck disable=SC2086  # no mirror means no argument
    debootstrap --variant=minbase bookworm "$root" $mirror >"$root.log" 2>&1 ||
        { tail -n 20 "$root.log" >&2; exit 1; }
    rm -rf "$root/etc/apt/sources.list"
    carry /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/apt.conf.d /etc/apt/trusted.gpg.d \
        /etc/apt/keyrings /usr/share/keyrings /etc/hosts /etc/resolv.conf \
        /etc/ssl/certs/ca-certificates.crt /root/.npmrc
    # Hooks of packages that the bare root does not have.
    rm -f "$root"/etc/apt/apt.conf.d/20packagekit "$root"/etc/apt/apt.conf.d/50appstream
fi

echo "bare_root: copying the committed tree $(git -C "$project" rev-parse --short HEAD)"
rm -rf "${root:?}$place"
mkdir -p "$root$place"
git -C "$project" archive HEAD | tar -x -C "$root$place"
if [ -d "$project/../shared" ] && [ ! -d "$root$place/../shared" ]; then
    cp -rL "$project/../shared" "$root$place/../shared"
fi

# npm's certificates, at a place that the package ca-certificates does not write over.
if [ -n "${NODE_EXTRA_CA_CERTS:-}" ]; then cp -L "$NODE_EXTRA_CA_CERTS" "$root/root/node_ca.crt"; fi

# A mount namespace of its own, so that /proc and /dev vanish with the command.
code=0
start=$(date +%s)
# shellcheck disable=SC2016  # expanded by the inner shell
unshare --mount sh -c '
    root=$1 place=$2
    shift 2
    mount -t proc proc "$root/proc"
    # Devices of its own, with the modes of a new machine: this one may have others, and apt
    # checks signatures as a user who has to be able to write to /dev/null.
    mount -t tmpfs -o mode=755 tmpfs "$root/dev"
    mkdir "$root/dev/shm" "$root/dev/pts"
    if mknod -m 666 "$root/dev/null" c 1 3 2>&1; then
        mknod -m 666 "$root/dev/zero" c 1 5
        mknod -m 666 "$root/dev/full" c 1 7
        mknod -m 666 "$root/dev/random" c 1 8
        mknod -m 666 "$root/dev/urandom" c 1 9
        mknod -m 666 "$root/dev/tty" c 5 0
        ln -s /proc/self/fd "$root/dev/fd"
        ln -s fd/0 "$root/dev/stdin"
        ln -s fd/1 "$root/dev/stdout"
        ln -s fd/2 "$root/dev/stderr"
        chmod 1777 "$root/dev/shm"
        mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts"
        ln -s pts/ptmx "$root/dev/ptmx"
    else
        echo "bare_root: no devices can be made here; those of this machine serve"
        umount "$root/dev"
        mount --rbind /dev "$root/dev"
    fi
    if [ -n "${BARE_CCACHE:-}" ]; then
        mkdir -p "$root/var/cache/ccache"
        mount --bind "$BARE_CCACHE" "$root/var/cache/ccache"
    fi
    exec chroot "$root" /usr/bin/env -i HOME=/root LANG=C.UTF-8 HSHFIT_BARE_ROOT=yes \
        ${NODE_EXTRA_CA_CERTS:+NODE_EXTRA_CA_CERTS=/root/node_ca.crt} \
        ${BARE_CCACHE:+CCACHE_DIR=/var/cache/ccache} \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
        sh -c "cd \"\$1\" && shift && exec \"\$@\"" sh "$place" "$@"
' sh "$root" "$place" "$@" || code=$?
echo "bare_root: '$*' ended with $code after $(($(date +%s) - start)) s"

if [ "$keep" = no ] && [ -z "${BARE_ROOT:-}" ]; then
    rm -rf --one-file-system "$root" "$root.log"
else
    echo "bare_root: the root stays at $root"
fi
exit "$code"
