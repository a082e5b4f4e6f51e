#!/bin/sh
# The steps of `./run demo` after the build: three BRDFs to coefficients and reports in out/.
set -eu
cd "$(dirname "$0")/.."
hshfit=build/hshfit
mkdir -p out

# Runs the program after printing the command line.
show() {
    echo "\$ hshfit $*"
    "$hshfit" "$@"
}

# finding TEXT COMMAND…: a command that is known to end with exit code 4, and its meaning.
finding() {
    text=$1
    shift
    code=0
    show "$@" || code=$?
    [ "$code" = 4 ] || { echo "demo: expected exit code 4, not $code" >&2; exit 1; }
    echo "  exit code 4, and rightly so: $text"
}

phong=phong:exponent=22
ward=ward:ax=0.2,ay=0.5
ggx=ggx:alpha=0.3

echo "1. Coefficients: hemispherical harmonics of order 7 at 32 elevations or 32 x 32 directions."
show project $phong -o out/phong.json --force
show project $phong --cosine -o out/phong_cosine.json --force
show project $ward --cosine -o out/ward_cosine.json --force

echo
echo "2. A measured material: a MERL-layout file that the program writes itself."
show convert $ggx out/ggx.binary --force
show info out/ggx.binary
show project out/ggx.binary --cosine -o out/ggx_cosine.exr --force

echo
echo "3. From format to format: what it costs, and a published fit of a real material."
show convert out/ggx.binary out/ggx.bsdf --force --report-loss --outgoing 45,0
show convert preset:ngan-ward/blue-acrylic out/blue-acrylic.xml --to bsdf-klems --force

echo
echo "4. For a renderer: textures, a shader, and a page that shows what they are worth."
show export out/ward_cosine.json -o out/export --target three,viewer --force
show export $ward -o out/materials --target gltf --force
show export gltf-pbr:roughnessFactor=0.4 -o out/materials --target materialx --force
show export out/phong.json -o out/lighting --lighting split-sum,coefficients --no-error --force

echo
echo "5. Accuracy reports: the energy that each basis captures, by order (Eq. 15)."
show report $phong -o out/report_phong --force
show report $phong $ward out/ggx.binary --cosine -o out/report_cosine --force
finding "f of the Ward BRDF grows as 1/sqrt(cos theta) towards the horizon, so that the
  integral of its square does not exist; f cos, above, is fine." \
    report $ward -o out/report_ward --force

echo
echo "6. A model fitted to the measured file, with errors and a page that compares the two."
show fit out/ggx.binary --model lambert+beckmann --samples 20000 -o out/fit_beckmann --force

echo
echo "7. The least that a scene needs: matte materials under one sky; a mirror has no plan."
finding "no form of this order holds a mirror." \
    plan examples/scenes/matte_room.json -o out/plan --force

echo
echo "8. Light: a sky as coefficients, turned, and as the nine numbers that engines take."
show light sky:type=12,elevation=40,radiance=1 -o out/sky.json --force
show rotate out/sky.json -o out/sky_turned.json --axis 0,1,0,30 --force
show irradiance sky:type=12,elevation=40,radiance=1 --convention three

echo
echo "9. Directions drawn after a material, with the efficiency by elevation, and a scene by them."
show sample ggx:alpha=.2,F0=.9 --outgoing 45,0 --count 1000 -o out/samples.csv --force
show export out/phong.json -o out/path_tracer --target bin,glsl --no-error --force
show sample out/path_tracer/phong.hsh.json --method stored --count 0
show illuminate examples/scenes/box.json -o out/box --samples 16 --force
show illuminate examples/scenes/box.json -o out/box_cache --method radiance-cache --rays 500 \
    --samples 4 --force
show transfer examples/scenes/ball_and_wall.json -o out/ball --rays 64 --force

echo
echo "10. Maps of a coin as a texture of coefficients, and a texel of it."
show svbrdf examples/maps/coin.json -o out/coin --form low-rank --force
show eval out/coin/material.json:x=32,y=32 --wi 30,180 --wo 20,0

echo
echo "11. Many materials: a manifest of commands, and one table of all answers."
show batch examples/batch/materials.jsonl -o out/batch
show batch examples/batch/materials.jsonl -o out/batch --merge

echo
echo "Captured energy of f cos with order 7 (49 slots) and the files it went to:"
# The BRDF is the last column, in quotes and with commas of its own.
awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["order"] == 7 {
        split($0, quoted, "\"")
        name = quoted[4]
        printf "  %-24s %-16s %3d coefficients  %.6f\n", name, $at["basis"],
               $at["coefficients"], $at["accuracy"]
    }' out/report_cosine/curves.csv
for file in out/phong.json out/phong_cosine.json out/ward_cosine.json out/ggx_cosine.exr; do
    printf '  %-28s %8d KB\n' "$file" $(($(wc -c <"$file") / 1000))
done
echo
echo "Open out/report_cosine/report.html, and report_phong and report_ward beside it;"
echo "the fit is out/fit_beckmann/fit.json, with comparison.html beside it;"
echo "the plan is out/plan/plan.html; the table of the batch is out/batch/index.html;"
echo "the viewer is out/export/ward_cosine_viewer.html;"
echo "the coefficients are out/*.json and out/*.exr: build/hshfit info out/ward_cosine.json"
