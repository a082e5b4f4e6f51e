#!/usr/bin/env python3
"""prefiltered.py PROGRAM DATA FOLDER: errors of lookups in a prefiltered environment.

Four RGL files, six tables of MERL layout (DATA/../tools/merl_hybrid.py makes them in FOLDER),
glossy and brushed metal, under four probes and two lamps. Runs `tradeoff --lighting
prefiltered,split-sum` and prints, as the table of docs/prefiltered.md, for each material and number
of lobes: the error over all turns, the median and the worst of the probes; and of the sphere as it
stands the relative L2 and FLIP, the median over the six lights. Split sums have no error over all
turns.
"""

import json
import statistics
import subprocess
import sys
from pathlib import Path

RGL = ['cg_sunflower', 'satin_rosaline', 'paper_white', 'cc_ibiza_sunset']
MERL = ['gold-paint', 'red-plastic', 'blue-metallic-paint', 'green-fabric', 'brass',
        'specular-green-phenolic']
MODELS = ['ggx:alpha=.25,F0=.9/.6/.3', 'ggx:ax=.15,ay=.4,F0=.9/.6/.3']
PROBES = ['rnl_probe_latlong.hdr', 'grace_probe_angular.hdr:layout=angular',
          'stpeters_probe_latlong.hdr', 'studio_small_03_1k.hdr']
LAMPS = ['sun:elevation=40', 'panel:elevation=50,width=60,height=20']


def materials(data, folder):
    for name in RGL:
        yield name, data / 'rgl' / f'{name}_rgb.bsdf'
    for name in MERL:
        table = folder / f'{name}.binary'
        if not table.exists():
            tool = data.parent / 'tools' / 'merl_hybrid.py'
            subprocess.run(['/usr/bin/python3', tool, name, table], check=True)
        yield name, table
    for model in MODELS:
        yield model, model


def main():
    program, data, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    lights = [str(data / 'env' / probe) for probe in PROBES] + LAMPS
    totals = {}
    print('| material | lookups | all turns, median / worst probe | sphere, relative L2 | FLIP |')
    print('|---|---|---|---|---|')
    for name, spec in materials(data, folder):
        words = [program, 'tradeoff', spec, '--lighting', 'prefiltered,split-sum', '--json']
        for light in lights:
            words += ['--light', light]
        answer = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
        rows = {}
        for trade in answer['brdfs'][0]['trades']:
            key = trade['settings'] if trade['model'] == 'prefiltered' else 'split-sum'
            kept = rows.setdefault(key, {})
            # Of split sums with several faces the one with the least error.
            before = kept.get(trade['light'])
            if before is None or trade['relative_l2'] < before['relative_l2']:
                kept[trade['light']] = trade
        for key in sorted(rows):
            own = list(rows[key].values())
            turned = [row['turned_l2'] for row in own
                      if 'turned_l2' in row and row['light'] not in LAMPS]
            l2 = statistics.median(row['relative_l2'] for row in own)
            flip = statistics.median(row['flip'] for row in own)
            turns = f'{statistics.median(turned):.3f} / {max(turned):.3f}' if turned else ''
            print(f'| {name} | {key} | {turns} | {l2:.3f} | {flip:.3f} |', flush=True)
            middle = statistics.median(turned) if turned else None
            totals.setdefault(key, []).append((middle, max(turned, default=None), l2, flip))
    for key in sorted(totals):
        turned, worst, l2, flip = zip(*totals[key])
        turns = '' if turned[0] is None else f'{statistics.median(turned):.3f} / {max(worst):.3f}'
        print(f'| median (of the worst: the largest) | {key} | {turns} | '
              f'{statistics.median(l2):.3f} | {statistics.median(flip):.3f} |')


if __name__ == '__main__':
    main()
