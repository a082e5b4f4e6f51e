#!/bin/sh
# check.sh SCRIPT [ARGUMENT…]: runs a check of this folder with node; 77 where something that it
# needs is missing.
set -eu
here=$(dirname "$0")
skip() {
    echo "skipped: $1"
    exit 77
}
command -v node >/dev/null || skip "nodejs is not installed"
[ -x "${CHROMIUM:-/usr/bin/chromium}" ] || skip "chromium is not installed"
[ -d "$here/../node_modules/playwright-core" ] ||
    skip "the npm packages are not installed: npm ci --ignore-scripts in tests/gpu"
script=$1
shift
exec node "$here/$script" "$@"
