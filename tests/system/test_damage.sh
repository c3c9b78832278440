#!/usr/bin/env bash
# Damage of buildings by DIS: a house is whole until a burst beside it, a house that an entity of kind 5 stands for takes that
# entity's damage and is not drawn twice; from the time of the PDU on and not before, in replay and causal replay, with any
# number of threads, and in a frame file; a house far off stays whole.
. "$(dirname "$0")/common.sh"
bare=("${built[@]}")
judges python3.OpenEXR python3.numpy
cat >"$tmp/s.yaml" <<'Y'
duration_s: 8
seed: 3
place: {lat_deg: 47.3, lon_deg: 9.1, height_m: 430}
dis: {clock: 2026-06-21T12:00:00Z, heartbeat_s: 1}
vehicles:
  - {name: Tank, id: 11, type: 1.1.222.1.1.1.0, heading_deg: 60, route_m: [[0, 0]]}
  - {name: Hut, id: 21, type: 5.1.225.1.1.0.0, route_m: [[30, 25]]}
shots:
  - {from: Tank 11, at: Hut 21, time_s: 3, entity: false, type: 2.2.225.2.1.0.0, damage: moderate, hit: entity, launch_mps: 800}
  - {from: Tank 11, at_m: [-22, 30], time_s: 5, entity: false, type: 2.9.225.1.1.0.0, hit: ground, launch_mps: 800}
Y
python3 - "$tmp" <<'P'
import json, math, sys
def at(x, y): return [9.1 + x / (111320 * math.cos(math.radians(47.3))), 47.3 + y / 111190]
def house(x, y):
    ring = [at(x - 6, y - 4), at(x + 6, y - 4), at(x + 6, y + 4), at(x - 6, y + 4), at(x - 6, y - 4)]
    return {'type': 'Feature', 'properties': {'building': 'house', 'building:levels': '2', 'roof:shape': 'gabled'},
            'geometry': {'type': 'Polygon', 'coordinates': [ring]}}
json.dump({'type': 'FeatureCollection', 'features': [house(30, 25), house(-30, 30), house(70, 80)]},
          open(sys.argv[1] + '/h.geojson', 'w'))
P
cat >"$tmp/c.yaml" <<Y
seed: 6
sensor: {width_px: 120, height_px: 84, rate_hz: 1, hfov_deg: 45, bands: optical}
observer: {range_m: 110, height_m: 60}
terrain: {woods: off, woods_half_m: 150, buildings: $tmp/h.geojson}
heat: {facets: 3, step_s: 3600, shadow_m: 64}
Y
run exercise "$tmp/s.yaml" --out "$tmp/s.pcapng"
check "exercise" [ "$code" = 0 ]
shot() { # shot NAME ARGS ...
    local name=$1
    shift
    run replay "$tmp/s.pcapng" --config "$tmp/c.yaml" --out "$tmp/$name" "$@"
    check "$name: rendered" [ "$code" = 0 ]
}
shot plain --threads 1 --save-frame 5
shot three --threads 3
shot causal --threads 2 --causal
shot again --threads 1 --causal
cp "$tmp/plain/frame_000005.pvf" "$tmp/one.pvf"
run frame "$tmp/one.pvf" --threads 3
check "a frame file has the damage" grep -q 'the same: all' "$tmp/stdout"
check "damage by time" python3 - "$tmp" <<'P'
import glob, json, sys
import numpy as np
import OpenEXR
tmp = sys.argv[1]
truth = lambda name: {round(r['time_s'], 3): r for r in map(json.loads, open(f'{tmp}/{name}/truth.jsonl'))}
plain, three, causal = truth('plain'), truth('three'), truth('causal')
assert {t: r['frame_sha256'] for t, r in plain.items()} == {t: r['frame_sha256'] for t, r in three.items()}
run = json.load(open(f'{tmp}/plain/run.json'))
assert run['scenery']['damaged'] == 2 and run['scenery']['buildings'] == 3, run['scenery']
names = [None] + run['materials']
sooted = []
def planes(name, frame):
    channels = OpenEXR.File(f'{tmp}/{name}/frames/truth/{frame:06d}.exr').channels()
    return {k.split('/')[-1]: c.pixels for k, c in channels.items()}
t0 = min(plain)
shared = sorted(set(plain) & set(causal))
assert len(shared) >= 4, (sorted(plain), sorted(causal))
burnt = {'masonry_sooted', 'rubble'} # as scenery_ruins.c has them; an entity's would be burnt
def burnt_of(name, record):
    p = planes(name, record['frame'])
    material = p['material'].astype(int)
    m = np.isin(material, [k for k, n in enumerate(names) if n in burnt])
    return {int(i): int(np.sum(m & (p['instance'] == i))) for i in np.unique(p['instance'][m])}
seen = {}
for t, r in sorted(plain.items()):
    seen[round(t - t0, 2)] = burnt_of('plain', r)
    # the entity's own model is nowhere
    assert not any(x['entity'].endswith(':21') for x in r['targets']), r
print(seen)
times = sorted(seen)
houses = set().union(*seen.values())
assert len(houses) == 2, houses
first = sorted(min(t for t in times if h in seen[t]) for h in houses)
assert 3 <= first[0] <= 4.01 and 5 <= first[1] <= 6.01, first
assert all(not seen[t] for t in times if t < 3)
for t in shared:
    assert burnt_of('causal', causal[t]).keys() == burnt_of('plain', plain[t]).keys(), t
assert {t: r['frame_sha256'] for t, r in causal.items()} == {t: r['frame_sha256'] for t, r in truth('again').items()}
P
finish
