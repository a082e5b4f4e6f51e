#!/usr/bin/env python3
"""readme_spheres.py PROGRAM SHARED FOLDER: the picture at the top of the README.

A measured paint, its form of a kilobyte and its OpenPBR fit as spheres under a photographed studio,
side by side in FOLDER/readme_spheres.png; prints what `compare` says of the two. Needs oiiotool.
"""

import subprocess
import sys
from pathlib import Path

SIZE = 240


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True,
                          text=True).stdout


def main():
    program, shared, folder = (Path(word).resolve() for word in sys.argv[1:4])
    folder.mkdir(parents=True, exist_ok=True)
    paint = shared / 'data/rgl/cg_sunflower_rgb.bsdf'
    form, fit, column = (folder / name for name in ('form.json', 'openpbr.json', 'column.png'))
    run(program, 'project', paint, '--form', 'halfway', '--precision', 'half', '-o', form,
        '--force')
    run(program, 'fit', paint, '--model', 'openpbr', '-o', fit, '--force')
    run(program, 'render', paint, form, fit, '--light',
        shared / 'data/env/studio_small_03_1k.hdr', '--by', 'integration', '--error', '20%',
        '--size', SIZE, '-o', column, '--force')
    cuts = []
    for n in range(3):
        cuts.append(folder / f'{n}.png')
        run('oiiotool', column, '--cut', f'{SIZE}x{SIZE}+0+{n * SIZE}', '-o', cuts[-1])
    run('oiiotool', *cuts, '--mosaic:pad=16', '3x1', '-o', folder / 'readme_spheres.png')
    for other in (form, fit):
        answer = run(program, 'compare', paint, other)
        print(other.name, *(line.strip() for line in answer.splitlines() if 'FLIP' in line))


if __name__ == '__main__':
    main()
