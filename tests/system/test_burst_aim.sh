#!/usr/bin/env bash
# The aim of a munition that has burst: its seeker's direction stays as it was.
# The missile's entity stays for 4 s where it last was, as some simulators leave it, and its target drives on. Its Detonation
# with its id, without, and without any id; the twin has none, and follows
# the target.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
# demo.pcap with a Fire at Tank 11, the missile's last report again every 0.5 s, at rest, and its Detonation as told
python3 - "$tmp" <<'END'
import struct, sys
tmp = sys.argv[1]
log = open(f"{tmp}/demo.pcap", "rb").read()
assert log[:4] == b"\x4d\x3c\xb2\xa1", "classic pcap of nanoseconds, little end first"
packets, at = [], 24
while at < len(log):
    s, ns, n, _ = struct.unpack_from("<4I", log, at)
    packets.append([s + ns / 1e9, bytearray(log[at + 16:at + 16 + n])])
    at += 16 + n
headers = 28                                    # IPv4, UDP
kind = lambda p: p[1][headers + 2]
id_at = lambda p, octet: struct.unpack_from(">3H", p[1], headers + octet)
missile = (1, 3001, 41)
burst = next(p for p in packets if kind(p) == 3 and id_at(p, 24) == missile)
last = [p for p in packets if kind(p) == 1 and id_at(p, 12) == missile and p[0] < burst[0] - 0.3][-1]
stamp = lambda p: struct.unpack_from(">I", p[1], headers + 4)[0]

def later(p, s, still):
    octets = bytearray(p[1])
    t = stamp(p)
    struct.pack_into(">I", octets, headers + 4, (((t >> 1) + round(s * 2**31 / 3600)) << 1 | t & 1) & 0xffffffff)
    if still:
        octets[headers + 36:headers + 48] = bytes(12)   # velocity
        octets[headers + 88] = 1                        # dead reckoning: static
    return [p[0] + s, octets]

for name in "named", "event", "place", "none":
    out = []
    for p in packets:
        p = [p[0], bytearray(p[1])]
        if kind(p) == 2 and id_at(p, 24) == missile: struct.pack_into(">3H", p[1], headers + 18, 1, 3001, 11)
        if kind(p) == 1 and id_at(p, 12) == missile and p[0] > last[0]: continue
        if p[0] > burst[0] and kind(p) != 1: continue
        if kind(p) == 3 and id_at(p, 24) == missile:
            if name == "none": continue
            if name != "named": p[1][headers + 24:headers + 30] = bytes(6)
            if name == "place":
                p[1][headers + 12:headers + 18] = bytes(6)
                p[1][headers + 30:headers + 36] = bytes(6)
                p[1][headers + 48:headers + 72] = last[1][headers + 48:headers + 72]
        out.append(p)
    for k in range(1, 10): out.append(later(last, 0.2 + 0.5 * (k - 1), True))
    out.sort(key=lambda p: p[0])
    with open(f"{tmp}/{name}.pcap", "wb") as f:
        f.write(log[:24])
        for t, octets in out:
            octets[26:28] = bytes(2)            # no checksum
            f.write(struct.pack("<4I", int(t), int((t - int(t)) * 1e9), len(octets), len(octets)) + octets)
END

turned=()
burst_s=$("$pitviper" inspect "$tmp/named.pcap" | sed -nE 's/^ *([0-9.]+) s +1:3001:41 of .* ends.*/\1/p')
check "the log has its burst" [ -n "$burst_s" ]
for name in named event place none; do
    replay "$tmp/$name.pcap" "$tmp/$name" --causal --host munition --no-files --bands lwir --size 16x16 --threads 1 --rate 10 \
        --from "$(awk "BEGIN { print $burst_s - 0.2 }")" --to "$(awk "BEGIN { print $burst_s + 3 }")" "${full[@]}" \
        --set sensor.gimbal_limit_deg=180
    check "$name: replays" [ $code = 0 ]
    # deg between the boresights of the first frame 0.1 s after the burst and of the last
    turned[${#turned[@]}]=$(python3 - "$tmp/$name/truth.jsonl" "$burst_s" <<'END'
import json, math, sys
frames = [json.loads(line) for line in open(sys.argv[1])]
after = [f for f in frames if f["time_s"] >= float(sys.argv[2]) + 0.1]
axis = [f["sensors"][0]["ecef_from_cam"][2::3] for f in (after[0], after[-1])]
print(math.degrees(math.acos(min(1, sum(a * b for a, b in zip(*axis))))) if len(after) > 10 else "few")
END
)
done
check "it keeps its direction: $(printf '%s ' "${turned[@]:0:3}")deg" eval 'is "${turned[0]}" "<" 1e-5 && is "${turned[1]}" "<" 1e-5 && is "${turned[2]}" "<" 1e-5'
check "without a burst it follows its target: ${turned[3]} deg" is "${turned[3]}" '>' 3
finish
