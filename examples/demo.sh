#!/bin/sh
# The steps of `./run demo` after the build: three BRDFs to coefficients and reports in out/. Each
# step states what has to hold of its answer, and the demonstration ends where it does not.
set -eu
cd "$(dirname "$0")/.."
# shellcheck source=/dev/null  # read by itself
. examples/demo_steps.sh

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
holds "the answer shows what a standard material loses of Ward's peak" \
    "$(number 'pictures by FLIP @') > 0.1 && $(number 'mean log error @') < 0.05"
show export gltf-pbr:roughnessFactor=0.4 -o out/materials --target materialx,usd --force
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
echo "7. Light: a sky as coefficients, turned, and as the nine numbers that engines take."
show light sky:type=12,elevation=40,radiance=1 -o out/sky.json --force
holds "10 bands have most of the sky" "within($(number '@ of the energy captured'), 0.9, 1)"
show rotate out/sky.json -o out/sky_turned.json --axis 0,1,0,30 --force
holds "turning the sphere loses nothing" \
    "$(number '@ % of the energy left') < 1e-6 && $(number '@ % off the rotated') < 1e-6"
show irradiance sky:type=12,elevation=40,radiance=1 --convention three
holds "nine numbers are near the irradiance of every normal" \
    "$(number 'order 3 .* error at most @ %') < 5"

echo
echo "8. Directions drawn after a material, with the efficiency by elevation."
show sample ggx:alpha=.2,F0=.9 --outgoing 45,0 --count 1000 -o out/samples.csv --force
albedo=$(awk '$1 == 45.0 { print $2, $3, $4 }' out/answer.txt)
holds "samples and quadrature have the same albedo, within five standard errors" \
    "$(echo "$albedo" | awk '{ print "near(" $2 ", " $1 ", 5 * " $4 + $3 " / " $1 ")" }')"
show export out/phong.json -o out/path_tracer --target bin,glsl --no-error --force
show sample out/path_tracer/phong.hsh.json --method stored --count 0
albedo=$(awk '$1 == 45.0 { print $2, $3, $4 }' out/answer.txt)
holds "so do samples drawn as the shader draws them" \
    "$(echo "$albedo" | awk '{ print "near(" $2 ", " $1 ", 5 * " $4 + $3 " / " $1 ")" }')"

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
echo "the viewer is out/export/ward_cosine_viewer.html;"
echo "the coefficients are out/*.json and out/*.exr: build/hshfit info out/ward_cosine.json"
echo "./run demo all goes on with maps, scenes, plans and batches."
