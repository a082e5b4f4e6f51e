#!/usr/bin/env python3
"""standard_fits.py PROGRAM DATA FOLDER: gltf-pbr and openpbr of the 24 of halfway_sheet.py.

Fits both to each material by default, the loss `picture`, and by each other loss of `fit`.
FOLDER/fits keeps the answers, and a later run takes them from there. Writes FOLDER/sheet.png: two
materials a line, for each the source and both default fits under a lamp near the camera, then under
one at 60 degrees.
Prints the tables of docs/results/fits.md. Needs oiiotool.
"""

import json
import re
import sys
from pathlib import Path

from halfway_sheet import LIGHTS, SIZE, materials, run

MODELS = ['gltf-pbr', 'openpbr']
LOSSES = ['cube-root', 'log', 'log-relative', 'cosine', 'l2']
INDEX = (1.2, 2.2)  # of a plausible dielectric
MIRROR = 0.05       # a roughness below which a lobe is a mirror's


def fitted(program, spec, model, loss, path):
    """The answer of a fit; `loss` is empty for the default."""
    if not path.exists():
        words = ['fit', spec, '--rgb', '--accept', '--model', model, '--json', '--quiet']
        path.write_text(run(program, *words, *(['--loss', loss] if loss else [])))
    return json.loads(path.read_text())


def flip(fit):
    return fit['picture']['flip']['mean']


def oddities(spec):
    """Parameters of a specification that no usual material has."""
    values = {key: float(value) for key, value in re.findall(r'(\w+)=([^,/]+)(?=,|$)', spec)}
    odd = []
    for key, value in values.items():
        index = key in ('ior', 'specular_ior', 'coat_ior')
        rough = re.fullmatch(r'(clearcoatR|r)oughnessFactor|(specular|coat)_roughness', key)
        if index and not INDEX[0] <= value <= INDEX[1] or rough and value < MIRROR:
            odd.append(f'{key} {value:.3g}')
    return odd


def cells(program, specs, folder, stem):
    """Pictures of a material and its fits under each light."""
    made = []
    for n, light in enumerate(LIGHTS):
        sheet = folder / f'{stem}-{n}.png'
        run(program, 'render', *specs, '-o', sheet, '--by', 'integration', '--size', SIZE, *light,
            '--force', '--quiet')
        for k in range(len(specs)):
            made.append(folder / f'{stem}-{n}-{k}.png')
            run('oiiotool', sheet, '--cut', f'{SIZE}x{SIZE}+0+{k * SIZE}', '--ch', 'R,G,B', '-o',
                made[-1])
    return made


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    (folder / 'fits').mkdir(parents=True, exist_ok=True)
    rows, odd, seen = {model: [] for model in MODELS}, [], []
    for n, (name, spec) in enumerate(materials(data)):
        specs = [spec]
        for model in MODELS:
            fits = {loss: fitted(program, spec, model, loss,
                                 folder / f'fits/{n:02d}-{model}-{loss or "default"}.json')
                    for loss in ['', *LOSSES]}
            own = fits['']
            over = flip(own) - min(flip(fit) for fit in fits.values())
            rows[model].append([name, own, *(flip(fits[loss]) for loss in LOSSES), over])
            odd += [f'| {name} | {model} | {what} |' for what in oddities(own['spec'])]
            specs.append(own['spec'])
        seen += cells(program, specs, folder, f'{n:02d}')
    run('oiiotool', *seen, '--mosaic:pad=2', f'12x{len(seen) // 12}', '-o', folder / 'sheet.png')
    for model in MODELS:
        print(f'\n{model}\n\n| material | default | worst light | ' +
              ' | '.join(f'`{loss}`' for loss in LOSSES) + ' | default over the best | CPU s |\n|' +
              '---|' * (len(LOSSES) + 5))
        for name, own, *losses, over in rows[model]:
            share = f'{100 * over / (flip(own) - over):+.0f} %' if flip(own) - over > 0.01 else '0'
            worst = own['picture']['flip']
            print('| ' + ' | '.join([name, f'{flip(own):.3f}',
                                     f"{worst['largest']:.3f}, {worst['light']}",
                                     *(f'{loss:.3f}' for loss in losses), share,
                                     f"{own['time']['cpu_seconds']:.1f}"]) + ' |')
    print('\n| material | model | unusual |\n|---|---|---|', *odd, sep='\n')


if __name__ == '__main__':
    main()
