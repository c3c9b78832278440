#!/usr/bin/env bash
# The reference of the products (pitviper help TOPIC) against products of every kind, both ways, and the lines of Python
# that it shows on them: tests/system/reference.py.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${bare[@]}" "${coarse[@]}")
judges python3.numpy python3.OpenEXR python3.PIL python3.pyproj python3.scipy
needs "writable /dev/shm" test -w /dev/shm
needs "video: built without FFmpeg's libraries" has_video
needs "projector: built without SDL2" has_projector
export SDL_VIDEODRIVER=dummy # frames on a display that is none

run help
check "help: lists the topics" grep -qE '^products truth run\.json exr ' "$tmp/stdout"
for topic in products truth run.json data-pdu stream-pdu radar-pdu regress-record; do
    run help "$topic"
    check "help $topic" [ $code = 0 -a -s "$tmp/stdout" ]
    check "help $topic: lines of a terminal" [ "$(awk '{ if (length > most) most = length } END { print most }' "$tmp/stdout")" -le 120 ]
done
run help truth.jsonl
check "help: a file's name is a topic" grep -q 'targets\[\]\.los_rate_dps' "$tmp/stdout"
run help nonsense
check "help nonsense" [ $code = 2 ] && complained 'no such command or topic: nonsense.*--help'
run help truth run
check "help of two words" [ $code = 2 ] && complained 'not also `run`'
run help --markdown
check "help --markdown" [ $code = 0 ]
cp "$tmp/stdout" "$tmp/products.md"

free_port
with_stream udp://127.0.0.1:$port
printf 'x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,-1,20,20\n' >"$tmp/point.csv"
printf 'entity,signature\n*,point.csv\n' >"$tmp/given.csv"
# a longer wave and fewer pulses, of which fewer rays and samples are traced
sed 's/^search_ku,lfm,16.5,20,512,128,/search_ku,lfm,12.5,20,128,32,/' etc/radars.csv >"$tmp/radars.csv"
# a recogniser that answers, before there is a frame and after, in each form: nothing found, a box, a line of sight
free_port
answers_port=$port
free_port
live_answers_port=$port
python3 -u - "$tmp/sensor/truth.jsonl" $answers_port $live_answers_port <<'PY' &
import json, socket, struct, sys, time
to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
def ring(frame, band, boxes):
    return struct.pack("=8sIHHiIII", b"PVDETECT", 0x01020304, 2, 64, frame, band, len(boxes), 0) + b"".join(
        struct.pack("=5fI32s2I", *box, 0.75, 9, b"surveillance_aircraft", 0, 0) for box in boxes)
def klv(frame, sensor):
    items = bytes([7, 2, frame >> 8, frame & 255, 10, len(sensor)]) + sensor
    octets = bytes.fromhex("060E2B34020B01010E01030306000000") + bytes([len(items) + 4]) + items + b"\1\2"
    return octets + (sum(o << 8 * ((i + 1) % 2) for i, o in enumerate(octets)) & 0xFFFF).to_bytes(2, "big")
def newest(path):  # of a live node: frames that it had no time for have numbers, too
    try: return [json.loads(open(path).read().splitlines()[-1])["frame"]]
    except (OSError, IndexError, ValueError): return []
while True:
    for frame in [*range(40), *newest(sys.argv[1])]:
        lwir = {"frame": frame, "band": "lwir", "detections": [{"class": "tank", "los_deg": [12.5, -3], "range_m": 900}]}
        for octets in ring(frame, 0, []), ring(frame, 1, [(3, 4, 20.5, 10)]), json.dumps(lwir).encode(), klv(frame, b"RADAR"):
            for port in sys.argv[2:]: to.sendto(octets, ("127.0.0.1", int(port)))
    time.sleep(0.05)
PY
answers=$!
senders+=($answers)
# a third, whose eye a head tracker turns, and that shows what it sees
free_port
head_port=$port
python3 -u - $head_port <<'PY' &
import itertools, socket, struct, sys, time
to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for k in itertools.count():
    pose = struct.pack('>4sHHIIQ4f', b'PVHD', 1, 2, k, k % 4, 10000 * k, k % 20 - 10, -5, 1, 1.25)
    for octets in pose, b'none': to.sendto(octets, ('127.0.0.1', int(sys.argv[1])))
    time.sleep(0.01)
PY
senders+=($!)
free_port
node look --address 127.0.0.1 --port $port --size 32x24 --rate 5 --frames 3 --bands lwir --threads 1 --no-files --host observer \
    --set exercise.listen_s=1 --head 127.0.0.1:$head_port --projector lwir
heard_by look 'listening on'
"$pitviper" exercise demo --set duration_s=900 --send 127.0.0.1:$port >"$tmp/look_sender.out" 2>&1 &
senders+=($!)
# two live nodes, each with an exercise of its own, which send what they see; one radar waits for its signatures, the other
# has a point for every entity
for kind in truth sensor; do
    free_port
    radar=(--set radar.table="$tmp/radars.csv" --set radar.preset=search_ku --set radar.ground=false)
    [ $kind = truth ] || radar+=(--set radar.given="$tmp/given.csv" --set publish.detections_port=$live_answers_port)
    node $kind --address 127.0.0.1 --port $port --size 32x24 --rate 5 --frames 3 --no-png --bands lwir,radar --threads 1 \
        "${stream[@]}" "${radar[@]}" --latest \
        --set publish.files=false --set publish.dis=$kind --set exercise.listen_s=1 --record "$tmp/$kind.pcapng"
    heard_by $kind 'listening on'
    "$pitviper" exercise demo --set duration_s=900 --send 127.0.0.1:$port >"$tmp/sender.out" 2>&1 &
    senders+=($!)
done
# all products; then what replaces or leaves out some of them. Of three targets in view the radar's field of one is traced
printf 'entity,signature\ntank,point.csv\n1:3001:22,point.csv\n' >"$tmp/but_one.csv"
exercise demo "$tmp/demo.pcap"
small=(--size 32x24 --rate 1 --threads 1)
run replay "$tmp/demo.pcap" --out "$tmp/all" "${small[@]}" --memory "pitviper-reference-$$" --set publish.detections_port=$answers_port --from 1366 --to 1366 --pairs target --coco \
    --set sensor.preset=staring_lwir,staring_mwir,tv --set sensor.lens_k1=-0.1 --set sensor.lateral_r=0.001 \
    --set radar.table="$tmp/radars.csv" --set radar.preset=search_ku --set radar.scan_deg=4 \
    --set radar.given="$tmp/but_one.csv"
check "all products" [ $code = 0 ] || cat "$tmp/stderr"
cat >"$tmp/two.yaml" <<'Y'
duration_s: 8
vehicles:
  - {name: Tank, type: tank, route_m: [[-15, -4], [0, 3], [20, 0], [50, 6]], speed_mps: 6}
  - {name: Truck, type: truck, route_m: [12, 8]}
  - {name: Jeep, type: jeep, route_m: [12.5, 8]} # behind and within the truck
Y
exercise "$tmp/two.yaml" "$tmp/two.pcap"
run replay "$tmp/two.pcap" --out "$tmp/pan" "${small[@]}" --from 1354 --to 1354 --bands optical --host observer \
    --set sensor.optical=pan --set quality.budget=off --coco --pairs target --no-png
check "other products" [ $code = 0 ] || cat "$tmp/stderr"
regress_case village # with buildings and clutter
"$pitviper" replay "$tmp/village.pcap" "${case_options[@]}" "${quickly[@]}" --out "$tmp/village" --threads 1 --only 0 --bands lwir --no-png \
    --set observer.range_m=300 --set observer.height_m=90 --set radar.preset=seeker_35 --set radar.given="$tmp/given.csv" \
    --coco --set publish.coco_clutter=true >"$tmp/stdout" 2>"$tmp/stderr"
check "products with scenery" [ $? = 0 ] || cat "$tmp/stderr"
python3 tests/tools/cigi_flight.py "$pitviper" "$tmp/demo.pcap" "$tmp/cigi" --rough "${bare[@]}" --size 32x24 --threads 1 --bands lwir \
    >"$tmp/stdout" 2>"$tmp/stderr"
check "products in step with a CIGI host" [ $? = 0 ] || cat "$tmp/stdout" "$tmp/stderr"
printf 'axes: {exercise.host: ["9:9:9", ""]}\n' >"$tmp/sweep.yaml"
run replay "$tmp/two.yaml" --out "$tmp/sweep" "${small[@]}" --from 1356 --to 1356 --bands lwir --coco --sweep "$tmp/sweep.yaml" \
    --set terrain.woods=on --set terrain.woods_half_m=300 --set terrain.woods_trees=5000
python3 tests/system/score_folder.py "$tmp/score" --frames 30
run score "$tmp/score" --max-age 20 --min-visible 0.5
check "a score" [ $code = 0 ]
mkdir "$tmp/case"
cat >"$tmp/case/case.yaml" <<Y
purpose: a record
log: $tmp/two.pcap
config: |
  sensor: {width_px: 32, height_px: 24, rate_hz: 1, optical: pan}
  terrain: {woods: off, buildings: off, clutter: 0}
frames: [4]
Y
run regress --update "$tmp/case" --why reference --work "$tmp/work" --jobs 1 --threads 1
check "a record" [ $code = 0 ] || cat "$tmp/stdout"
cp -r "$tmp/work/case/out" "$tmp/case/out"
"$pitviper" inspect "$tmp/demo.pcap" --pdus tsv --full | head -n 200 >"$tmp/full.tsv"
"$pitviper" inspect "$tmp/demo.pcap" --pdus tsv | head -n 200 >"$tmp/short.tsv"
for kind in truth sensor look; do
    ended $kind
    check "live, $kind" [ $code = 0 ] || cat "$tmp/$kind.out"
done
kill "${senders[@]}" 2>/dev/null
wait "${senders[@]}" 2>/dev/null

variant=$(find "$tmp/sweep" -name variant.json -printf '%h\n')
python3 tests/system/reference.py "$tmp/products.md" --run "$tmp/all" --run "$tmp/pan" --run "$tmp/village" --run "$tmp/cigi" --run "$variant" --run "$tmp/truth" \
    --run "$tmp/sensor" --run "$tmp/look" --sweep "$tmp/sweep" --score "$tmp/score" --record "$tmp/case" --record tests/regress/tank --pdus "$tmp/full.tsv" --pdus "$tmp/short.tsv" \
    --capture "$tmp/truth.pcapng" --live "$tmp/truth" --capture "$tmp/sensor.pcapng" --streams "${#stream[@]}" || fail "products and their reference"

# its twins: a field without a row, a row without a field, a type, an absence, lines that do not run
if [ "$failures" = 0 ]; then
    spoilt() { # spoilt WHAT SED SAID
        sed "$2" "$tmp/products.md" >"$tmp/spoilt.md"
        python3 tests/system/reference.py "$tmp/spoilt.md" --truth "$tmp/pan" >"$tmp/said" 2>&1
        check "$1" grep -qE "^FAILED: $3" "$tmp/said"
    }
    spoilt "no row" '/targets\[\]\.closing_mps/d' 'truth .targets\[[0-9]+\]\.closing_mps is not in the reference'
    spoilt "no such field" 's/targets\[\]\.age_s/targets[].age_h/' 'truth targets\[\]\.age_h is in the reference and in no product'
    spoilt "another type" 's/`targets\[\]\.range_m` | number/`targets[].range_m` | integer/' 'truth .*range_m is no integer'
    spoilt "never absent" 's/when the host is an observer//' 'truth .host.marking is absent'
    spoilt "another channel" 's,channel truth/temp_k` | float,channel truth/temp_k` | uint,' 'exr .*temp_k is float'
    spoilt "lines that do not run" "s/^        if 'box_px' not in target.*/        target['box']/" 'truth Python: '
fi
finish
