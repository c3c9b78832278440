#!/usr/bin/env bash
# Vehicles that hide behind houses and barns: a node of that ground shows them hidden as planned, none of what is built is taken away for
# them; a vehicle that drives through a village drives over no house, in a replay and a causal one alike, and a frame file makes the
# same again.
. "$(dirname "$0")/common.sh"
bare=(--set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=0 --set terrain.detail=off "${coarse[@]}")
cat >"$tmp/hide.yaml" <<'Y'
duration_s: 6
seed: 1
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
ground: {planted: true, buildings: true, spacing_m: 30}
vehicles:
  - {name: Tank, id: 11, type: tank, hide: building, hide_m: 150, count: 2, route_m: [[-300, 450]]}
  - {name: Jeep, id: 21, type: jeep, hide: building, hide_m: 150, count: 2, route_m: [[-300, 450]]}
Y
run exercise "$tmp/hide.yaml" -o "$tmp/hide.pcap" --places "$tmp/hide.csv" --overwrite
check "an exercise that hides" [ "$code" = 0 ]
check "the node's settings are said" said 'terrain.place=50.1,8.6,120 --set seed=1 --set terrain.spacing_m=30 --set terrain.buildings=invented'
printf 'axes: {exercise.aim: ["1:3001:11", "1:3001:12", "1:3001:21", "1:3001:22"], exercise.host: observer, observer.rate_dps: 0}\n' >"$tmp/aims.yaml"
node=(--set terrain.place=50.1,8.6,120 --set seed=1 --set terrain.buildings=invented --set terrain.woods_half_m=300)
replay "$tmp/hide.pcap" "$tmp/o" --bands lwir --from +2 --to +2 --set sensor.hfov_deg=2 "${node[@]}" --sweep "$tmp/aims.yaml" --verbose
check "a node of that ground" [ "$code" = 0 ]
check "nothing is taken away for them" not grep -q 'records are not there' "$(find "$tmp/o" -name log.txt | head -n 1)"
cat >"$tmp/judge.py" <<'PY'
import csv, json, pathlib, sys
planned = {r[0]: float(r[5]) for r in csv.reader(line for line in open(sys.argv[1]) if line[0].isdigit())}
out, within = pathlib.Path(sys.argv[2]), 0
for line in (out / "manifest.jsonl").read_text().splitlines():
    variant = json.loads(line)
    aim = variant["settings"]["exercise.aim"]
    frame = json.loads((out / variant["folder"] / "truth.jsonl").read_text().splitlines()[0])
    target = [t for t in frame["targets"] if t["entity"] == aim]
    off = 1 - target[0]["visible_fraction"] - planned[aim]
    print(aim, planned[aim], round(off, 3))
    within += abs(off) <= 0.1
    assert abs(off) < 0.2 and target[0]["occluded_by"] == "scenery", aim
assert within >= 3, within
PY
check "hidden by the houses, as planned" python3 "$tmp/judge.py" "$tmp/hide.csv" "$tmp/o"

# through the houses that are nearest to a tank which hides there
read -r x y < <(awk -F, '/^1:3001:11,/ { print $9, $10 }' "$tmp/hide.csv")
cat >"$tmp/drive.yaml" <<Y
duration_s: 30
seed: 1
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
ground: {planted: true, spacing_m: 30}
vehicles:
  - {name: Tank, id: 11, type: tank, speed_mps: 8, route_m: [[$(awk -v x="$x" 'BEGIN { print x - 100 }'), $y], [$(awk -v x="$x" 'BEGIN { print x + 100 }'), $(awk -v y="$y" 'BEGIN { print y - 14 }')]]}
Y
exercise "$tmp/drive.yaml" "$tmp/drive.pcap"
look=(--bands lwir --from +12 --to +16 --rate 0.25 --host observer --set exercise.aim=1:3001:11 --set observer.height_m=400 --set observer.range_m=60 "${node[@]}" --set terrain.clutter=4)
replay "$tmp/drive.pcap" "$tmp/d" "${look[@]}" --verbose --save-frame 3
check "a drive through houses" [ "$code" = 0 ]
check "houses give way, and it is said" said 'buildings: [0-9]+ records are not there for what'
check "from above the tank is seen, whole, everywhere" is "$(grep -oE '"visible_fraction":[0-9.]+' "$tmp/d/truth.jsonl" | cut -d: -f2 | sort -n | head -n 1)" '>' 0.97
replay "$tmp/drive.pcap" "$tmp/c" "${look[@]}" --causal --verbose
check "a causal replay of it" [ "$code" = 0 ]
gave() { grep -oE '"buildings":[0-9]+,"damaged":[0-9]+,"lines":[0-9]+' <<<"$(run_json "$1")" | head -n 1; }
check "which has the same buildings" [ -n "$(gave "$tmp/d")" ] 
check "which has the same buildings: as many" [ "$(gave "$tmp/d")" = "$(gave "$tmp/c")" ]
# a frame of it, made again from its file
check "a frame is saved" [ -s "$tmp/d/frame_000003.pvf" ]
run frame "$tmp/d/frame_000003.pvf" --threads 3
check "and made again" [ "$code" = 0 ]
check "to the bit" [ "$(grep -oE 'frame [0-9a-f]{64}' "$tmp/stdout")" = \
    "frame $(grep '"frame":3,' "$tmp/d/truth.jsonl" | grep -oE '"frame_sha256":"[0-9a-f]{64}' | cut -d'"' -f4)" ]
finish
