#!/usr/bin/env bash
# A missile steered by the example tracker (etc/examples/recognise_track.py), from counts of a camera with noise and defects: it hits a
# truck that crosses at 15 m/s, from 0.9 km, in two worlds (within 3 m of its middle: it is 7.4 m long, and seen broadside); without the truck, by the same shot, it comes nowhere near. And
# etc/fly_matrix: its table, its judgement, its plot.
. "$(dirname "$0")/common.sh"
judges python3.numpy

cat >"$tmp/short.yaml" <<'END'
duration_s: 8
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 15, route_m: [[0, -120], [0, -60], [0, 0], [0, 60], [0, 120]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, speed_mps: 30, height_m: 200, route_m: [[900, -100], [890, 300]]}
shots:
  - {name: Missile, id: 41, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 21, time_s: 1, flies: ir_ag, launch_m: [0, -10, 3], hit_m: 3}
END
small=(--size 96x72 --bands lwir --rate 20 --planes none --no-files --set sensor.preset=staring_lwir --set publish.memory_planes=counts
    "${quick[@]}" --set quality.budget=off --set sensor.target_samples=8 --set sensor.edge_samples=2)
tracker="python3 etc/examples/recognise_track.py --memory \$PITVIPER_MEMORY"
cell() { awk -F, -v name="$2" -v row="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == row + 1 { print $c }' "$tmp/$1.csv"; }
flown() { # flown NAME OPTIONS...
    local name=$1; shift
    run fly "$tmp/short.yaml" --recogniser "$tracker" --limit 60 --start 120 "$@" -- "${small[@]}"
    cp "$tmp/stdout" "$tmp/$name.csv"
    check "$name: ended with $code: $(tail -n 2 "$tmp/stderr")" [ "$code" = 0 ]
    cat "$tmp/$name.csv"
}
flown truck --seeds 2
for row in 1 2; do
    check "world $row: it hits" [ "$(cell truck hit $row)" = entity ]
    check "world $row: every frame was answered" [ "$(cell truck none $row)" = 0 ]
    check "world $row: and most guided: $(cell truck seen $row) of $(cell truck frames $row)" \
        is "$(cell truck seen $row)" '>' "$(awk -v n="$(cell truck frames $row)" 'BEGIN { print 0.6 * n }')"
done
flown twin --set vehicles.Truck.type=7.1.222.1.0.0.0 --set vehicles.Truck.dust=none
check "without its target it hits nothing" [ "$(cell twin hit 1)" != entity ]
check "nor comes near: $(cell twin miss_m 1) m" is "$(cell twin miss_m 1)" '>' 10

# ---- the matrix: of flights that are there
mkdir "$tmp/out"
{
    echo recogniser,case,target,late_ms,seed,hit,miss_m,frames,seen,empty,outside,on_target,last_m,why
    for late in 0 50 100 200; do
        for seed in $(seq 1 20); do
            awk -v s="$seed" -v l="$late" 'BEGIN {
                m = (s + l / 10) / 10
                hit = m < 2
                printf "track,cross,truck,%d,%d,%s,%g,90,80,10,0,80,%d,%s\n", l, s, hit ? "entity" : "ground", m, hit ? 50 : 400, hit ? "" : "lost" }'
        done
    done
    for seed in $(seq 1 20); do echo "track,cross,none,0,$seed,ground,$((seed + 20)),90,0,90,0,0,,"; done
} >"$tmp/out/flights.csv"
matrix() { python3 etc/fly_matrix "$build" --only track:cross --first 1 --out "$tmp/out" --record "${record:-$tmp/none.csv}" "$@" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?; }
matrix --plot "$tmp/cep.svg"
check "flights that are there are not flown again" [ "$code" = 0 ]
row=$(grep -E '^track +cross +truck +0 ' "$tmp/stdout")
# misses 0.1 .. 2.0 m: the median is 1.05, ranks 6 and 15 enclose it; the nearest is 0.1; 19 hits
check "a cell: $row" grep -qE ' 19/20 +1\.05 +0\.6 \.\. 1\.5 +0\.1 +1 lost' <<<"$row"
check "a plot that is XML" xml "$tmp/cep.svg"
check "with a point for each delay" [ "$(grep -c '<circle' "$tmp/cep.svg")" = 4 ]
matrix --flown --renew "a test"
check "its record" grep -qx 'track,cross,truck,0,20,19,0.764,0.991,1.05,0.6,1.5,0.1,0,1,0,0' "$tmp/none.csv"
check "with the reason" grep -qx '# reason: a test' "$tmp/none.csv"
rm "$tmp/none.csv"
{
    echo recogniser,case,target,late_ms,flights,hits,low,high,cep_m,cep_low_m,cep_high_m,least_m,not_found,lost,other,beside
    echo track,cross,truck,0,20,8,0.22,0.613,1.05,0.6,1.5,0.1,0,12,0,0
} >"$tmp/other.csv"
record=$tmp/other.csv matrix
check "more hits than the record has: said" eval '[ "$code" = 1 ] && complained "the record has 8 of 20"'
sed -i 's/^track,cross,none,0,3,ground/track,cross,none,0,3,entity/' "$tmp/out/flights.csv"
matrix
check "a hit without a target: said" eval '[ "$code" = 1 ] && complained "1 hit without a target"'
sed -i -E 's/^(track,cross,truck,0,1?[0-9],)entity/\1ground/' "$tmp/out/flights.csv"
matrix
check "too few hits: said" eval '[ "$code" = 1 ] && complained "fewer than three of four"'
finish
