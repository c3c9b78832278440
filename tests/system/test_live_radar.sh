#!/usr/bin/env bash
# A live node with a radar: what is seen before its signatures are made is left out, counted and noted in the recording;
# the recording shows the same radar again, to the bit, and leaves out the same frames. Its library serves another run.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }

cat >"$tmp/trucks.yaml" <<'YAML'
duration_s: 60
place: {lat_deg: 52.1, lon_deg: 9.8, height_m: 80}
ground: {swell_m: 0.2}
dis: {clock: 2026-06-21T09:00:00Z, heartbeat_s: 1}
vehicles:
  - {name: Truck, id: 1, type: 1.1.225.7.1.0.0, route_m: [[0, 0]]}
  - {name: Truck, id: 2, type: 1.1.225.7.1.0.0, route_m: [[30, 14]], heading_deg: 40}
YAML
look=(--bands radar --rate 4 --host observer --no-files --set exercise.aim=1:3001:1 --set observer.range_m=900
    --set observer.height_m=150 --set observer.rate_dps=0 --set exercise.listen_s=0.5 --set radar.preset=search_ku --set radar.ground=false --set radar.library="$tmp/library")
free_port
node radar --address 127.0.0.1 --port $port "${look[@]}" --record "$tmp/radar.pcapng" --for 240
check "it listens" heard_by radar 'listening on' 30
sender "$tmp/trucks.yaml" --send 127.0.0.1:$port
# until both are made, however long this machine takes, and some frames more
for ((i = 0; i < 1500; i++)); do
    [ "$(ls "$tmp/library" 2>/dev/null | grep -c '\.sig$')" -ge 2 ] && break
    sleep 0.1
done
sleep 8
kill -INT "${node[radar]}"
ended radar 60
end_sender
check "ends well" [ $code = 0 ]
check "it says how many frames are without radar" grep -q 'frames are without radar: signatures of targets were still to be made; radar.library' "$tmp/radar.out"

last=$(time_of "$tmp/radar" '$')
replay "$tmp/radar.pcapng" "$tmp/again" --causal --port 0 --to "${last:-0}" "${look[@]}" --threads 1
check "its recording replays" [ $code = 0 ]
check "and says which it was" complained 'frames are without radar: .* when it was recorded'

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
same &= all(live[n]["map_sha256"] == again[n]["map_sha256"] and live[n]["targets"] == again[n]["targets"] for n in live if live[n])
good &= len({live[n]["map_sha256"] for n in live if live[n]}) > 3
print("the same in the replay:", same)
sys.exit(not (good and same))
P
check "left out, counted, and the same in the replay" python3 "$tmp/judge.py" "$tmp/radar" "$tmp/again"
files=$(ls "$tmp/library" | grep -c '^[0-9a-f]\{64\}\.sig$')
check "the library has them ($files), whole" [ "$files" -ge 2 -a "$(ls "$tmp/library" | grep -vc '\.sig$')" = 0 ]

[ "$failures" = 0 ] || { tail -n 12 "$tmp/radar.out"; cat "$tmp/stderr"; }
finish
