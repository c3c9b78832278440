#!/usr/bin/env bash
# The radar of radar.preset among what is there: a truck seen among the ground, the same bits for any threads, skips and span; rain
# and chaff; a radar that is refused. On paper: test_radar.sh. labels: slow
. "$(dirname "$0")/common.sh"
judges python3
table=$(dirname "$0")/../../etc/radars.csv

# ground, a truck, a man, and the same bits: map_sha256 and detections of every frame. A seeker like seeker_35 of 13 GHz, whose
# signatures take a seventh of the rays
cat >"$tmp/truck.yaml" <<'Y'
duration_s: 6
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
vehicles:
  - {name: Truck, id: 11, type: truck, force: 2, route_m: [[0, -30], [5, 60]], speed_mps: 8}
  - {name: Man, id: 12, type: person, force: 2, route_m: [[-15, -5]]}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, -100], [-985, 300]], speed_mps: 30, height_m: 100}
Y
exercise "$tmp/truck.yaml" "$tmp/truck.pcap"
map() { grep -o '"radar":.*' "$1/truth.jsonl"; }
{ grep '^name,' "$table"; sed -n 's/^seeker_35,lfm,35,/seeker,lfm,13,/p' "$table"; } >"$tmp/seeker.csv"
small=(--host 1:3001:31 --set exercise.aim=1:3001:11 --set sensor.gimbal_limit_deg=180 --bands radar --size 48x32
    --set radar.preset=seeker --set radar.table="$tmp/seeker.csv" --rate 1 --overwrite "${coarse[@]}")
run replay "$tmp/truck.pcap" --out "$tmp/one" "${small[@]}" --only 3,4 --threads 1 --set radar.library="$tmp/library"
check "a seeker" [ $code = 0 ] || cat "$tmp/stderr"
run replay "$tmp/truck.pcap" --out "$tmp/two" "${small[@]}" --only 4 --threads 2 --no-skip
check "the last frame alone, two threads, no skips: the same bits" \
    [ -n "$(map "$tmp/two")" -a "$(map "$tmp/two")" = "$(map "$tmp/one" | tail -n 1)" ]
run replay "$tmp/truck.pcap" --out "$tmp/bare" "${small[@]}" --only 4 --threads 1 --set radar.ground=false --set radar.library="$tmp/library"
check "without ground: fewer echoes" [ "$(json_numbers "$tmp/bare/truth.jsonl" ground_cells | head -n 1)" = 0 ]
# of the same entities: the ground in the map has no such error, their cross sections have it all the same
share() { grep -o '"range_doppler":{[^}]*}' "$1/truth.jsonl" | tail -n 1 | sed -E "s/.*\"$2\":([^,}]*).*/\1/"; }
without=$(share "$tmp/bare" sampling) with=$(share "$tmp/two" sampling)
check "the map's error by ray tubes: without ground $without, with it $with: less" is "$without" '>' "$with"
check "that of cross sections: the same" is "$(share "$tmp/bare" sampling_db)" == "$(share "$tmp/two" sampling_db)"
python3 - "$tmp/one/truth.jsonl" <<'P' || fail "the truck that the seeker looks at"
import json, sys
good = 0
for line in open(sys.argv[1]):
    frame = json.loads(line)
    aim = [t for t in frame["radar"]["targets"] if abs(t["az_deg"]) < 0.1 and t["visible_fraction"] > 0.5]
    near = [d for d in frame["radar"]["detections"][:5] if aim and abs(d["range_m"] - aim[0]["range_m"]) < 5 and
            abs(d["range_rate_mps"] - aim[0]["range_rate_mps"]) < 3 and abs(d["az_deg"]) < 0.6]
    good += bool(near)
    print("aim %.1f dBsm at %.1f m: %d of the five strongest are on it; ground: %d cells, %d hidden" % (
        aim[0]["rcs_dbsm"]["vv"], aim[0]["range_m"], len(near), frame["radar"]["ground_cells"], frame["radar"]["ground_hidden"]))
    good -= frame["radar"]["ground_cells"] < 1000
sys.exit(good < 1)
P

# rain, and a cloud of chaff 50 m before the aim: no entity of the picture, but of the radar's scene
cat >"$tmp/chaff.yaml" <<'Y'
duration_s: 8
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
dis: {site: 1, application: 3001, exercise: 1, version: 7}
vehicles:
  - {name: Aim, id: 11, type: 8.3.225.5.0.0.0, force: 2, route_m: [[0, 0]]}
  - {name: Cloud, id: 12, type: 8.2.225.1.1.0.0, force: 2, route_m: [[-50, 0]], height_m: 20}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, 0]], height_m: 100}
Y
exercise "$tmp/chaff.yaml" "$tmp/chaff.pcap"
wet=(--host 1:3001:31 --set sensor.gimbal_limit_deg=180 --set exercise.aim=1:3001:11 --bands radar --size 48x32 --only 5
    --threads 1 --set radar.preset=seeker_35 "${coarse[@]}")
replay "$tmp/chaff.pcap" "$tmp/wet" "${wet[@]}" --set weather.rain_mmh=10
check "rain and chaff" [ $code = 0 ]; [ $code = 0 ] || tail -n 3 "$tmp/stderr"
replay "$tmp/chaff.pcap" "$tmp/dry" "${wet[@]}" --set radar.chaff_dipoles=0
python3 - "$tmp/wet/truth.jsonl" "$tmp/dry/truth.jsonl" <<'P' || fail "their weather"
import json, sys
wet, dry = (json.loads(open(name).read().splitlines()[-1]) for name in sys.argv[1:])
rain = wet["radar"]["air_db"] - dry["radar"]["air_db"]
print("rain %.3f dB one way over %.0f m, %.2e m2/m3; chaff: %d, %d" % (rain, wet["radar"]["reference_m"], wet["radar"]["rain_1_m"],
      wet["radar"]["chaff"], dry["radar"]["chaff"]))
# P.838-3 at 35 GHz, 10 mm/h: 2.5 dB/km
good = 2.0 < rain / wet["radar"]["reference_m"] * 1000 < 2.9 and dry["radar"]["rain_1_m"] == 0 and wet["radar"]["rain_1_m"] > 1e-4
good &= wet["radar"]["chaff"] == 1 and dry["radar"]["chaff"] == 0
good &= all(t["entity"] != "1:3001:12" for frame in (wet, dry) for t in frame["radar"]["targets"] + frame.get("targets", []))
sys.exit(not good)
P

run replay "$tmp/truck.pcap" --out "$tmp/none" "${small[@]}" --set radar.table= --set radar.preset=hubble
check "an unknown radar is refused, and the known ones said" [ $code = 1 ] && complained 'hubble.*seeker_94, seeker_35, search_ku'
check "and nothing rendered" [ "$(find "$tmp/none" -name '*.exr' 2>/dev/null | wc -l)" = 0 ]
finish
