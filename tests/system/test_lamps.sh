#!/usr/bin/env bash
# Lamps by night (terrain.lamps): a village is seen in optical and swir; with the sun up there is no bit of them; threads
# change none, a frame file has them, `explain` adds them up; run.json counts them; their spectra are those of CIE's illuminants
# and of black bodies.
. "$(dirname "$0")/common.sh"
bare=("${built[@]}")
judges python3.OpenEXR python3.numpy python3.PIL python3.colour

# ---- spectra, by colour-science ------------------------------------------------------------------
check "spectra" python3 - etc/lamps.csv <<'P'
import csv, sys, warnings
import numpy as np
warnings.filterwarnings("ignore")
import colour
rows = {r['name']: r for r in csv.DictReader((l for l in open(sys.argv[1]) if l[0] != '#'), skipinitialspace=True)}
photopic = colour.SDS_LEFS['CIE 1924 Photopic Standard Observer']
um = np.arange(300.025, 4000, 0.05) # nm
v = np.interp(um, photopic.wavelengths, photopic.values, left=0, right=0)
edges = {'b': (400, 500), 'g': (500, 600), 'r': (600, 700), 'nir': (700, 1100), 'swir': (1000, 1700)}
def planck(k):
    return 1 / um ** 5 / np.expm1(1.438776877e7 / (um * k))
def cie(name):
    sd = colour.SDS_ILLUMINANTS[name]
    return np.interp(um, sd.wavelengths, sd.values, left=0, right=0)
of = {'window_led': (cie('LED-B2'), 'b g r'), 'window_tungsten': (planck(2856), 'b g r nir swir'),
      'street_led': (cie('LED-B3'), 'b g r'), 'street_sodium': (cie('HP1'), 'b g r'),
      'headlamp_halogen': (planck(3200), 'b g r nir swir'), 'headlamp_led': (cie('LED-B5'), 'b g r')}
assert set(of) == set(rows), set(rows)
for name, (spectrum, bands) in of.items():
    lm = 683 * np.sum(spectrum * v)
    for b in bands.split():
        low, high = edges[b]
        want = np.sum(spectrum[(um >= low) & (um < high)]) / lm
        got = float(rows[name]['w_lm_' + b])
        assert abs(got / want - 1) < 0.01, (name, b, got, want)
P

# ---- a village ------------------------------------------------------------------------------------
sed 's/T12:00:00Z/T20:30:00Z/' tests/regress/village/scenario.yaml >"$tmp/night.yaml"
for at in noon night; do
    file=$tmp/night.yaml
    [ $at = night ] || file=tests/regress/village/scenario.yaml
    run exercise "$file" --out "$tmp/$at.pcap"
    check "$at: made" [ "$code" = 0 ]
done
cat >"$tmp/c.yaml" <<'Y'
seed: 6
sensor: {width_px: 160, height_px: 108, rate_hz: 1, hfov_deg: 45, bands: optical}
observer: {range_m: 150, height_m: 60}
terrain: {woods: off, woods_half_m: 120, buildings: invented, clutter: 1}
heat: {facets: 3, step_s: 3600, shadow_m: 64}
Y
shot() { # shot NAME LOG ARGS ...: one frame
    local name=$1 log=$2
    shift 2
    run replay "$tmp/$log.pcap" --config "$tmp/c.yaml" --out "$tmp/$name" --only 0 "$@"
    check "$name: rendered" [ "$code" = 0 ]
}
hash_of() { grep -oE '"frame_sha256":"[0-9a-f]{64}' "$tmp/$1/truth.jsonl" | grep -oE '[0-9a-f]{64}'; }
shot noon noon --threads 2
shot noon_dark noon --threads 2 --set terrain.lamps=off
check "with the sun up no bit changes" [ "$(hash_of noon)" = "$(hash_of noon_dark)" ]
shot lit night --threads 1 --save-frame 0
shot lit_three night --threads 3
shot dark night --threads 2 --set terrain.lamps=off
check "threads change no bit" [ "$(hash_of lit)" = "$(hash_of lit_three)" ]
check "by night bits change" [ "$(hash_of lit)" != "$(hash_of dark)" ]
shot swir night --threads 2 --set sensor.bands=swir
shot swir_dark night --threads 2 --set sensor.bands=swir --set terrain.lamps=off
check "lamps are in run.json" python3 - "$tmp" <<'P'
import glob, json, sys
import numpy as np
import OpenEXR
tmp = sys.argv[1]
def plane(name):
    path, = glob.glob(f'{tmp}/{name}/frames/[!t]*/000000.exr')
    return np.concatenate([np.atleast_3d(c.pixels) for c in OpenEXR.File(path).channels().values()], 2)
lamps = json.load(open(f'{tmp}/lit/run.json'))['scenery']['lamps']
assert lamps['windows'] > 50 and lamps['street'] > 5, lamps
assert not any(json.load(open(f'{tmp}/dark/run.json'))['scenery']['lamps'].values())
for lit, dark in (('lit', 'dark'), ('swir', 'swir_dark')):
    a, b = plane(lit), plane(dark)
    more = a - b
    print(f'{lit}: mean {b.mean():.3g} -> {a.mean():.3g}, brightest {b.max():.3g} -> {a.max():.3g}, lit {np.mean(more > 0.1 * b):.3f}')
    assert more.min() >= 0 and a.max() > 10 * b.max() and 0.02 < np.mean(more > 0.1 * b) < 0.9
    y, x = np.unravel_index(np.argmax(more.sum(2)), more.shape[:2])
    if lit == 'lit': open(f'{tmp}/at', 'w').write(f'{x} {y}\n')
P
cp "$tmp/lit/frame_000000.pvf" "$tmp/one.pvf"
run frame "$tmp/one.pvf" --threads 3
check "a frame file has its lamps" grep -q "frame $(hash_of lit)" "$tmp/stdout"
read -r x y <"$tmp/at"
run explain "$tmp/lit" 0 "$x" "$y" --json
check "explain: the sum is the plane's value" python3 - "$tmp/stdout" <<'P'
import json, sys
e = json.load(open(sys.argv[1]))
of = [p for p in e['planes'] if 'channel' in p]
assert of and all(p['same'] and p['terms']['lamps'] > 0.5 * p['value'] for p in of), of
P
finish
