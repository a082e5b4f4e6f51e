#!/bin/sh
# The steps of `./run demo all` after those of demo.sh: what the wings of the program add. Each
# step states what has to hold of its answer, and the demonstration ends where it does not.
set -eu
cd "$(dirname "$0")/.."
# shellcheck source=/dev/null  # read by itself
. examples/demo_steps.sh

echo "9. The least that a scene needs: matte materials under one sky; a mirror has no plan."
finding "no form of this order holds a mirror." \
    plan examples/scenes/matte_room.json -o out/plan --force
holds "each other material is within the error that the scene allows" \
    "$(number 'plaster:.* error @ of') <= 0.02 && $(number 'boards:.* error @ of') <= 0.02 &&
     $(number 'chair:.* error @ of') <= 0.02"

echo
echo "10. Scenes: paths, a radiance cache, and light that is transferred to each vertex."
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
echo "11. Maps of a coin as a texture of coefficients, and a texel of it."
show svbrdf examples/maps/coin.json -o out/coin --form low-rank --force
holds "the error of the form is below 1 % of every texel" \
    "$(number 'level  0: .* % mean, @ % at most') < 1"
show eval out/coin/material.json:x=32,y=32 --wi 30,180 --wo 20,0
holds "the texel is copper: red before green before blue" \
    "$(awk '{ f[$1] = $2 } END { print f["R"], ">", f["G"], "&&", f["G"], ">", f["B"], "&&",
                                       f["B"], "> 0" }' out/answer.txt)"
show svbrdf examples/maps/coin.json -o out/coin-library --form library --components 7 --force
holds "in a library every texel is within 6 % of the model itself" \
    "$(number 'level  0: .* % mean, @ % at most') < 6"

echo
echo "12. Many materials: a manifest of commands, and one table of all answers."
show batch examples/batch/materials.jsonl -o out/batch
show batch examples/batch/materials.jsonl -o out/batch --merge
holds "no item failed, and none is missing" \
    "$(number '@ failed') == 0 && $(number '@ missing') == 0"

echo
echo "13. A library: glossy and matte materials in one basis, and one shader for all of them."
show library learn ggx:alpha=.2,F0=.9/.6/.3 ggx:alpha=.3,F0=.8/.7/.6 ggx:alpha=.4,F0=.04 \
    lambert:kd=.3/.2/.1+ggx:alpha=.35,F0=.04 lambert:kd=.1/.5/.3+ggx:alpha=.25,F0=.05 \
    oren-nayar:sigma=.5,kd=.6/.3/.3 lambert:kd=.5/.5/.1 --components 6 --limit 10 \
    --limit-maximum 10 --limit-flip 1 -o out/studio.library --force
show library export out/studio.library --target glsl,bin -o out/studio --force
holds "every material has its texels" \
    "$(number '@ materials over') == 7 && $(number 'functions, @ bytes') >= 56"
holds "the table of the functions is within a tenth of f" "$(number 'off by @ at most') <= 0.1"
show library map out/studio.library -o out/studio.html --force
holds "every material is on the map" "$(number '@ materials; the map') == 7"

echo
echo "The plan is out/plan/plan.html; the table of the batch is out/batch/index.html;"
echo "the map of the library is out/studio.html;"
echo "the pictures are out/box, out/box_cache and out/ball."
