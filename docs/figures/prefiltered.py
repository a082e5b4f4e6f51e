#!/usr/bin/env python3
"""prefiltered.py PROGRAM DATA FOLDER [MATERIAL…]: errors of lookups in a prefiltered environment.

Four RGL files, four tables of MERL layout (DATA/../tools/merl_hybrid.py makes them in FOLDER),
glossy and brushed metal, or those named, under four probes and a sun. Runs
`tradeoff --lighting prefiltered` and prints, as the table of docs/explanation/prefiltered.md, for
each material and number of lobes the median and the largest: of the error over all turns, over the
probes; of the relative L2 and FLIP of the sphere as it stands, over the five lights. The last lines
have the median of the materials' medians, and of all their largest the largest.
"""

import json
import statistics
import subprocess
import sys
from pathlib import Path

RGL = ['cg_sunflower', 'satin_rosaline', 'paper_white', 'cc_ibiza_sunset']
MERL = ['gold-paint', 'red-plastic', 'blue-metallic-paint', 'green-fabric']
MODELS = ['ggx:alpha=.25,F0=.9/.6/.3', 'ggx:ax=.15,ay=.4,F0=.9/.6/.3']
PROBES = ['rnl_probe_latlong.hdr', 'grace_probe_angular.hdr:layout=angular',
          'stpeters_probe_latlong.hdr', 'studio_small_03_1k.hdr']
LAMPS = ['sun:elevation=40']


def materials(data, folder):
    for name in RGL:
        yield name, data / 'rgl' / f'{name}_rgb.bsdf'
    for name in MERL:
        table = folder / f'{name}.binary'
        if not table.exists():
            tool = data.parent / 'tools' / 'merl_hybrid.py'
            subprocess.run(['/usr/bin/python3', tool, name, table], check=True,
                           stdout=subprocess.DEVNULL)
        yield name, table
    for model in MODELS:
        yield model, model


def line(name, key, found):
    columns = ' | '.join(f'{middle:.3f} / {most:.3f}' for middle, most in found)
    return f'| {name} | {key} | {columns} |'


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    lights = [str(data / 'env' / probe) for probe in PROBES] + LAMPS
    totals = {}
    print('| material | lookups | all turns, median / worst probe | '
          'sphere, relative L2, median / worst light | FLIP, median / worst light |')
    print('|---|---|---|---|---|')
    for name, spec in materials(data, folder):
        if sys.argv[4:] and name not in sys.argv[4:]:
            continue
        words = [program, 'tradeoff', spec, '--lighting', 'prefiltered', '--json']
        for light in lights:
            words += ['--light', light]
        answer = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
        rows = {}
        for trade in answer['brdfs'][0]['trades']:
            rows.setdefault(trade['settings'], []).append(trade)
        for key, own in sorted(rows.items()):
            measures = [[row['turned_l2'] for row in own if row['light'] not in LAMPS],
                        [row['relative_l2'] for row in own], [row['flip'] for row in own]]
            found = [(statistics.median(values), max(values)) for values in measures]
            print(line(name, key, found), flush=True)
            totals.setdefault(key, []).append(found)
    for key, found in sorted(totals.items()):
        print(line('median; of the worst the largest', key,
                   [(statistics.median(middle for middle, _ in column),
                     max(most for _, most in column)) for column in zip(*found)]))


if __name__ == '__main__':
    main()
