#!/usr/bin/env bash
# A live node with a radar: its detections arrive as Data PDUs, those of truth.jsonl. What is seen before its signatures are
# made is left out, counted and noted in the recording; `replay --causal` of that makes the same maps, detections and targets
# to the bit, and leaves out the same frames. The library of signatures serves another run.
# A tank whose turret turns never has fine ones: each frame has coarse signatures, says so, and is the same to the bit in the
# replay; prepared before they are needed, and that is said.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3

# boxes of six plates, whose signatures take little time: one drives away, one stands, each is of one bin of aspect
box_obj box -1 1 -0.5 0.5 0 1 >"$tmp/box.obj"
printf 'materials: {"*": metal_steel_galvanized}\n' >"$tmp/box.yaml"
printf 'type,model,origin,length_m,width_m,height_m\n1.1.225.83.7.0.0,box.obj,base,,,\n' >"$tmp/catalog.csv"
cat >"$tmp/scene.yaml" <<'Y'
duration_s: 900
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
dis: {site: 1, application: 3001, exercise: 1, version: 7}
vehicles:
  - {name: Box, id: 11, type: 1.1.225.83.7.0.0, force: 2, route_m: [[0, 0], [600, 0]], speed_mps: 2}
  - {name: Box, id: 12, type: 1.1.225.83.7.0.0, force: 2, route_m: [[60, 14]], heading_deg: 40}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, 0]], height_m: 150}
Y
free_port
few=(--size 32x24 --bands lwir --rate 4 --threads 1 --host 1:3001:31 --set exercise.listen_s=0.3 --set publish.dis=sensor
    --set publish.files=false --set sensor.gimbal_limit_deg=180 --set exercise.aim=1:3001:11 --set models.catalog="$tmp/catalog.csv"
    --set radar.preset=search_ku --set radar.ground=false --address 127.0.0.1 --port $port)
# radar_of OUT: of each frame that has targets of the radar, `number radar`, the whole object
radar_of() {
    python3 -c 'import json, sys
for line in open(sys.argv[1]):
    frame = json.loads(line)
    if frame.get("radar", {}).get("targets"): print(frame["frame"], json.dumps(frame["radar"], sort_keys=True))' "$1/truth.jsonl"
}
node live "${few[@]}" --set radar.library="$tmp/library" --record "$tmp/live.pcapng"
check "it listens" heard_by live 'listening on'
sender "$tmp/scene.yaml" --send 127.0.0.1:$port
# while signatures are being made, updates are left out; then a target of the radar has its "rcs_dbsm"
seen() { [ "$(grep -c '"rcs_dbsm":{' "$tmp/live/truth.jsonl")" -ge 5 -a "$(ls "$tmp/library" | grep -c '\.sig$')" -ge 2 ]; }
check "it makes frames" makes live 1
check "the boxes are among the targets of five frames, and kept in the library" until_of live seen
stop live
end_sender
check "the node ends well" [ $code = 0 ] || tail -n 5 "$tmp/live.out"
check "it says how many frames are without radar" grep -q 'frames are without radar: signatures of targets were still to be made; radar.library' "$tmp/live.out"
check "frames without radar are not kept" python3 -c 'import json, sys
run = json.load(open(sys.argv[1])); c = run["counters"]; live = c["live"]
assert live["frames_lacking"] == c.get("frames_without_radar", 0), c
assert abs(live["kept_share"] - (run["frames"] - live["frames_lacking"]) / (run["frames"] + live["frames_late"])) < 1e-9, live' "$tmp/live/run.json"
check "detections on the network are those of truth.jsonl" \
    python3 tests/system/data_pdus.py radar "$tmp/live.pcapng" "$tmp/live/truth.jsonl" 3
files=$(ls "$tmp/library" | grep -c '^[0-9a-f]\{64\}\.sig$')
check "the library has their signatures ($files), whole" [ "$files" -ge 2 -a "$(ls "$tmp/library" | grep -vc '\.sig$')" = 0 ]
radar_of "$tmp/live" | sort >"$tmp/live.radar"
check "the boxes are seen" [ "$(wc -l <"$tmp/live.radar")" -ge 5 ]

cat >"$tmp/judge.py" <<'P'
import json, sys
def frames(out):
    return {f["frame"]: f.get("radar") for f in map(json.loads, open(out + "/truth.jsonl"))}
live, again = frames(sys.argv[1]), frames(sys.argv[2])
absent = sorted(n for n in live if not live[n])
count = json.load(open(sys.argv[1] + "/run.json"))["counters"].get("frames_without_radar", 0)
print("%d live frames, %d without radar: %s; counted %d" % (len(live), len(absent), absent, count))
good = 0 < len(absent) < len(live) and count == len(absent)
same = all(n in again for n in live)
same &= all((live[n] is None) == (again[n] is None) for n in live)
good &= len({live[n]["map_sha256"] for n in live if live[n]}) > 3
print("the same in the replay:", same)
sys.exit(not (good and same))
P
# those frames of what was recorded, with signatures made anew, and with those of the library
those=(--causal --to "$(time_of "$tmp/live" '$')" --only "$(frames_of live)" "${few[@]}")
for library in "" "$tmp/library"; do
    of=${library:+, with the library}
    run replay "$tmp/live.pcapng" --out "$tmp/again" --overwrite "${those[@]}" --set radar.library="$library"
    check "a causal replay$of" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
    check "it says which frames were without$of" complained 'frames are without radar: .* when it was recorded'
    radar_of "$tmp/again" | sort >"$tmp/again.radar"
    check "the same maps, detections and targets to the bit$of" [ -z "$(comm -23 "$tmp/live.radar" "$tmp/again.radar")" ] ||
        diff "$tmp/live.radar" "$tmp/again.radar" | cut -c -600
    check "left out, counted, and the same in the replay$of" python3 "$tmp/judge.py" "$tmp/live" "$tmp/again"
done
check "the library had all that it takes" [ "$(ls "$tmp/library" | wc -l)" = "$files" ]

# the turret turns: no signature is met twice. What is coarse has its note, and the replay the same maps
cat >"$tmp/turret.yaml" <<'Y'
duration_s: 900
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
dis: {site: 1, application: 3001, exercise: 1, version: 7}
vehicles:
  - {name: Tank, id: 11, type: 1.1.222.1.1.1.0, force: 2, route_m: [[0, 0], [600, 0]], speed_mps: 5, turret: swing}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, 0]], height_m: 150}
Y
free_port
turret=(--size 32x24 --bands lwir --rate 4 --threads 1 --host 1:3001:31 --set exercise.listen_s=0.3 --set publish.files=false
    --set sensor.gimbal_limit_deg=180 --set exercise.aim=1:3001:11 --set radar.preset=search_ku --set radar.ground=false
    --address 127.0.0.1 --port $port)
node turret "${turret[@]}" --record "$tmp/turret.pcapng"
check "it listens" heard_by turret 'listening on'
sender "$tmp/turret.yaml" --send 127.0.0.1:$port
coarse() { [ "$(grep -c '"signature":"coarse"' "$tmp/turret/truth.jsonl")" -ge 5 ]; }
check "it makes frames" makes turret 1
check "five frames have coarse signatures" until_of turret coarse
check "it says that it is ready" heard_by turret 'ready: 2 models, [0-9]* signatures, .* s after the first entity'
stop turret
end_sender
check "the node ends well" [ $code = 0 ] || tail -n 5 "$tmp/turret.out"
check "run.json says when it was ready" grep -q '"ready_s": [0-9]' "$tmp/turret/run.json"
kept=$(grep '"signature":"coarse"' "$tmp/turret/truth.jsonl" | sed -n '1s/.*"frame":\([0-9]*\),.*/\1/p')
run replay "$tmp/turret.pcapng" --out "$tmp/turned" --overwrite --causal --to "$(time_of "$tmp/turret" '$')" \
    --only "$(frames_of turret)" "${turret[@]}" --save-frame "$kept"
check "a causal replay" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
run frame "$tmp/turned"/frame_*"$kept".pvf
check "a saved frame ($kept) has its coarse radar again" [ $code = 0 -a -n "$kept" ] || tail -n 3 "$tmp/stderr"
check "coarse frames are noted, counted, and the same to the bit" python3 - "$tmp/turret" "$tmp/turned" <<'P'
import json, sys
live, again = ({f["frame"]: f for f in map(json.loads, open(out + "/truth.jsonl"))} for out in sys.argv[1:])
count = [json.load(open(out + "/run.json"))["counters"].get("frames_of_coarse_radar", 0) for out in sys.argv[1:]]
coarse = [n for n in live if "radar_detail" in live[n].get("given_up", "").split(",")]
print(len(live), "frames,", len(coarse), "coarse, counted", count)
of = lambda f: [t["signature"] for t in f["radar"]["targets"]]
assert all(live[n]["radar"]["targets"][0]["visible_fraction"] > 0.5 for n in coarse)
assert len(coarse) >= 5 and count == [len(coarse)] * 2
assert all(of(live[n]) == ["coarse"] and live[n]["radar"]["targets"][0]["rcs_error_db"]["hh"] == 8 for n in coarse)
assert all(live[n].get("radar") == again[n].get("radar") and live[n].get("given_up") == again[n].get("given_up") for n in live)
P
check "the notes are in the recording" grep -aq 'pitviper: coarse radar in frame' "$tmp/turret.pcapng"

# a signature from elsewhere in place of the box: said, and of its level; what is wrong with one is refused
printf 'entity,signature\nbox,points.csv\n' >"$tmp/given.csv"
printf 'x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,0,20,21\n' >"$tmp/points.csv"
given=(--out "$tmp/given" "${those[@]}" --set radar.given="$tmp/given.csv")
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
[ "$failures" = 0 ] || { tail -n 12 "$tmp/live.out"; cat "$tmp/stderr"; }
finish
