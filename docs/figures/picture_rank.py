#!/usr/bin/env python3
"""picture_rank.py PROGRAM DATA FOLDER: does the picture error rank forms as pictures do?

24 materials (those of halfway_sheet.py) in seven forms, from coarse to fine. The judge is the
largest error of spheres under twelve lights that the picture error does not use, lamps in other
places, one to eight at a time: the mean of |a - b| in sRGB over the lit pixels, at the exposure
that shows the source's mean as 18 % grey and at two stops more and less. Prints Spearman's rank
correlation of the judge with each number of `compare`, over all pairs and within materials, with
the 95 % of a bootstrap over materials, as the table of docs/explanation/picture_error.md.
"""

import json
import random
import subprocess
import sys
from pathlib import Path

from exr_pixels import read_exr
from halfway_sheet import MERL, MODELS, RGL, run

FORMS = {
    'halfway 5,4,3': ['--form', 'halfway', '--halfway', '5,4,3'],
    'halfway 9,8,6': ['--form', 'halfway', '--halfway', '9,8,6'],
    'halfway 13,12,8': ['--form', 'halfway', '--halfway', '13,12,8'],
    'hsh 4': ['--order', '4', '--outgoing', '24', '--tolerance', '.01'],
    'hsh 10': ['--order', '10', '--outgoing', '24', '--tolerance', '.01'],
    'zernike 16, cosine': ['--basis', 'zernike', '--order', '16', '--cosine'],
    'hsh 20': ['--order', '20', '--outgoing', '24', '--tolerance', '.01'],
}
LIGHTS = [['12,50,1'], ['22,200,1'], ['38,20,1'], ['52,-80,1'], ['68,110,1'], ['95,-20,1'],
          ['15,10,1', '70,190,2'], ['35,90,1', '35,-90,1'],
          ['50,45,1', '50,165,1', '50,285,1'], ['80,0,1', '80,120,1', '80,240,1'],
          ['20,0,1', '20,90,1', '20,180,1', '20,270,1'],
          ['40,22,1', '40,67,1', '40,112,1', '40,157,1', '40,202,1', '40,247,1', '40,292,1',
           '40,337,1']]
SIZE = 48


def spheres(program, specs, light, folder):
    """Linear pixels, a list of RGB triples for each specification."""
    picture = folder / 'spheres.exr'
    lamps = [word for lamp in light for word in ('--light', lamp)]
    run(program, 'render', *specs, '-o', picture, '--by', 'integration', '--size', SIZE, *lamps,
        '--dome', '0', '--samples', '2', '--force', '--quiet')
    planes = read_exr(picture)
    pixels = list(zip(planes['R'], planes['G'], planes['B']))
    count = SIZE * SIZE
    cells = [pixels[k:k + count] for k in range(0, len(pixels), count)]
    return cells


def srgb(value):
    value = min(max(value, 0), 1)
    return 12.92 * value if value <= .0031308 else 1.055 * value**(1 / 2.4) - .055


def judge(source, form):
    """The mean difference as shown, over the pixels that the light reaches, at three exposures."""
    lit = [(a, b) for a, b in zip(source, form) if max(a) > 0 or max(b) > 0]
    mean = sum(map(sum, source)) / (3 * len(lit)) if lit else 0
    if not mean:
        return 0
    total = 0
    for stops in (-2, 0, 2):
        gain = .18 / mean * 2**stops
        total += sum(abs(srgb(gain * x) - srgb(gain * y)) for a, b in lit for x, y in zip(a, b))
    return total / (9 * len(lit))


def ranks(values):
    order = sorted(range(len(values)), key=values.__getitem__)
    result = [0.0] * len(values)
    k = 0
    while k < len(order):
        same = k
        while same < len(order) and values[order[same]] == values[order[k]]:
            same += 1
        for place in order[k:same]:
            result[place] = (k + same - 1) / 2
        k = same
    return result


def spearman(x, y):
    x, y = ranks(x), ranks(y)
    mx, my = sum(x) / len(x), sum(y) / len(y)
    cov = sum((a - mx) * (b - my) for a, b in zip(x, y))
    return cov / (sum((a - mx)**2 for a in x) * sum((b - my)**2 for b in y))**.5


def measured(program, name, spec, folder):
    """Rows of one material: the judge and the numbers of `compare`, by form."""
    files = []
    for n, (form, words) in enumerate(FORMS.items()):
        file = folder / f'{name.replace("/", "_").replace(":", "_")}-{n}.json'
        turned = ['24x24' if word == '24' and 'ax=' in str(spec) else word for word in words]
        run(program, 'project', spec, *turned, '-o', file, '--force', '--quiet')
        files.append(file)
    judges = [0.0] * len(files)
    for light in LIGHTS:
        source, *others = spheres(program, [spec, *files], light, folder)
        judges = [max(old, judge(source, other)) for old, other in zip(judges, others)]
    rows = []
    for form, file, seen in zip(FORMS, files, judges):
        answer = json.loads(run(program, 'compare', spec, file, '--json', '--quiet'))
        picture, pairs = answer['picture'], answer['pairs']
        rows.append({'material': name, 'form': form, 'judge': seen,
                     'FLIP, mean': picture['flip']['mean'],
                     'FLIP, largest': picture['flip']['largest'],
                     'CIEDE2000, mean': picture['ciede2000']['mean'],
                     'mean log error': pairs['mean_log']['value'],
                     'relative L2': pairs['relative_l2']['value']})
    return rows


def correlation(materials, key):
    """Over all pairs, and the mean of those within a material."""
    rows = [row for rows in materials for row in rows]
    within = [spearman([r['judge'] for r in rows], [r[key] for r in rows]) for rows in materials]
    return (spearman([r['judge'] for r in rows], [r[key] for r in rows]),
            sum(within) / len(within))


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    specs = [(name, data / f'rgl/{name}_rgb.bsdf') for name in RGL]
    specs += [(name, data / f'merl_slices/{name}.slice') for name in MERL]
    specs += [(spec, spec) for spec in MODELS]
    materials = []
    for name, spec in specs:
        materials.append(measured(program, name, spec, folder))
        for row in materials[-1]:
            print(json.dumps(row), file=sys.stderr, flush=True)
    random.seed(1)
    print('| number of `compare` | all pairs | 95 % | within a material | 95 % |')
    print('|---|---|---|---|---|')
    for key in list(materials[0][0])[3:]:
        everywhere, within = correlation(materials, key)
        draws = [sorted(d) for d in zip(*[
            correlation(random.choices(materials, k=len(materials)), key) for _ in range(400)])]
        low, high = [d[10] for d in draws], [d[389] for d in draws]
        print(f'| {key} | {everywhere:.3f} | {low[0]:.3f} to {high[0]:.3f} | {within:.3f} | '
              f'{low[1]:.3f} to {high[1]:.3f} |')


if __name__ == '__main__':
    main()
