#!/usr/bin/env bash
# A live node that is held up gives up sampling, says which frames did, and notes it: its recording replays to the same planes,
# pictures, counts and truth, to the bit. The twin, a recording whose notes are spoilt, does not. How often it gives up is
# this machine's business: a host's first frame always does.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3

# a sensor whose columns are swept, a lens that distorts, an odd size
few=(--size 63x47 --rate 10 --bands optical,lwir --host observer --set exercise.listen_s=0.3 --set sensor.preset=scanning_flir2
    --set sensor.hfov_deg=12 --set sensor.lens_k1=-2)
free_port
node held --address 127.0.0.1 --port $port "${few[@]}" --record "$tmp/held.pcapng"
check "it listens" heard_by held 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
# it stands still, three times, and goes on
for ((k = 1; k <= 3; k++)); do
    makes held $((8 * k)) || break
    kill -STOP "${node[held]}"; sleep 0.3; kill -CONT "${node[held]}"
done
check "it makes frames" makes held 30
stop held
end_sender
check "told to stop: ends well" [ $code = 0 ]
check "it says how many frames gave up, at which step, with the error" \
    eval "grep -qE 'of [0-9]+ frames gave up sampling' '$tmp/held.out' && grep -qE '[0-9]+ quarter: .* %' '$tmp/held.out'"

last=$(time_of "$tmp/held" '$')
again=(--causal --port 0 --to "$last" "${few[@]}")
first=$(frames_of held | cut -d, -f1)
hash_of() { numbered "$tmp/$1" | awk -v n="$first" '$1 == n { print $2 }'; }
replay "$tmp/held.pcapng" "$tmp/again" "${again[@]}" --only "$(frames_of held)" --save-frame "$first"
check "its recording replays" [ $code = 0 ]
check "to the same planes" part_of "$tmp/held" "$tmp/again" 30
cat >"$tmp/judge.py" <<'P'
import json, os, re, sys
live, again, recording = sys.argv[1:4]
def frames(out):
    lines = [json.loads(line) for line in open(out + "/truth.jsonl")]
    for f in lines:
        f.pop("latency_ms", None)
        f.get("error", {}).pop("ms", None)
    return {f["frame"]: f for f in lines}
a, b = frames(live), frames(again)
wrong = [n for n in a if a[n] != b.get(n)]
reduced = {n: f["given_up"] for n, f in a.items() if "given_up" in f}
words = {b"targets alone refined": "targets", b"ground sampled as a checkerboard": "checkerboard", b"ground sampled by quarters": "quarter"}
notes = {int(n): words[w] for w, n in re.findall(rb"pitviper: ([a-z ]+) in frame (\d+) at ", open(recording, "rb").read())}
counters = json.load(open(live + "/run.json"))["counters"]
by = {step: counters["live"]["frames_" + step] for step in ("full", "targets", "checkerboard", "quarter")}
seen = {step: list(reduced.values()).count(step) for step in by}
seen["full"] = len(a) - len(reduced)
replayed = json.load(open(again + "/run.json"))["counters"].get("frames_reduced", 0)
compared = lacking = 0
for folder in ("frames/optical", "frames/lwir", "raw/lwir"):
    for name in os.listdir(live + "/" + folder):
        if not name.endswith(".png"): continue
        compared += 1
        other = again + "/" + folder + "/" + name
        lacking += not os.path.exists(other) or open(live + "/" + folder + "/" + name, "rb").read() != open(other, "rb").read()
print("%d frames: %s; %d pictures compared, %d differ; lines of truth that differ: %s" % (len(a), seen, compared, lacking, wrong))
first = min(a)
sys.exit(not (not wrong and notes == reduced and by == seen and replayed == len(reduced) and reduced.get(first) == "quarter"
              and compared >= 60 and not lacking))
P
check "notes, truth, counters, pictures and raw counts agree" python3 "$tmp/judge.py" "$tmp/held" "$tmp/again" "$tmp/held.pcapng"
run frame "$tmp/again/frame_$(printf %06d "$first").pvf"
check "a frame that gave up, saved and rendered again: the same" grep -q "frame $(hash_of held)" "$tmp/stdout"
run explain "$tmp/again" "$first" 1 1
check "a pixel without rays of its own is said to be one" eval '[ $code = 1 ] && complained "no ray of its own in this frame.*explain column 0, row 0"'
run explain "$tmp/again" "$first" 0 0
check "one beside it has its ray" [ $code = 0 ]

# the twin: no note is read
sed 's/pitviper: ground sampled/pitviper: ground Sampled/g; s/pitviper: targets alone/pitviper: targets Alone/g' "$tmp/held.pcapng" >"$tmp/spoilt.pcapng"
replay "$tmp/spoilt.pcapng" "$tmp/spoilt" "${again[@]}" --only "$(frames_of held | cut -d, -f-6)"
check "without notes nothing is given up" [ "$(grep -c given_up "$tmp/spoilt/truth.jsonl")" = 0 ]
check "without its note the first frame has other planes" [ -n "$(hash_of spoilt)" -a "$(hash_of spoilt)" != "$(hash_of held)" ]

# off: nothing is given up, however late it is; and a recording without room for notes is said
free_port
node old --address 127.0.0.1 --port $port --for 0.2 --record "$tmp/old.pcap"
free_port
node off --address 127.0.0.1 --port $port "${few[@]}" --set quality.deadline=off
check "it listens" heard_by off 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
makes off 3; kill -STOP "${node[off]}"; sleep 0.3; kill -CONT "${node[off]}"
makes off 8
stop off
end_sender
check "off: gives up nothing" [ "$(grep -c given_up "$tmp/off/truth.jsonl")" = 0 ]
ended old
check "pcap: no room for what frames give up" grep -q 'old.pcap has no room for which frames give up sampling' "$tmp/old.out"
[ "$failures" = 0 ] || { tail -n 12 "$tmp/held.out"; cat "$tmp/stderr"; }
finish
