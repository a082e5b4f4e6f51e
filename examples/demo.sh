#!/bin/sh
# The steps of `./run demo` after the build: three BRDFs to coefficients and reports in out/. Each
# step states what has to hold of its answer, and the demonstration ends where it does not.
set -eu
cd "$(dirname "$0")/.."
hshfit=build/hshfit
mkdir -p out

# Runs the program after printing the command line; its answer is in out/answer.txt, too.
show() {
    echo "\$ hshfit $*"
    code=0
    "$hshfit" "$@" >out/answer.txt || code=$?
    cat out/answer.txt
    return $code
}

# number PATTERN [FILE]: the first number in the last answer, or in FILE, that stands at the @.
number() {
    place=$(echo "$1" | sed 's/@/\\([-+0-9.e]*[0-9]\\)/')
    sed -n "s/^\(.*[^-+0-9.e]\)\{0,1\}$place.*/\2/p" "${2:-out/answer.txt}" | head -n 1
}

# holds CLAIM CONDITION: ends the demonstration unless the condition, of awk, is true.
holds() {
    awk "function near(a, b, share) { return a - b <= share * b && b - a <= share * b }
         function within(a, low, high) { return a >= low && a <= high }
         BEGIN { exit !($2) }" 2>/dev/null ||
        { echo "demo: this does not hold: $1: $2" >&2; exit 1; }
    echo "  holds: $1"
}

# finding TEXT COMMAND…: a command that is known to end with exit code 4, and its meaning.
finding() {
    text=$1
    shift
    show "$@" || true
    [ "$code" = 4 ] || { echo "demo: expected exit code 4, not $code" >&2; exit 1; }
    echo "  exit code 4, and rightly so: $text"
}

phong=phong:exponent=22
ward=ward:ax=0.2,ay=0.5
ggx=ggx:alpha=0.3

echo "1. Coefficients: hemispherical harmonics of order 7 at 32 elevations or 32 x 32 directions."
show project $phong -o out/phong.json --force
of_f=$(number '@ of the energy captured')
show project $phong --cosine -o out/phong_cosine.json --force
of_f_cos=$(number '@ of the energy captured')
show project $ward --cosine -o out/ward_cosine.json --force
of_ward=$(number '@ of the energy captured')
holds "bases capture a share of the energy, most of it, and more of f cos than of f" \
    "within($of_f, 0.9, 1) && within($of_f_cos, $of_f, 1) && within($of_ward, 0.9, 1)"

echo
echo "2. A measured material: a MERL-layout file that the program writes itself."
show convert $ggx out/ggx.binary --force
show info out/ggx.binary
holds "no value of it is negative, and it reflects no more than it receives" \
    "$(number 'smallest f found *@') >= 0 && within($(number 'largest albedo *@'), 0.8, 1)"
show project out/ggx.binary --cosine -o out/ggx_cosine.exr --force
holds "its coefficients have a share of the energy" \
    "within($(number '@ of the energy captured'), 0.8, 1)"

echo
echo "3. From format to format: what it costs, and a published fit of a real material."
show convert out/ggx.binary out/ggx.bsdf --force --report-loss --outgoing 45,0
holds "the other format loses less than 1 % of f" "$(number 'relative-l2 *@') < 0.01"
show convert preset:ngan-ward/blue-acrylic out/blue-acrylic.xml --to bsdf-klems --force

echo
echo "4. For a renderer: textures, a shader, and a page that shows what they are worth."
show export out/ward_cosine.json -o out/export --target three,viewer --force
holds "16 bits add less than a thousandth to the error of the coefficients" \
    "$(number 'storage @ %') < 0.1 && $(number 'truncation @ %') < 40"
show export $ward -o out/materials --target gltf --force
holds "a standard material is near, in the mean" "$(number 'mean log error @') < 0.05"
show export gltf-pbr:roughnessFactor=0.4 -o out/materials --target materialx --force
show export out/phong.json -o out/lighting --lighting split-sum,coefficients --no-error --force
show export ggx:alpha=.25,F0=.9/.6/.3 -o out/prefiltered --lighting prefiltered \
    --light sky:type=12,elevation=40 --force
holds "under skies, an engine's own environment is enough" \
    "$(number 'prefiltered *@ .*sky') < 0.1"

echo
echo "5. Accuracy reports: the energy that each basis captures, by order (Eq. 15)."
show report $phong -o out/report_phong --force
show report $phong $ward out/ggx.binary --cosine -o out/report_cosine --force
sed -n 's/^ *"accuracy": \([-+0-9.e]*\),*$/\1/p' out/report_cosine/report.json >out/shares.txt
holds "no basis captures less than nothing or more than all, at any order" \
    "$(awk 'NR == 1 { low = high = $1 } { if ($1 < low) low = $1; if ($1 > high) high = $1 }
            END { print (NR > 200) " && " low " >= -1e-9 && " high " <= 1 + 1e-9" }' \
        out/shares.txt)"
finding "f of the Ward BRDF grows as 1/sqrt(cos theta) towards the horizon, so that the
  integral of its square does not exist; f cos, above, is fine." \
    report $ward -o out/report_ward --force

echo
echo "6. A model fitted to the measured file, with errors and a page that compares the two."
show fit out/ggx.binary --model lambert+beckmann --samples 20000 -o out/fit_beckmann --force
holds "the model explains the pictures of the data" "within($(number 'explains @ %'), 95, 100)"
holds "the roughness is that of the data, whose model has another distribution" \
    "near($(number 'beckmann.alpha *@'), 0.3, 0.1)"

echo
echo "7. The least that a scene needs: matte materials under one sky; a mirror has no plan."
finding "no form of this order holds a mirror." \
    plan examples/scenes/matte_room.json -o out/plan --force
holds "each other material is within the error that the scene allows" \
    "$(number 'plaster:.* error @ of') <= 0.02 && $(number 'boards:.* error @ of') <= 0.02 &&
     $(number 'chair:.* error @ of') <= 0.02"

echo
echo "8. Light: a sky as coefficients, turned, and as the nine numbers that engines take."
show light sky:type=12,elevation=40,radiance=1 -o out/sky.json --force
holds "10 bands have most of the sky" "within($(number '@ of the energy captured'), 0.9, 1)"
show rotate out/sky.json -o out/sky_turned.json --axis 0,1,0,30 --force
holds "turning the sphere loses nothing" \
    "$(number '@ % of the energy left') < 1e-6 && $(number '@ % off the rotated') < 1e-6"
show irradiance sky:type=12,elevation=40,radiance=1 --convention three
holds "nine numbers are near the irradiance of every normal" \
    "$(number 'order 3 .* error at most @ %') < 5"

echo
echo "9. Directions drawn after a material, with the efficiency by elevation, and a scene by them."
show sample ggx:alpha=.2,F0=.9 --outgoing 45,0 --count 1000 -o out/samples.csv --force
albedo=$(awk '$1 == 45.0 { print $2, $3, $4 }' out/answer.txt)
holds "samples and quadrature have the same albedo, within five standard errors" \
    "$(echo "$albedo" | awk '{ print "near(" $2 ", " $1 ", 5 * " $4 + $3 " / " $1 ")" }')"
show export out/phong.json -o out/path_tracer --target bin,glsl --no-error --force
show sample out/path_tracer/phong.hsh.json --method stored --count 0
albedo=$(awk '$1 == 45.0 { print $2, $3, $4 }' out/answer.txt)
holds "so do samples drawn as the shader draws them" \
    "$(echo "$albedo" | awk '{ print "near(" $2 ", " $1 ", 5 * " $4 + $3 " / " $1 ")" }')"
show illuminate examples/scenes/box.json -o out/box --samples 16 --force
by_paths=$(number 'mean radiance @,')
show illuminate examples/scenes/box.json -o out/box_cache --method radiance-cache --rays 500 \
    --samples 4 --force
holds "paths and the radiance cache have the same mean, within 2 %" \
    "near($(number 'mean radiance @,'), $by_paths, 0.02)"
holds "it is below the radiance of the lamp" "within($by_paths, 0, 17)"
show transfer examples/scenes/ball_and_wall.json -o out/ball --rays 64 --force
holds "each pass of reflections has less light than the one before" \
    "$(sed -n 's/^  energy by pass: //p' out/answer.txt |
        awk '{ for (i = 2; i <= NF; ++i) printf "%s > %s && ", $(i - 1), $i; print $NF " > 0" }')"

echo
echo "10. Maps of a coin as a texture of coefficients, and a texel of it."
show svbrdf examples/maps/coin.json -o out/coin --form low-rank --force
holds "the error of the form is below 1 % of every texel" \
    "$(number 'level  0: .* % mean, @ % at most') < 1"
show eval out/coin/material.json:x=32,y=32 --wi 30,180 --wo 20,0
holds "the texel is copper: red before green before blue" \
    "$(awk '{ f[$1] = $2 } END { print f["R"], ">", f["G"], "&&", f["G"], ">", f["B"], "&&",
                                       f["B"], "> 0" }' out/answer.txt)"

echo
echo "11. Many materials: a manifest of commands, and one table of all answers."
show batch examples/batch/materials.jsonl -o out/batch
show batch examples/batch/materials.jsonl -o out/batch --merge
holds "no item failed, and none is missing" \
    "$(number '@ failed') == 0 && $(number '@ missing') == 0"

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
