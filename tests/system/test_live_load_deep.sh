#!/usr/bin/env bash
# A live node in woods under a load that changes: two hundred vehicles come after ten seconds, another program takes a core
# for half a minute, the node itself stands still for 2 s. Of the frames that it promised 95 % are kept all the same, those
# of the standstill apart; the recording replays to the bit. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3
bare=(--set terrain.woods=on)

cat >"$tmp/first.yaml" <<'Y'
duration_s: 900
dis: {site: 1, application: 3001, heartbeat_s: 2}
vehicles:
  - {name: Tank, id: 11, type: tank, force: 2, count: 3, spacing_m: 30, route_m: [[0, 0], [0, 300]], speed_mps: 3, turret: swing}
Y
cat >"$tmp/crowd.yaml" <<'Y'
duration_s: 900
dis: {site: 2, application: 3002, heartbeat_s: 2, bundle: true}
vehicles:
  - {name: Truck, type: truck, force: 1, count: 100, columns: 10, column_m: 16, spacing_m: 16, spread_m: 3, route_m: [[-80, 60], [-80, 400]], speed_mps: 2}
  - {name: Tank, type: tank, force: 2, count: 100, columns: 10, column_m: 16, spacing_m: 16, spread_m: 3, route_m: [[60, -100], [60, 400]], speed_mps: 2, turret: swing}
Y
few=(--size 160x108 --rate 2 --bands optical,lwir --no-files --host observer --set exercise.listen_s=1)
free_port
node load --address 127.0.0.1 --port $port "${few[@]}" --record "$tmp/load.pcapng"
check "it listens" heard_by load 'listening on'
sender "$tmp/first.yaml" --send 127.0.0.1:$port
check "it makes frames" makes load 1
# a core that spins, for the middle of the minute
begun=$SECONDS
after() { local left=$(($1 - (SECONDS - begun))); [ $left -le 0 ] || sleep $left; } # until so many seconds of it
after 10
"$pitviper" exercise "$tmp/crowd.yaml" --send 127.0.0.1:$port >"$tmp/crowd.out" 2>&1 &
crowd=$!
after 20
(while :; do :; done) &
spins=$!
after 45
kill "$spins"; wait "$spins" 2>/dev/null
before_stall=$(lines_in "$tmp/load/truth.jsonl")
kill -STOP "${node[load]}"; sleep 2; kill -CONT "${node[load]}"
after 60
stop load
kill "$crowd"; wait "$crowd" 2>/dev/null
end_sender
check "told to stop: ends well" [ $code = 0 ]
tail -n 8 "$tmp/load.out"
cat >"$tmp/judge.py" <<'P'
import collections, json, sys
out, stall = sys.argv[1], int(sys.argv[2])
run = json.load(open(out + "/run.json"))
live, numbers = run["counters"]["live"], run["frame_number"]
# what was left out while it stood still: the gap of at least 2 s behind those made by then
gaps = [(b - a - 1, a) for a, b in zip(numbers, numbers[1:])]
longest, at = max(gaps)
due = numbers[-1] - numbers[0] + 1 - longest
steps = [json.loads(line).get("given_up", "full") for line in open(out + "/truth.jsonl")]
changes = sum(a != b for a, b in zip(steps, steps[1:]))
behind = numbers.index(at) + 1
later = [b - a - 1 for a, b in zip(numbers[behind + 3:], numbers[behind + 4:])]
print("kept %d of %d (%.1f %%), of the standstill %d left out; %s; %d changes of step; left out behind it %d of %d; entities seen %s" % (
    len(numbers), due, 100 * len(numbers) / due, longest, dict(collections.Counter(steps)), changes, sum(later), len(later),
    run["counters"]["entities"]["created"]))
print("left out behind frames:", ", ".join("%d: %d" % (a, n) for n, a in gaps if n))
lines = [json.loads(line) for line in open(out + "/truth.jsonl")]
for k in range(0, len(lines), 15):
    part = lines[k:k + 15]
    print("  frames %d to %d: rendered in %d ms at most, %s" % (part[0]["frame"], part[-1]["frame"],
        max(f["latency_ms"]["render"] for f in part), dict(collections.Counter(f.get("given_up", "full") for f in part))))
assert run["counters"]["entities"]["created"] >= 203
assert longest >= 3 and behind >= stall - 3      # it stood still, then
assert len(numbers) >= 0.95 * due                # kept
assert sum(later) <= 0.05 * len(later) + 1       # and soon again
assert len(set(steps)) >= 2 and steps[0] == "quarter"
assert changes <= 0.2 * len(steps) + 2           # as in test_deadline.c
P
check "kept, and soon again behind a standstill" python3 "$tmp/judge.py" "$tmp/load" "$before_stall"
replay "$tmp/load.pcapng" "$tmp/again" --causal --port 0 --to "$(time_of "$tmp/load" '$')" "${few[@]}" --only "$(frames_of load)"
check "its recording replays" [ $code = 0 ]
check "to the bit" part_of "$tmp/load" "$tmp/again" 70
[ "$failures" = 0 ] || { tail -n 20 "$tmp/load.out"; cat "$tmp/stderr"; }
finish
