#!/usr/bin/env bash
# Walls, roofs, panes and sheet over a day of changing weather, against finite volumes with a balance of their own (walls_judge.py).
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.pvlib

days=4 begin=1774915200 # 2026-03-31, as in walls_judge.py
python3 tests/system/walls_judge.py weather $days >"$tmp/weather.csv"
# rows CONSTRUCTION MATERIAL TILT ASPECT FIRST_DAY: every ten minutes
rows() {
    awk -v b="$begin" -v c="$1,$2,$3,$4" -v first="$5" -v days="$days" 'BEGIN {
        for (k = 144 * first; k < 144 * days; k++) printf "%d,%s\n", b + 600 * k, c }'
}
{
    echo unix_s,construction,material,tilt_deg,aspect_deg
    rows wall_brick_cavity brick_red 90 0 0 # all days: the ground's temperature is taken from these
    for aspect in 90 180 270; do rows wall_brick_cavity brick_red 90 $aspect $((days - 1)); done
    rows roof_tile_insulated brick_red 40 180 $((days - 1))
    rows roof_felt_insulated asphalt_road 0 0 $((days - 1))
    rows glazing_double glass_window 90 180 $((days - 1))
    rows rail_metal paint_white_missile 90 90 $((days - 1))
    rows wall_sheet metal_steel_galvanized 90 180 $((days - 1))
} >"$tmp/rows.csv"
run probe heat-wall "$tmp/weather.csv" 50 8 <"$tmp/rows.csv"
check "probe: exit code" [ $code = 0 ]
cp "$tmp/stdout" "$tmp/ours.csv"
check "no row is refused" [ -z "$(awk -F, 'NR > 1 && $NF != ""' "$tmp/ours.csv")" ]

python3 tests/system/walls_judge.py "$tmp/weather.csv" "$tmp/ours.csv" etc >"$tmp/judge.txt"
check "nine faces" [ "$(wc -l <"$tmp/judge.txt")" = 9 ]
while read -r name tilt aspect most rms swing; do
    check "$name, tilt $tilt, facing $aspect: within $most K (rms $rms) over a day that swings by $swing K" is "$most" '<' 0.3
done <"$tmp/judge.txt"
# its twin: the judge's films are those of glass
awk -F, 'NR == 1 || $2 ~ /felt|brick/ && $5 == 0' "$tmp/ours.csv" >"$tmp/few.csv"
python3 tests/system/walls_judge.py "$tmp/weather.csv" "$tmp/few.csv" etc rough >"$tmp/judge.txt"
check "its twin is noticed" is "$(awk '{ if ($4 > w) w = $4 } END { print w + 0 }' "$tmp/judge.txt")" '>' 1
finish
