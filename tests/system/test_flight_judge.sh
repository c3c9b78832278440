#!/usr/bin/env bash
# Flights of every row of etc/missiles.csv, an arc in vacuum and falls with drag, against SciPy's DOP853 with the closed form of
# gravity; and that half a step moves no end.
. "$(dirname "$0")/common.sh"

judges python3.scipy
# of constant drag, whatever its Mach number
awk -F, -v OFS=, '/^#/ { next } $1 == "name" { for (i = 1; i <= NF; i++) drag[i] = $i ~ /^cd_/ } { print } $1 == "bomb_laser" {
    $1 = "stone"; for (i in drag) if (drag[i]) $i = 0.5; print }' etc/missiles.csv >"$tmp/missiles.csv"
cat >"$tmp/rows.csv" <<'END'
missile,lat_deg,lon_deg,height_m,azimuth_deg,elevation_deg,speed_mps,target_e_m,target_n_m,target_u_m,target_ve_mps,target_vn_mps,target_vu_mps,target_ae_mps2,target_an_mps2,target_au_mps2,until_s,earth,air
at_loft,47,13,500,0,18,,0,2000,0,10,0,0,,,,,,
ir_ag,47,13,3500,0,0,,0,10000,-3000,10,0,0,0.5,,,,,
laser_ag,-20,-70,600,45,20,,3500,3500,-100,10,0,0,,,,,,
sam_ir,47,13,500,0,40,,500,3000,2000,100,-200,0,,30,10,,,
wire_at,70,100,50,0,2,,0,2500,0,8,0,0,,,,,,
bomb_laser,47,13,5000,0,0,,0,6500,-4500,0,0,0,,,,30,,
stone,47,13,9000,90,0,,,,,,,,,,,40,,
stone,0,0,30000,0,0,0.5,,,,,,,,,,40,,
stone,47,13,500,100,60,1500,,,,,,,,,,60,,0
sam_ir,-35,20,500,200,40,,,,,,,,,,,15,2,
END
"$pitviper" probe flight "$tmp/missiles.csv" <"$tmp/rows.csv" >"$tmp/flights.csv" || fail "probe flight"
python3 tests/system/flight_judge.py "$tmp/missiles.csv" "$tmp/flights.csv" >"$tmp/judge.txt" 2>&1
check "the judge ends well" [ $? = 0 ]
cat "$tmp/judge.txt"
check "of every row" [ "$(lines_in "$tmp/judge.txt")" = 10 ]
while read -r name end point speed apart gone; do
    check "$name ($end): end within 1 cm: $point m after $gone m" is "$point" '<' 0.01
    check "$name: its velocity: $speed m/s" is "$speed" '<' 0.01
    check "$name: its closest approach: $apart m" is "$apart" '<' 0.01
    check "$name flew" is "$gone" '>' 1000
done <"$tmp/judge.txt"

# half a step
sed '1s/$/,step_s/; 2,$s/$/,0.0005/' "$tmp/rows.csv" >"$tmp/fine.csv"
# before the seeker's last turn, which its limits decide
awk -F, -v OFS=, 'NR == FNR { if (FNR > 1) end[FNR] = $20; next } FNR > 1 && $17 == "" { $17 = int(5 * end[FNR]) / 5 - 0.4 } { print }' \
    "$tmp/flights.csv" "$tmp/fine.csv" >"$tmp/fine_until.csv"
"$pitviper" probe flight "$tmp/missiles.csv" <"$tmp/fine_until.csv" >"$tmp/fine_flights.csv" || fail "probe flight, half the step"
sed 's/,0\.0005$/,0.001/' "$tmp/fine_until.csv" | "$pitviper" probe flight "$tmp/missiles.csv" >"$tmp/coarse_flights.csv"
python3 - "$tmp" >"$tmp/moved" <<'END'
import csv, sys
a, b = (list(csv.DictReader(open(f"{sys.argv[1]}/{n}_flights.csv"))) for n in ("fine", "coarse"))
for x, y in zip(a, b): print(x["missile"], sum((float(x[k]) - float(y[k])) ** 2 for k in ("x_m", "y_m", "z_m")) ** 0.5, x["end_s"])
END
check "half a step: every row" [ "$(lines_in "$tmp/moved")" = 10 ]
while read -r name moved end; do
    check "$name: half the step moves the end at $end s by $moved m" is "$moved" '<' 0.001
done <"$tmp/moved"

# its twin: a navigation constant 1 % higher, and a gravity without its flattening
awk -F, -v OFS=, '/^#/ { next } $1 == "name" { for (i = 1; i <= NF; i++) if ($i == "gain") at = i; print; next } { $at *= 1.01; print }' \
    "$tmp/missiles.csv" >"$tmp/spoilt.csv"
head -n 2 "$tmp/flights.csv" >"$tmp/one.csv"
read -r _ _ point _ <<<"$(python3 tests/system/flight_judge.py "$tmp/spoilt.csv" "$tmp/one.csv")"
check "its twin is noticed: ${point:-none} m" is "${point:-0}" '>' 0.01
sed 's/^    half = 0.5 .*/    return -GM * p \/ (p @ p) ** 1.5/' tests/system/flight_judge.py >"$tmp/round.py"
(sed -n 1p "$tmp/flights.csv"; sed -n 8p "$tmp/flights.csv") >"$tmp/one.csv"
read -r _ _ point _ <<<"$(python3 "$tmp/round.py" "$tmp/missiles.csv" "$tmp/one.csv")"
check "so is a round Earth's gravity: ${point:-none} m" is "${point:-0}" '>' 0.01
finish
