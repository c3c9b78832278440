#!/usr/bin/env bash
# Vehicles that hide behind garden walls: a node of that ground shows them hidden as the exercise said, by what is built.
. "$(dirname "$0")/common.sh"
bare=(--set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=0 --set terrain.detail=off "${coarse[@]}")
cat >"$tmp/hide.yaml" <<'Y'
duration_s: 6
seed: 1
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
ground: {planted: true, buildings: true, spacing_m: 30}
vehicles:
  - {name: Tank, id: 11, type: tank, hide: wall, hide_m: 300, occlusion: 0.2, count: 2, route_m: [[277, 1706]]}
  - {name: Jeep, id: 21, type: jeep, hide: wall, hide_m: 300, occlusion: 0.3, count: 2, route_m: [[277, 1706]]}
Y
run exercise "$tmp/hide.yaml" -o "$tmp/hide.pcap" --places "$tmp/hide.csv" --overwrite
check "an exercise that hides behind walls" [ "$code $(grep -c ',wall,' "$tmp/hide.csv")" = '0 4' ]
sed 's/\[\[277, 1706\]\]/[[-300, 450]]/' "$tmp/hide.yaml" >"$tmp/none.yaml"
run exercise "$tmp/none.yaml" -o "$tmp/none.pcap" --overwrite
check "where there is no wall it is said, with what to do" complained 'no room at a place of kind wall; try hide_m'
printf 'axes: {exercise.aim: ["1:3001:11", "1:3001:12", "1:3001:21", "1:3001:22"], exercise.host: observer, observer.rate_dps: 0}\n' >"$tmp/aims.yaml"
replay "$tmp/hide.pcap" "$tmp/o" --bands lwir --from +2 --to +2 --set sensor.hfov_deg=2 --set terrain.place=50.1,8.6,120 --set seed=1 \
    --set terrain.buildings=invented --set terrain.woods_half_m=300 --sweep "$tmp/aims.yaml" --verbose
check "a node of that ground" [ "$code" = 0 ]
check "no wall is taken away for them" not grep -q 'records are not there' "$(find "$tmp/o" -name log.txt | head -n 1)"
cat >"$tmp/judge.py" <<'PY'
import csv, json, pathlib, sys
said = {r[0]: (float(r[5]), float(r[6])) for r in csv.reader(line for line in open(sys.argv[1]) if line[0].isdigit())}
out, by_walls = pathlib.Path(sys.argv[2]), 0
for line in (out / "manifest.jsonl").read_text().splitlines():
    variant = json.loads(line)
    aim = variant["settings"]["exercise.aim"]
    frame = json.loads((out / variant["folder"] / "truth.jsonl").read_text().splitlines()[0])
    target = [t for t in frame["targets"] if t["entity"] == aim][0]
    planned, judged = said[aim]
    hidden = 1 - target["visible_fraction"]
    print(aim, planned, judged, round(hidden, 3), target["occluded_by"])
    assert abs(hidden - judged) < 0.1 and abs(hidden - planned) < 0.1, aim
    by_walls += target["occluded_by"] == "scenery"  # of the rest a tree beside the wall hides more
assert by_walls >= 3, by_walls
PY
check "hidden by walls, as planned and as it was judged by rays" python3 "$tmp/judge.py" "$tmp/hide.csv" "$tmp/o"
finish
