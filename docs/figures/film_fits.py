#!/usr/bin/env python3
"""film_fits.py PROGRAM DATA FOLDER [NAME…]: standard materials with and without thin films.

Fits gltf-pbr and openpbr to those of the materials of halfway_sheet.py that are named (default:
cc_ibiza_sunset), by default and with the film stated as none. Prints the table of
docs/results/fits.md: picture error, radiance of a sphere under the probe rnl in R, G and B over
that of the source, CPU seconds of the fit, and the film. Pictures and answers stay in FOLDER.
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


def film(spec):
    found = re.findall(r'(?:iridescence|thin_film_)(Ior|Thickness|ior|thickness)=([^,]+)', spec)
    return ', '.join(f'{name.lower()} {float(value):.3g}' for name, value in found)


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    names = sys.argv[4:] or ['cc_ibiza_sunset']
    folder.mkdir(parents=True, exist_ok=True)
    probe = data / 'env/rnl_probe_latlong.hdr'
    print('| material | fit | FLIP | CIEDE2000 | radiance R, G, B | CPU s | film |\n' +
          '|---' * 7 + '|')
    for n, (name, spec) in enumerate(materials(data)):
        if name not in names:
            continue
        fits = {f'`{model}`{end}': fitted(program, spec, own, folder / f'{n:02d}-{model}{end}.json')
                for model, absent in ABSENT.items()
                for end, own in (('', model), (' without film', absent))}
        source, *others = sums(program, [spec, *(fit['spec'] for fit in fits.values())], probe,
                               folder / f'{n:02d}.exr')
        for (title, fit), own in zip(fits.items(), others):
            over = ', '.join(f'{100 * (a / b - 1):+.0f} %' for a, b in zip(own, source))
            picture = fit['picture']
            has = film(fit['spec']) if re.search(r'iridescenceFactor|thin_film_weight',
                                                 fit['spec']) else ''
            print(f'| {name} | {title} | {picture["flip"]["mean"]:.3f} | '
                  f'{picture["ciede2000"]["mean"]:.2f} | {over} | '
                  f'{fit["time"]["cpu_seconds"]:.1f} | {has} |', flush=True)


if __name__ == '__main__':
    main()
