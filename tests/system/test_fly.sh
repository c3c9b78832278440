#!/usr/bin/env bash
# `pitviper fly`: the table, what the recording says by another program's reading of it, that a replay takes it, the circular
# error probable of a known dispersion, and what is refused.
. "$(dirname "$0")/common.sh"

judges python3.opendis
cell() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == 2 { print $c }' "$1"; }

# ---- one flight: Fire, Entity States, Detonation as another decoder reads them
run fly demo --missile at_loft -o "$tmp/fly.pcap"
check "ends well" [ "$code" = 0 ]
cp "$tmp/stdout" "$tmp/table"
check "a row" [ "$(lines_in "$tmp/table")" = 2 ]
check "it hits: $(tail -n 1 "$tmp/table")" [ "$(cell "$tmp/table" hit)" = entity ]
check "its miss" is "$(cell "$tmp/table" miss_m)" '<' 0.5
cat >"$tmp/read.py" <<'END'
import io, math, struct, sys
from opendis.PduFactory import createPdu
data = open(sys.argv[1], "rb").read()
order = "<" if data[:4] in (b"\xd4\xc3\xb2\xa1", b"\x4d\x3c\xb2\xa1") else ">"
nano = data[:4] in (b"\x4d\x3c\xb2\xa1", b"\xa1\xb2\x3c\x4d")
link = struct.unpack(order + "I", data[20:24])[0]
at, pdus = 24, []
while at < len(data):
    s, f, size, _ = struct.unpack(order + "IIII", data[at:at + 16])
    packet = data[at + 16:at + 16 + size]
    ip = {1: 14, 101: 0, 113: 16, 228: 0, 0: 4}[link]
    payload = packet[ip + 4 * (packet[ip] & 15) + 8:]
    pdus.append((s + f * (1e-9 if nano else 1e-6), createPdu(payload)))
    at += 16 + size
place = lambda v: (v.x, v.y, v.z)
fire = [(t, p) for t, p in pdus if p and p.pduType == 2]
bang = [(t, p) for t, p in pdus if p and p.pduType == 3]
flown = [(t, p) for t, p in pdus if p and p.pduType == 1 and p.entityID.entityID == 41]
truck = [(t, p) for t, p in pdus if p and p.pduType == 1 and p.entityID.entityID == 22 and t <= bang[0][0]]
t0 = pdus[0][0]
print("shots", len(fire), len(bang), round(fire[0][0] - t0, 3), bang[0][0] - fire[0][0], bang[0][1].detonationResult)
print("target", fire[0][1].targetEntityID.entityID, bang[0][1].targetEntityID.entityID)
# each report against the one before, carried on by the report's own algorithm 4
worst = 0
for (ta, a), (tb, b) in zip(flown, flown[1:]):
    dt = tb - ta
    said = [p + dt * (v + dt / 2 * acc) for p, v, acc in zip(place(a.entityLocation), place(a.entityLinearVelocity),
            place(a.deadReckoningParameters.entityLinearAcceleration))]
    worst = max(worst, math.dist(said, place(b.entityLocation)))
print("reports", len(flown), worst)
ta, a = truck[-1]
dt = bang[0][0] - ta
there = [p + dt * v for p, v in zip(place(a.entityLocation), place(a.entityLinearVelocity))]
print("apart", math.dist(there, place(bang[0][1].location)))
END
sed -i 's/import io, math/import math/' "$tmp/read.py"
python3 "$tmp/read.py" "$tmp/fly.pcap" >"$tmp/said" 2>"$tmp/read.err" || { fail "the recording as opendis reads it"; tail -n 3 "$tmp/read.err"; }
cat "$tmp/said"
read -r _ fires bangs begins lasts result <<<"$(grep '^shots' "$tmp/said")"
check "one Fire, one Detonation: ${fires:-} ${bangs:-}" [ "${fires:-} ${bangs:-} ${result:-}" = "1 1 1" ]
check "fired at 12 s: ${begins:-}" is "$(awk -v a="${begins:-0}" 'BEGIN { print (a - 12) ^ 2 }')" '<' 0.001
check "the flight time of the table: ${lasts:-}" is "$(awk -v a="${lasts:-0}" -v b="$(cell "$tmp/table" flight_s)" 'BEGIN { print (a - b) ^ 2 }')" '<' 1e-8
check "at the truck" [ "$(grep '^target' "$tmp/said")" = "target 22 22" ]
read -r _ reports worst <<<"$(grep '^reports' "$tmp/said")"
check "few reports: ${reports:-}" is "${reports:-0}" '<' 60
# within the threshold of 1 m and what comes in a tick of 1/60 s at 300 m/s2
check "each within the threshold of what was said before: ${worst:-} m" is "${worst:-9}" '<' 1.6
# 2 m (hit_m) about a point 1.2 m above the truck's base, whose report may be 1 m old
check "the Detonation is at the truck: $(sed -n 's/^apart //p' "$tmp/said") m" is "$(sed -n 's/^apart //p' "$tmp/said")" '<' 4.2

# ---- the same as of `exercise`; the same octets again; a replay sees through its seeker
exercise demo "$tmp/exercise.pcap" shots.Missile.flies=at_loft
check "exercise writes the same octets" cmp -s "$tmp/fly.pcap" "$tmp/exercise.pcap"
run fly demo --missile at_loft -o "$tmp/fly.pcap"
check "an existing recording stays" [ "$code" = 1 ]
run fly demo --missile at_loft -o "$tmp/fly.pcap" --overwrite
check "and is written again: the same octets" cmp -s "$tmp/fly.pcap" "$tmp/exercise.pcap"
bare=("${quick[@]}")
replay "$tmp/fly.pcap" "$tmp/out" --set sensor.hfov_deg=10
check "a replay takes it" [ "$code" = 0 ]
check "by the missile's eye" [ "$(host_of "$tmp/out")" = 1:3001:41 ]
python3 - "$tmp/out/truth.jsonl" >"$tmp/ranges" <<'END'
import json, sys
for line in open(sys.argv[1]):
    frame = json.loads(line)
    for t in frame["targets"]:
        if t["entity"] == "1:3001:22": print(frame["time_s"], t["range_m"], t["closing_mps"])
END
first=$(head -n 1 "$tmp/ranges" | cut -d' ' -f2) last=$(tail -n 1 "$tmp/ranges" | cut -d' ' -f2)
check "it comes near its target: ${first:-none} to ${last:-none} m" is "${last:-9e9}" '<' 300
check "from afar" is "${first:-0}" '>' 2000

# ---- a dispersion of 1 m in each of two axes: the median is 1.1774 m
cat >"$tmp/air.yaml" <<'END'
duration_s: 25
vehicles:
  - {name: Plane, id: 11, type: 1.2.225.1.1.0.0, force: 2, speed_mps: 180, height_m: 1500, route_m: [[300, 5000], [200, 2000], [100, -3000]]}
  - {name: Truck, id: 21, type: 1.1.225.7.1.0.0, route_m: [[0, 0]]}
shots:
  - {name: Sam, id: 31, from: Truck 21, at: Plane 11, time_s: 3, flies: sam_ir, type: 2.1.225.1.15.0.0}
END
run fly "$tmp/air.yaml" --seeds 60 --set shots.Sam.sight_error_m=1
check "60 rows and the CEP" [ "$(lines_in "$tmp/stdout")" = 62 ]
cep=$(sed -nE 's/^CEP ([0-9.]+) m over 60 flights, .*/\1/p' "$tmp/stdout")
low=$(sed -nE 's/.*interval ([0-9.]+) \.\. .*/\1/p' "$tmp/stdout") high=$(sed -nE 's/.* \.\. ([0-9.]+) m$/\1/p' "$tmp/stdout")
check "its interval has 1.1774: ${low:-} .. ${high:-}" is "${low:-9}" '<' 1.1774
check "its interval has 1.1774" is "${high:-0}" '>' 1.1774
sed '1d; $d' "$tmp/stdout" | cut -d, -f9 | sort -g >"$tmp/misses"
check "the CEP is the median: ${cep:-}" is "$(awk -v c="${cep:-0}" '{ m[NR] = $1 } END { d = (m[30] + m[31]) / 2 - c; print d * d }' "$tmp/misses")" '<' 1e-6
# of 60 throws of a coin P(B <= 21) = 0.0137 and P(B <= 22) = 0.0259: the 22nd from either end
check "the interval is that of ranks 22 and 39" is "$(awk -v a="${low:-0}" -v b="${high:-0}" '{ m[NR] = $1 } END { print (m[22] - a) ^ 2 + (m[39] - b) ^ 2 }' "$tmp/misses")" '<' 1e-6
run fly "$tmp/air.yaml" --seeds 3 --plot "$tmp/paths.svg" --set shots.Sam.sight_error_m=20
check "a plot that is XML" xml "$tmp/paths.svg"
check "with an end of each path in both views" [ "$(grep -o '<circle' "$tmp/paths.svg" | wc -l)" = 6 ]
check "and as many hits as the table" grep -q "paths of 3 flights, $(grep -c ',entity,' "$tmp/stdout") hits" "$tmp/paths.svg"
run fly "$tmp/air.yaml" --plot "$tmp/paths.svg"
check "an existing plot stays" [ "$code" = 1 ]
run fly "$tmp/air.yaml" --seeds 3 --quiet
check "quiet: the table alone" [ "$(lines_in "$tmp/stdout")" = 4 ]

# ---- refused, and said
refused() { # refused WHAT CODE PATTERN ARGUMENTS...
    local what=$1 wanted=$2 pattern=$3; shift 3
    run fly "$@"
    check "$what: ended with $code" [ "$code" = "$wanted" ]
    check "$what: said" complained "$pattern"
}
refused "no scenario" 2 'no SCENARIO is named'
refused "none flies" 1 'no shot flies' demo
refused "no such row" 1 'missile.*sam_it.*did you mean sam_ir|sam_ir' demo --missile sam_it
refused "a recording of many" 2 'of one seed' demo --missile at_loft --seeds 2 -o "$tmp/many.pcap"
refused "no number" 2 'whole number in 1' demo --missile at_loft --seeds 0
refused "no such shot" 2 "no shots with name: 'Rocket'" demo --set shots.Rocket.flies=at_loft
refused "a flight that outlasts the scenario" 0 'still in the air' demo --missile at_loft --set duration_s=20 -o "$tmp/short.pcap"
printf 'name,guidance\nx,pn\n' >"$tmp/poor.csv"
refused "a table without columns" 1 'missiles.*column' demo --missile x --set missiles="$tmp/poor.csv"
finish
