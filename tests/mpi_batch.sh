#!/bin/sh
# mpi_batch.sh PROGRAM: examples/batch/mpi.sh with 1, 2 and 4 processes gives a batch's table the
# same bytes. Ends with 77, and the reason, where Open MPI is absent.
set -eu
program=$1
here=$(cd "$(dirname "$0")/.." && pwd)
command -v mpirun >/dev/null || { echo "skipped: mpirun is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for exponent in $(seq 1 20); do
    echo "{\"command\": \"eval\", \"input\": \"phong:exponent=$exponent\"," \
        "\"options\": {\"wi\": \"30,0\", \"wo\": \"40,180\"}}"
done >"$work/m.jsonl"
mkdir "$work/bin"
ln -s "$program" "$work/bin/hshfit"
root=
[ "$(id -u)" != 0 ] || root=--allow-run-as-root
for count in 1 2 4; do
    # shellcheck disable=SC2086  # one word or none
    PATH="$work/bin:$PATH" "$here/examples/batch/mpi.sh" "$work/m.jsonl" "$work/$count" \
        -n $count --oversubscribe $root
    [ "$(wc -l <"$work/$count/table.jsonl")" = 20 ]
    cmp "$work/$count/table.csv" "$work/1/table.csv"
    cmp "$work/$count/index.html" "$work/1/index.html"
done
echo "1, 2 and 4 processes give the same bytes"
