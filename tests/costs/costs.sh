#!/bin/sh
# costs.sh CTEST BUILD: every name in costs.txt is that of a test.
set -eu
tests=$("$1" --test-dir "$2" --show-only | sed -n 's/^ *Test *#[0-9]*: //p')
code=0
while read -r _ name; do
    if ! printf '%s\n' "$tests" | grep -qxF "$name"; then
        echo "costs.txt: there is no test $name" >&2
        code=1
    fi
done <"$(dirname "$0")/costs.txt"
exit $code
