#!/usr/bin/env bash
# `pitviper fly` in the loop: a missile that flies by what is seen in its own frames hits; with the true line of sight as `fly`
# without frames has it, by a recogniser that knows where the target is, and again by the recording of its answers, to the bit.
. "$(dirname "$0")/common.sh"

judges python3.numpy
. "$(dirname "$0")/../tools/loop_common.sh"

# ---- the true line of sight of each frame
more=(--threads 2)
loop ideal --frames "$tmp/ideal" -o "$tmp/ideal.pcap"
run fly "$tmp/short.yaml"
cp "$tmp/stdout" "$tmp/free.csv"
check "it hits" [ "$(cell ideal hit)" = entity ]
check "within 0.3 m of the target's centre: $(cell ideal miss_m)" is "$(cell ideal miss_m)" '<' 0.3
check "and not by chance: 0.05 m" is "$(cell ideal miss_m)" '<' 0.05
check "when the flight without frames does: $(cell ideal flight_s) and $(cell free flight_s) s" \
    is "$(awk -v a="$(cell ideal flight_s)" -v b="$(cell free flight_s)" 'BEGIN { print (a - b) ^ 2 }')" '<' 1e-4
check "a frame each 0.1 s of 3.5 s" [ "$(cell ideal frames)" = 36 ]
check "as many lines of truth" [ "$(lines_in "$tmp/ideal/truth.jsonl")" = 36 ]
check "by the missile's eye" [ "$(host_of "$tmp/ideal")" = 1:3001:41 ]
check "truth says so, too" [ "$(grep -c '"host":{"entity":"1:3001:41"' "$tmp/ideal/truth.jsonl")" = 36 ]

# ---- a recogniser that knows the target's line of sight
loop known --frames "$tmp/known" --recogniser "$knows" -o "$tmp/known.pcap"
check "it hits" [ "$(cell known hit)" = entity ]
check "within half a vehicle's height of its centre: $(cell known miss_m)" is "$(cell known miss_m)" '<' 1
check "every frame was answered" [ "$(cell known none)" = 0 ]
check "and nearly all were seen: $(cell known seen) of $(cell known frames)" is "$(cell known seen)" '>' 33
check "sights.csv has a row a frame" [ "$(lines_in "$tmp/known/sights.csv")" = "$(($(cell known seen) + $(cell known empty) + $(cell known outside) + 1))" ]

# ---- the same flight by its recording, with another number of threads: its frames and its exercise to the bit
more=(--threads 1)
loop again --frames "$tmp/again" --sights "$tmp/known/sights.csv" -o "$tmp/again.pcap"
check "the same frames" cmp -s "$tmp/known/truth.jsonl" "$tmp/again/truth.jsonl"
check "the same exercise" cmp -s "$tmp/known.pcap" "$tmp/again.pcap"
check "the same row" cmp -s "$tmp/known.csv" "$tmp/again.csv"
check "another flight than the true one" not cmp -s "$tmp/known.pcap" "$tmp/ideal.pcap"
sed '20s/,seen,.*/,none,,/' "$tmp/known/sights.csv" >"$tmp/lacks.csv"
loop lacks --sights "$tmp/lacks.csv" -o "$tmp/lacks.pcap"
check "an answer less is another flight" not cmp -s "$tmp/known.pcap" "$tmp/lacks.pcap"

# ---- what the recording says is what was seen: a replay from the missile's nose
replay "$tmp/known.pcap" "$tmp/seen" --rate 10 --set sensor.hfov_deg=3 --bands lwir --planes none --no-png
check "a replay takes it" [ "$code" = 0 ]
check "by the missile's eye" [ "$(host_of "$tmp/seen")" = 1:3001:41 ]
python3 - "$tmp/known/truth.jsonl" "$tmp/seen/truth.jsonl" >"$tmp/alike" <<'END'
import json, sys
def ranges(path):
    frames = (json.loads(line) for line in open(path))
    return {round(f["time_s"], 3): t["range_m"] for f in frames for t in f["targets"] if t["entity"] == "1:3001:21"}
a, b = map(ranges, sys.argv[1:])
both = sorted(set(a) & set(b))
print(len(both), max(abs(a[t] - b[t]) for t in both) if both else 9e9)
END
read -r both apart <"$tmp/alike"
check "in as many frames: ${both:-}" is "${both:-0}" '>' 33
# the nose is before the centre of the body, by half of a length of some 2 m, and reports are 0.05 m off
check "as far from its target: $apart m" is "${apart:-9}" '<' 1.5
finish
