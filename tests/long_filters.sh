#!/bin/sh
# usage: long_filters.sh FILE, which has a program and a filter of its long tests on each line.
# Every pattern of a filter has to name a test: one that names none leaves its test in a shard.
set -euf
code=0
while read -r program filter; do
    for pattern in $(printf '%s' "$filter" | tr ":" " "); do
        if ! "$program" --gtest_list_tests --gtest_filter="$pattern" | grep -q '^ '; then
            echo "$(basename "$program"): no test is named $pattern" >&2
            code=1
        fi
    done
done <"$1"
exit $code
