#!/bin/sh
# Prints the table of docs/export.md: the error of exported representations against their sources,
# split into truncation, interpolation and quantisation.
#   docs/figures/export_errors.sh build/hshfit SPEC…
set -eu
program=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

echo "| material | map | number | bytes | truncation | interpolation | quantisation | total | mean log |"
echo "|---|---|---|---|---|---|---|---|---|"
for spec in "$@"; do
    for outgoing in 32x32 64x64; do
        "$program" project "$spec" --rgb --quiet --order 7 --outgoing "$outgoing" \
            -o "$folder/c.json" >/dev/null
        for number in float16 unorm8; do
            "$program" export "$folder/c.json" -o "$folder/out" --force --quiet --json \
                --target bin --number "$number" |
                python3 -c '
import json, os, sys
answer = json.load(sys.stdin)
error = answer["fit_error"]
percent = lambda key: "%.3g %%" % (100 * error[key])
name = os.path.basename(sys.argv[1])
print("| `%s` | %s | %s | %d | %s | %s | %s | %s | %.3g |" % (
    name, answer["outgoing"], answer["number"], answer["texel_bytes"], percent("truncation"),
    percent("interpolation"), percent("quantisation"), percent("total"), error["mean_log"]))
' "$spec"
        done
    done
done
