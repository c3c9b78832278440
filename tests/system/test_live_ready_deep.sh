#!/usr/bin/env bash
# A live node with a millimetre-wave radar on a missile, tanks with turning turrets before it: of the frames later than ten
# seconds after the first entity was heard (listening takes two of them) 95 % and more have radar. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3

flight "$tmp/flight.yaml"
free_port
node seeker --size 360x243 --rate 5 --host munition --set radar.preset=seeker_35 --address 127.0.0.1 --port $port --for 60
check "it listens" heard_by seeker 'listening on'
sender "$tmp/flight.yaml" --send 127.0.0.1:$port
ended seeker
end_sender
check "the node ends well" [ $code = 0 ] || tail -n 5 "$tmp/seeker.out"
grep 'ready' "$tmp/seeker.out"
cat >"$tmp/judge.py" <<'P'
import json, sys
frames = [json.loads(line) for line in open(sys.argv[1] + "/truth.jsonl")]
begun = frames[0]["time_s"]
late = [f for f in frames if f["time_s"] >= begun + 8]
seen = [f for f in late if f.get("radar")]
print("%d frames, %d without radar; later %d, with radar %d, of these coarse %d" % (
    len(frames), sum(not f.get("radar") for f in frames), len(late), len(seen),
    sum(f.get("given_up") == "radar_detail" for f in seen)))
targets = sum(len(f["radar"]["targets"]) > 0 for f in seen)
sys.exit(not (len(late) >= 20 and len(seen) >= 0.95 * len(late) and targets > 0))
P
check "95 % of later frames have radar" python3 "$tmp/judge.py" "$tmp/seeker"
[ "$failures" = 0 ] || tail -n 12 "$tmp/seeker.out"
finish
