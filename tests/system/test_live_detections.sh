#!/usr/bin/env bash
# A live node with a radar: its detections arrive as Data PDUs, those of truth.jsonl; and `replay --causal` of what it
# recorded makes the same maps, detections and targets to the bit. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }

# a box of six plates, whose signature takes little time, that drives away: it is of one bin of aspect
cat >"$tmp/box.obj" <<'O'
o box
v -2 -1 0
v 2 -1 0
v 2 1 0
v -2 1 0
v -2 -1 2
v 2 -1 2
v 2 1 2
v -2 1 2
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
O
printf 'materials: {"*": metal_steel_galvanized}\n' >"$tmp/box.yaml"
printf 'type,model,origin,length_m,width_m,height_m\n1.1.225.83.7.0.0,box.obj,base,,,\n' >"$tmp/catalog.csv"
cat >"$tmp/scene.yaml" <<'Y'
duration_s: 300
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
dis: {site: 1, application: 3001, exercise: 1, version: 7}
vehicles:
  - {name: Box, id: 11, type: 1.1.225.83.7.0.0, force: 2, route_m: [[0, 0], [600, 0]], speed_mps: 2}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, 0]], height_m: 150}
Y
free_port
few=(--size 32x24 --bands lwir --rate 2 --threads 1 --host 1:3001:31 --set exercise.listen_s=0.3 --set publish.dis=sensor
    --set publish.files=false --set sensor.gimbal_limit_deg=180 --set exercise.aim=1:3001:11 --set models.catalog="$tmp/catalog.csv"
    --set radar.preset=search_ku --set radar.ground=false --address 127.0.0.1 --port $port)
# radar_of OUT: of each frame that has targets of the radar, `number radar`, the whole object
radar_of() {
    python3 -c 'import json, sys
for line in open(sys.argv[1]):
    frame = json.loads(line)
    if frame.get("radar", {}).get("targets"): print(frame["frame"], json.dumps(frame["radar"], sort_keys=True))' "$1/truth.jsonl"
}
node live "${few[@]}" --for 200 --record "$tmp/live.pcapng"
check "it listens" heard_by live 'listening on' 60
sender "$tmp/scene.yaml" --send 127.0.0.1:$port
# until the box is among the targets of four frames: while its signature is being made, updates are left out
for ((i = 0; i < 300; i++)); do
    [ "$(radar_of "$tmp/live" 2>/dev/null | wc -l)" -lt 4 ] || break
    sleep 0.5
done
kill -INT "${node[live]}" 2>/dev/null
ended live 60
end_sender
check "the node ends well" [ $code = 0 ] || tail -n 5 "$tmp/live.out"
check "detections on the network are those of truth.jsonl" \
    python3 tests/system/data_pdus.py radar "$tmp/live.pcapng" "$tmp/live/truth.jsonl" 3
run replay "$tmp/live.pcapng" --out "$tmp/again" --causal --to "$(time_of "$tmp/live" '$')" "${few[@]}"
check "a causal replay" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
radar_of "$tmp/live" | sort >"$tmp/a"
radar_of "$tmp/again" | sort >"$tmp/b"
check "the box is seen" [ "$(wc -l <"$tmp/a")" -ge 3 ]
check "the same maps, detections and targets to the bit" [ -z "$(comm -23 "$tmp/a" "$tmp/b")" ] || diff "$tmp/a" "$tmp/b" | cut -c -600

# a signature from elsewhere in place of the box: said, and of its level; what is wrong with one is refused
printf 'entity,signature\nbox,points.csv\n' >"$tmp/given.csv"
printf 'x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,0,20,21\n' >"$tmp/points.csv"
given=(--out "$tmp/given" --causal --to "$(time_of "$tmp/live" '$')" "${few[@]}" --set radar.given="$tmp/given.csv")
run replay "$tmp/live.pcapng" "${given[@]}"
check "a given signature" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
check "its cross section is found, within 0.3 dB" python3 - "$tmp/given/truth.jsonl" <<'P'
import json, sys
radar = [r for r in (json.loads(line).get("radar") for line in open(sys.argv[1])) if r][-1]
box = [t for t in radar["targets"] if t["entity"] == "1:3001:11"][0]
assert box["signature"] == "given" and abs(box["rcs_dbsm"]["hh"] - 20) < 0.01 and "rcs_error_db" not in box, box
assert abs(radar["detections"][0]["rcs_dbsm"] - 20) < 0.3, radar["detections"][0]
P
check "its list is among the tables of the run" grep -q '"radar/given.csv"' "$tmp/given/run.json"
printf 'x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,far,20,21\n' >"$tmp/points.csv"
run replay "$tmp/live.pcapng" "${given[@]}" --overwrite
check "a wrong one is refused with file and line" [ $code = 1 ] && complained 'points.csv:2'
printf 'radar: {given: %s}\n' "$tmp/given.csv" >"$tmp/bad.yaml"
run check "$tmp/bad.yaml"
check "and by check" [ $code = 1 ] && complained 'radar.given'
finish
