#!/usr/bin/env bash
# `pitviper fly demo` in the loop, 12 s over 2.5 km in top attack: with the true line of sight of each frame it hits within 0.3 m
# of the target's centre, as the flight without frames does; with sights that are 0.2 s old it comes less near.
. "$(dirname "$0")/common.sh"

small=(--size 64x48 --bands lwir --rate 10 --threads 2 --planes none --no-files "${bare[@]}")
column() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == 2 { print $c }' "$1"; }
run fly demo --missile at_loft --frames "$tmp/out" -o "$tmp/loop.pcap" -- "${small[@]}"
check "ends well" [ "$code" = 0 ]
cp "$tmp/stdout" "$tmp/loop.csv"
tail -n 1 "$tmp/loop.csv"
run fly demo --missile at_loft
cp "$tmp/stdout" "$tmp/free.csv"
check "it hits" [ "$(column "$tmp/loop.csv" hit)" = entity ]
check "within 0.3 m of the centre: $(column "$tmp/loop.csv" miss_m)" is "$(column "$tmp/loop.csv" miss_m)" '<' 0.3
for what in flight_s end_mps guided_share; do
    a=$(column "$tmp/loop.csv" $what) b=$(column "$tmp/free.csv" $what)
    check "$what as without frames: $a, $b" is "$(awk -v a="$a" -v b="$b" 'BEGIN { print (a / b - 1) ^ 2 }')" '<' 1e-6
done
run fly demo --missile at_loft --frames "$tmp/late" --set shots.Missile.sight_late_s=0.2 -- "${small[@]}"
cp "$tmp/stdout" "$tmp/late.csv"
tail -n 1 "$tmp/late.csv"
check "0.2 s late: less near" is "$(column "$tmp/late.csv" miss_m)" '>' "$(awk -v m="$(column "$tmp/loop.csv" miss_m)" 'BEGIN { print 3 * m }')"
finish
