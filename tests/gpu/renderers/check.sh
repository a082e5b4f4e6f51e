#!/bin/sh
# check.sh SCRIPT PACKAGE [ARGUMENT…]: runs a trial with node; 77 where something that it needs is
# missing.
set -eu
here=$(dirname "$0")
skip() {
    echo "skipped: $1"
    exit 77
}
[ -d "$here/node_modules/$2" ] || [ -d "$here/../node_modules/$2" ] ||
    skip "the package $2 is not installed: npm ci --ignore-scripts in tests/gpu/renderers"
[ "$1" != filament.mjs ] || command -v matc >/dev/null ||
    skip "matc is not installed (libfilament-tools)"
script=$1
shift 2
exec "$here/../browser/check.sh" "../renderers/$script" "$@"
