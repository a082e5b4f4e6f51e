#!/usr/bin/env python3
"""film_fits.py PROGRAM DATA FOLDER [NAME…]: standard materials with and without thin films.

Fits gltf-pbr and openpbr to those of the materials of halfway_sheet.py that are named (default:
cc_ibiza_sunset), by default and with the film stated as none. Prints the table of
docs/results/fits.md: picture error, radiance of a sphere under the probe rnl in R, G and B over
that of the source, CPU seconds of the fit, and the film. Answers and pictures, NN.png of the source
and the four fits under the probe, stay in FOLDER. Needs oiiotool.
"""

import json
import re
import sys
from pathlib import Path

from exr_pixels import read_exr
from halfway_sheet import materials, run

ABSENT = {'gltf-pbr': 'gltf-pbr:iridescenceFactor=0', 'openpbr': 'openpbr:thin_film_weight=0'}
SIZE = 96


def fitted(program, spec, model, path):
    if not path.exists():
        path.write_text(run(program, 'fit', spec, '--rgb', '--accept', '--model', model, '--json',
                            '--quiet'))
    return json.loads(path.read_text())


def sums(program, specs, probe, path):
    """R, G and B of each sphere, added up."""
    run(program, 'render', *specs, '--light', probe, '--by', 'integration', '--size', SIZE, '-o',
        path, '--force', '--quiet')
    planes = read_exr(path)
    count = len(planes['R']) // len(specs)
    return [[sum(planes[c][k * count:(k + 1) * count]) for c in 'RGB'] for k in range(len(specs))]


def strip(program, specs, probe, path):
    """The same spheres side by side."""
    sheet = path.with_suffix('.sheet.png')
    run(program, 'render', *specs, '--light', probe, '--by', 'integration', '--size', SIZE, '-o',
        sheet, '--force', '--quiet')
    cells = [path.with_suffix(f'.{k}.png') for k in range(len(specs))]
    for k, cell in enumerate(cells):
        run('oiiotool', sheet, '--cut', f'{SIZE}x{SIZE}+0+{k * SIZE}', '-o', cell)
    run('oiiotool', *cells, '--mosaic:pad=4', f'{len(cells)}x1', '-o', path)


def film(spec):
    """Share, index and nanometres of a film, or nothing."""
    values = dict(re.findall(r'(\w+)=([^,/]+)(?=,|$)', spec))
    if 'iridescenceFactor' in values:
        found = [values['iridescenceFactor'], values.get('iridescenceIor', 1.3),
                 values.get('iridescenceThickness', 400)]
    elif 'thin_film_weight' in values:
        found = [values['thin_film_weight'], values.get('thin_film_ior', 1.4),
                 1000 * float(values.get('thin_film_thickness', 0.5))]
    else:
        return ''
    return '{:.3g}, {:.2f}, {:.0f} nm'.format(*map(float, found))


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    names = sys.argv[4:] or ['cc_ibiza_sunset']
    folder.mkdir(parents=True, exist_ok=True)
    probe = data / 'env/rnl_probe_latlong.hdr'
    head = ['material', 'fit', 'FLIP', 'CIEDE2000', 'radiance R, G, B', 'CPU s',
            'film: share, index']
    print('| ' + ' | '.join(head) + ' |\n' + '|---' * len(head) + '|')
    for n, (name, spec) in enumerate(materials(data)):
        if name not in names:
            continue
        fits = {f'`{model}`{end}': fitted(program, spec, own, folder / f'{n:02d}-{model}{end}.json')
                for model, absent in ABSENT.items()
                for end, own in (('', model), (' without film', absent))}
        specs = [spec, *(fit['spec'] for fit in fits.values())]
        source, *others = sums(program, specs, probe, folder / f'{n:02d}.exr')
        strip(program, specs, probe, folder / f'{n:02d}.png')
        for (title, fit), own in zip(fits.items(), others):
            over = ', '.join(f'{100 * (a / b - 1):+.0f} %' for a, b in zip(own, source))
            picture = fit['picture']
            print(f'| {name} | {title} | {picture["flip"]["mean"]:.3f} | '
                  f'{picture["ciede2000"]["mean"]:.2f} | {over} | '
                  f'{fit["time"]["cpu_seconds"]:.1f} | {film(fit["spec"])} |', flush=True)


if __name__ == '__main__':
    main()
