#!/usr/bin/env bash
# Vehicles that hide: a scenario places them among the plants of an invented ground, a node of that ground shows them hidden as
# planned; a net covers. A sweep varies the scenario itself: types, seeds, places by name; it records each exercise once, and
# keeps the ground from one to the next.
. "$(dirname "$0")/common.sh"
bare=(--set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=0 --set terrain.detail=off --set terrain.buildings=off
    --set terrain.clutter=0 "${coarse[@]}") # buildings: test_hiding_built.sh

cat >"$tmp/hide.yaml" <<'Y'
duration_s: 6
seed: 1
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
ground: {planted: true, buildings: false, spacing_m: 30}
vehicles:
  - {name: Tank, id: 11, type: 1.1.222.1.1.1.0, hide: tree-line, hide_m: 400, occlusion: 0.6, route_m: [[-400, -300]]}
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, hide: hedge, hide_m: 400, occlusion: 0.3, route_m: [[300, -300]]}
  - {name: Open, id: 31, type: 1.1.222.1.1.1.0, hide: open, hide_m: 300, route_m: [[0, 0]], net: true}
Y
place=50.1,8.6,120
run exercise "$tmp/hide.yaml" -o "$tmp/hide.pcap" --places "$tmp/hide.csv" --overwrite
check "an exercise that hides" [ "$code" = 0 ]
check "the node's settings are said" said "terrain.place=$place --set seed=1 --set terrain.spacing_m=30"
check "three places" [ "$(grep -cE '^1:3001:' "$tmp/hide.csv")" = 3 ]
column() { awk -F, -v id="$1" -v of="$2" '$1 == id { print $of }' "$tmp/hide.csv"; }
for id in 1:3001:11 1:3001:21; do
    check "$id: by rays it is hidden as planned" is "$(awk -v a="$(column $id 6)" -v b="$(column $id 7)" 'BEGIN { print (a - b) ^ 2 }')" '<' 0.0026
done
cp "$tmp/hide.csv" "$tmp/before.csv"
cp "$tmp/hide.pcap" "$tmp/before.pcap"
run exercise "$tmp/hide.yaml" -o "$tmp/hide.pcap" --places "$tmp/hide.csv" --overwrite
check "the same octets, and the same places" [ "$(cat "$tmp/hide.csv" "$tmp/hide.pcap" | sha256sum)" = "$(cat "$tmp/before.csv" "$tmp/before.pcap" | sha256sum)" ]
run exercise "$tmp/hide.yaml" -o "$tmp/hide.pcap" --places "$tmp/hide.csv"
check "places are not written over" [ "$code" = 1 ]

# what a node sees of each, from where it was to be hidden
printf 'axes: {exercise.aim: ["1:3001:11", "1:3001:21", "1:3001:31"], exercise.host: observer, observer.rate_dps: 0}\n' >"$tmp/aims.yaml"
looks=(--bands lwir --size 96x64 --threads 2 --from +2 --to +2 --set sensor.hfov_deg=2)
replay "$tmp/hide.pcap" "$tmp/o" "${looks[@]}" --set terrain.place=$place --sweep "$tmp/aims.yaml"
check "a node of that ground" [ "$code" = 0 ]
hidden() { # OUT AIM: of its target, 1 - visible_fraction
    local folder
    folder=$(grep "\"exercise.aim\":\"$2\"" "$1/manifest.jsonl" | grep -oE 'v[0-9a-f]{10}' | head -n 1)
    grep -oE "\"entity\":\"$2\",.*" "$1/$folder/truth.jsonl" | grep -oE '"visible_fraction":[0-9.]+' | head -n 1 | awk -F: '{ print 1 - $2 }'
}
for id in 1:3001:11 1:3001:21; do
    check "$id: truth has it hidden as planned" is "$(awk -v a="$(column $id 6)" -v b="$(hidden "$tmp/o" $id)" 'BEGIN { print b == "" ? 9 : (a - b) ^ 2 }')" '<' 0.0226
done
check "a net covers 0.6 .. 0.8" is "$(hidden "$tmp/o" 1:3001:31)" '>' 0.6
check "a net covers 0.6 .. 0.8, not more" is "$(hidden "$tmp/o" 1:3001:31)" '<' 0.8
check "they stand on the node's ground" grep -qE 'contact: .* at most 0\.[01] m' "$(find "$tmp/o" -name log.txt | head -n 1)"

# a sweep of the scenario itself
cat >"$tmp/axes.yaml" <<'Y'
mode: zip
axes:
  seed: [1, 1, 2]
  scenario.vehicles.Tank.type: [1.1.222.1.1.1.0, 1.1.222.7.1.0.0, 1.1.222.1.1.1.0]
  scenario.seed: [1, 2, 1]
  exercise.aim: 1:3001:11
  exercise.host: observer
Y
replay "$tmp/hide.yaml" "$tmp/s" "${looks[@]}" --sweep "$tmp/axes.yaml" --verbose
check "a sweep of a scenario" [ "$code $(grep -c '"status":"made"' "$tmp/s/manifest.jsonl")" = '0 3' ]
check "rows say what each was" grep -q '"seed":"1","scenario.vehicles.Tank.type":"1.1.222.7.1.0.0","scenario.seed":"2"' "$tmp/s/manifest.jsonl"
check "each has its exercise" [ "$(grep -oE '"exercise":"e[0-9a-f]{10}"' "$tmp/s/manifest.jsonl" | sort -u | wc -l)" = 3 ]
check "recorded, with its places" [ "$(find "$tmp/s/exercises" -name 'e*.pcapng' | wc -l) $(find "$tmp/s/exercises" -name 'e*.csv' | wc -l)" = '3 3' ]
variant() { grep -oE '"folder":"v[0-9a-f]{10}"' "$tmp/s/manifest.jsonl" | cut -d'"' -f4 | sed -n "$1p"; }
class() { grep -oE '"entity":"1:3001:11",.*' "$tmp/s/$(variant "$1")/truth.jsonl" | grep -oE '"class":"[a-z]+"' | head -n 1; }
check "another type is another class" [ "$(class 1) $(class 2)" = '"class":"tank" "class":"truck"' ]
made() { grep -cE "world: $2 made$" "$tmp/s/$(variant "$1")/log.txt"; }
check "the ground of a seed is made once, the catalog too" [ "$(made 1 ground)$(made 2 ground)$(made 3 ground) $(made 1 catalog)$(made 2 catalog)$(made 3 catalog)" = '101 100' ]
folder=$(variant 2)
exercise=$(grep -oE "\"exercise\":\"e[0-9a-f]{10}\"" <<<"$(grep "$folder" "$tmp/s/manifest.jsonl")" | cut -d'"' -f4)
check "how it is made again" grep -qE "^# To reproduce: pitviper replay exercises/$exercise.pcapng --config THIS" "$tmp/s/$folder/settings.yaml"
run replay "$tmp/s/exercises/$exercise.pcapng" -c "$tmp/s/$folder/settings.yaml" --out "$tmp/alone" --overwrite --threads 1 --bands lwir --size 96x64
check "alone it has the same bits" same_hashes "$tmp/alone" "$tmp/s/$folder"
before=$(stat -c %Y%s "$tmp"/s/exercises/*.pcapng)
replay "$tmp/hide.yaml" "$tmp/s" "${looks[@]}" --sweep "$tmp/axes.yaml" --verbose
check "again: kept" [ "$code $(grep -c '"status":"kept"' "$tmp/s/manifest.jsonl")" = '0 3' ]
check "no exercise is recorded twice" [ "$before" = "$(stat -c %Y%s "$tmp"/s/exercises/*.pcapng)" ]

# what is refused, in one line
wrong() { # WORDS LOG AXES
    printf '%s\n' "$3" >"$tmp/wrong.yaml"
    replay "$2" "$tmp/w" "${looks[@]}" --sweep "$tmp/wrong.yaml"
    check "refused: $1" complained "$1"
    check "refused: exit code" [ "$code" = 2 ]
}
wrong 'scenario.seed: is of a scenario, and a recording is replayed' "$tmp/hide.pcap" 'axes: {scenario.seed: [1, 2]}'
wrong "there are no vehicles with name: 'Tnak'" "$tmp/hide.yaml" 'axes: {scenario.vehicles.Tnak.type: [tank]}'
wrong "seed: '-1'" "$tmp/hide.yaml" 'axes: {scenario.seed: [-1]}'
wrong 'no such key: sede' "$tmp/hide.yaml" 'axes: {scenario.sede: [1]}'
wrong 'is not a number' "$tmp/hide.yaml" '{mode: random, count: 2, axes: {scenario.vehicles.Tank.type: {from: 1, to: 2}}}'
wrong 'terrain.place is that of the scenario' "$tmp/hide.yaml" 'axes: {terrain.place: ["1,2,3"]}'
wrong "terrain.place: '91,0,0' is not latitude" "$tmp/hide.pcap" 'axes: {terrain.place: ["91,0,0"]}'
run exercise demo -o "$tmp/demo.pcap" --places "$tmp/demo.csv" --overwrite
check "nothing hides without a ground" [ "$code" = 1 ]
check "nothing hides without a ground: said" complained 'needs ground.planted'
finish
