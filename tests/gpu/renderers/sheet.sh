#!/bin/sh
# sheet.sh FOLDER SHEET.png: of the sheets that the trials wrote into FOLDER three cuts each, one
# line below another (needs oiiotool): three.js, Babylon.js, PlayCanvas and Filament with our
# material, Blender with the glTF fit, Godot 3 with our shader and, in the environment, with the
# fit.
set -eu
folder=$1
sheet=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
side=128
parts=
# ENGINE ROW…: rows of its sheet, two for each material, parallel light first.
cut() {
    engine=$1
    shift
    for row in "$@"; do
        part=$work/$engine-$row.png
        oiiotool "$folder/$engine.png" --cut "$((3 * side))x$side+0+$((row * side))" -o "$part"
        parts="$parts $part"
    done
}
cut three 1 2 5
cut babylon 1 2 5
cut playcanvas 1 2 5
cut filament 1 2 5
cut blender 1 2 5
cut godot3 0 2 5
# shellcheck disable=SC2086
oiiotool $parts --mosaic 3x6 --resize 58% --ch R,G,B -d uint8 --attrib png:compressionLevel 9 \
    -o "$sheet"
