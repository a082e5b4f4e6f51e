#!/bin/sh
# Checks that `run` names every package that a build needs: in a minimal Debian 12 for each
# command, `./run configure COMMAND` installs the packages of COMMAND and configures its presets.
# Nothing is built. Ends with 1 and the command's name if a command does not configure. Ends
# with 0 and a message if no root can be made (no root rights, no debootstrap, no mirror).
#   tests/bare_configure.sh ['COMMAND…'…]    each argument has a root of its own
# By default these are the commands that build. Those of one argument share a root and are
# configured in their order, so that each is checked with the packages of those before it.
set -eu
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- 'demo python figures package site' bench 'test dev' 'sanitize threads' lint

leaveOut() {
    echo "bare_configure: left out: $1"
    exit 0
}
[ "$(id -u)" = 0 ] || leaveOut "making a root needs root rights"
if ! command -v debootstrap >/dev/null; then
    command -v apt-get >/dev/null || leaveOut "debootstrap is not installed and there is no apt"
    { apt-get -q update && apt-get -q -y install --no-install-recommends debootstrap; } \
        >/dev/null 2>&1 || leaveOut "debootstrap could not be installed"
fi
unshare --mount true 2>/dev/null || leaveOut "mount namespaces are not allowed here"

work=$(mktemp -d "${TMPDIR:-/tmp}/bare_configure.XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT
BARE_ROOT=$work/minimal tests/bare_root.sh true >"$work/log" 2>&1 ||
    { tail -n 5 "$work/log"; leaveOut "no minimal root could be made"; }

failed=
for commands in "$@"; do
    # Packages that were downloaded for one command serve the next.
    rm -rf "$work/root"
    cp -a "$work/minimal" "$work/root"
    mkdir -p "$work/archives"
    cp -a "$work/archives/." "$work/root/var/cache/apt/archives/"
    start=$(date +%s)
    code=0
    # shellcheck disable=SC2086  # a list of words
    BARE_ROOT=$work/root tests/bare_root.sh ./run configure $commands >"$work/log" 2>&1 || code=$?
    echo "bare_configure: ./run configure $commands: $code, $(($(date +%s) - start)) s"
    if [ "$code" != 0 ]; then
        failed="$failed $commands"
        grep -vE '^(Get|Selecting|Preparing|Unpacking|Setting up)' "$work/log" | tail -n 25
    fi
    cp -an "$work/root/var/cache/apt/archives/." "$work/archives/"
done
[ -z "$failed" ] || { echo "bare_configure: these do not configure:$failed" >&2; exit 1; }
