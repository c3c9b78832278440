#!/usr/bin/env bash
# `pitviper fly` in the loop with several rounds: one after the other through one node, each with Fire and Detonation, the next
# launched at a frame; what the first hit is hit in the frames of the next; and again by the recording of the answers, to the bit.
. "$(dirname "$0")/common.sh"

judges python3.numpy
. "$(dirname "$0")/../tools/loop_common.sh"

sed -i 's/flies: ir_ag}/flies: ir_ag, rounds: 2, every_s: 1}\n  - {name: Other, id: 51, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 21, time_s: 9, flies: ir_ag}/' "$tmp/short.yaml"
column() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } /^[0-9]/ { printf "%s ", $c }' "$tmp/$1.csv"; }
more=(--threads 2)
loop known --frames "$tmp/known" --recogniser "$knows" -o "$tmp/known.pcap"
check "three rounds: $(column known munition)" [ "$(column known munition)" = "Missile 41 Missile 42 Other 51 " ]
check "all hit: $(column known hit)" [ "$(column known hit)" = "entity entity entity " ]
# 1 s as planned; 2 s is while the first flies, which ends after 4.5 s: at the next frame; 9 s as planned
check "the second begins at a frame after the first has ended: $(column known fire_s)" \
    awk -v t="$(column known fire_s)" -v s="$(column known flight_s)" 'BEGIN { split(t, f, " "); split(s, d, " ")
        exit !(f[1] == 1 && f[2] > f[1] + d[1] && f[2] < f[1] + d[1] + 0.25 && (f[2] * 10) % 1 < 1e-6 && f[3] == 9) }'
grep -oE '"host":\{"entity":"[0-9:]*"' "$tmp/known/truth.jsonl" | uniq | grep -oE '1:3001:[0-9]+' >"$tmp/hosts"
check "the frames are of one after the other" [ "$(paste -sd' ' "$tmp/hosts")" = "1:3001:41 1:3001:42 1:3001:51" ]
check "and have as many lines as the rows say" [ "$(lines_in "$tmp/known/truth.jsonl")" = "$(column known frames | awk '{ print $1 + $2 + $3 }')" ]

# ---- the same flights by their recording
more=(--threads 1)
loop again --frames "$tmp/again" --sights "$tmp/known/sights.csv" -o "$tmp/again.pcap"
check "the same frames" cmp -s "$tmp/known/truth.jsonl" "$tmp/again/truth.jsonl"
check "the same exercise" cmp -s "$tmp/known.pcap" "$tmp/again.pcap"
check "the same rows" cmp -s "$tmp/known.csv" "$tmp/again.csv"

# ---- what the recording holds, octet by octet
python3 - "$tmp/known.pcap" >"$tmp/events" <<'END'
import struct, sys
data, at = open(sys.argv[1], 'rb').read(), 24
order = '<' if data[:4] in (b'\xd4\xc3\xb2\xa1', b'\x4d\x3c\xb2\xa1') else '>'
while at < len(data):
    size = struct.unpack_from(order + 'I', data, at + 8)[0]
    packet = data[at + 16:at + 16 + size]
    pdu = packet[4 * (packet[0] & 15) + 8:]
    at += 16 + size
    if pdu[2] in (2, 3):  # Fire, Detonation: firing, target, munition; of a Detonation the result
        ids = [str(struct.unpack_from('>H', pdu, 12 + 6 * k + 4)[0]) for k in range(3)]
        print(' '.join(['fire' if pdu[2] == 2 else 'burst', *ids] + ([str(pdu[100])] if pdu[2] == 3 else [])))
END
check "Fire and Detonation by turns: $(paste -sd';' "$tmp/events")" [ "$(paste -sd';' "$tmp/events")" = \
    "fire 31 21 41;burst 31 21 41 1;fire 31 21 42;burst 31 21 42 1;fire 31 21 51;burst 31 21 51 1" ]

# ---- what the first hit is hit in the frames of the next, too: the truck, of 8 m/s, stands then
python3 - "$tmp/known/truth.jsonl" >"$tmp/drives" <<'END'
import json, math, sys
def place(frame):
    """ECEF, from the eye's place and the line of sight, which is of the level there."""
    t = next(t for t in frame['targets'] if t['entity'] == '1:3001:21')
    az, el, r = math.radians(t['los_az_deg']), math.radians(t['los_el_deg']), t['range_m']
    la, lo = math.radians(frame['host']['lat_deg']), math.radians(frame['host']['lon_deg'])
    e, n, u = r * math.cos(el) * math.sin(az), r * math.cos(el) * math.cos(az), r * math.sin(el)
    return [p + d for p, d in zip(frame['host']['ecef_m'], (
        -math.sin(lo) * e - math.sin(la) * math.cos(lo) * n + math.cos(la) * math.cos(lo) * u,
        math.cos(lo) * e - math.sin(la) * math.sin(lo) * n + math.cos(la) * math.sin(lo) * u,
        math.cos(la) * n + math.sin(la) * u))]
frames = [json.loads(line) for line in open(sys.argv[1])]
for entity in '1:3001:41', '1:3001:42':
    own = [f for f in frames if f['host']['entity'] == entity][-12:-1]
    print('%.3f' % (math.dist(place(own[0]), place(own[-1])) / (own[-1]['time_s'] - own[0]['time_s'])), end=' ')
END
read -r first second <"$tmp/drives"
check "in the last second of the first it drives: $first m/s" is "${first:-0}" '>' 6
check "in that of the second it stands: $second m/s" is "${second:-9}" '<' 0.5
finish
