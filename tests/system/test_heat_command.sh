#!/usr/bin/env bash
# `pitviper heat`: a tank's day: crossover twice, its engine; a truck's sunlit sides; and what is refused.
. "$(dirname "$0")/common.sh"
judges python3

# cell FILE HOUR COLUMN
cell() {
    awk -F, -v hour="$2" -v name="$3" \
        'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i }
         NR > 1 && $1 + 0 == hour + 0 && c { print $c }' "$1"
}
less() { awk -v a="$1" -v b="$2" 'BEGIN { print a - b }'; }

run heat tank -o "$tmp/still" --heading 0 --step 600
check "heat tank: exit code" [ $code = 0 ]
for file in nodes.csv nodes.svg lwir.png mwir.png; do check "$file" [ -s "$tmp/still/$file" ]; done
check "nothing half written" [ -z "$(find "$tmp/still" -name '*.part')" ]
still=$tmp/still/nodes.csv
check "a row each ten minutes" [ "$(wc -l <"$still")" = 146 ]
check "names of columns are unique" [ -z "$(head -n 1 "$still" | tr , '\n' | sort | uniq -d)" ]
check "each row has all cells" [ "$(awk -F, '{ print NF }' "$still" | sort -u | wc -l)" = 1 ]
crossings=$(awk -F, 'NR > 2 && ($4 > 0) != (was > 0) { n++ } { was = $4 } END { print n + 0 }' "$still")
check "twice as warm as the ground: $crossings" [ "$crossings" = 2 ]
check "the summary says when" said 'crossover of vehicle and ground: 0[4-7]:[0-9]+, 1[4-7]:[0-9]+$'
check "the plot marks them" [ "$(grep -c 'c0392b.*>[01][0-9]:[0-9][0-9]</text>' "$tmp/still/nodes.svg")" = 2 ]
check "warmer than the ground at night" is "$(cell "$still" 3 dt_k)" '>' 1
check "colder in the morning" is "$(cell "$still" 9 dt_k)" '<' -1
mkdir "$tmp/truck" && echo "of before" >"$tmp/truck/nodes.csv"
run heat truck -o "$tmp/truck" --heading 0 --step 600 --drive 05:00-06:00 --overwrite
check "heat truck, --overwrite: exit code" [ $code = 0 ]
check "what was there is replaced" [ "$(wc -l <"$tmp/truck/nodes.csv")" = 146 ]
check "the engine is warm while it drives" is "$(cell "$tmp/truck/nodes.csv" 6 engine_k)" '>' 340
check "and cools" is "$(cell "$tmp/truck/nodes.csv" 12 engine_k)" '<' "$(cell "$tmp/truck/nodes.csv" 6 engine_k)"
check "the plot says so" grep -q 'drives 05:00-06:00' "$tmp/truck/nodes.svg"
# nose to the north: its right side faces east
sides=$(less "$(cell "$tmp/truck/nodes.csv" 8 canvas_right)" "$(cell "$tmp/truck/nodes.csv" 8 canvas_left)")
check "canvas at 8 h, east over west: $sides K" is "$sides" '>' 5
sides=$(less "$(cell "$tmp/truck/nodes.csv" 16 canvas_right)" "$(cell "$tmp/truck/nodes.csv" 16 canvas_left)")
check "and at 16 h: $sides K" is "$sides" '<' -5
check "all within 260 .. 340 K" awk -F, \
    'NR > 1 { for (i = 2; i <= NF; i++) if (i != 4 && $i != "" && !($i > 260 && $i < 340)) exit 1 }' "$still"
days=$(less "$(cell "$still" 24 dt_k)" "$(cell "$still" 0 dt_k)")
check "a day later much the same: $days K" is "${days#-}" '<' 0.5
check "the plot is XML" xml "$tmp/still/nodes.svg"

printf 'v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >"$tmp/wedge.obj" # quick to load
run heat "$tmp/wedge.obj" -o "$tmp/still"
check "existing files: exit code" [ $code = 1 ]
check "existing files: said" complained 'nodes\.csv exists already.*--overwrite'
run heat frigate9 -o "$tmp/none"
check "no such model: exit code" [ $code = 1 ]
check "no such model: said" complained "no built-in model of this name: 'frigate9'"
check "no such model: nothing is made" [ ! -e "$tmp/none" ]
run heat "$tmp/wedge.obj" -o "$tmp/no/such/folder" --step 600
check "no such folder: exit code" [ $code = 1 ]
check "no such folder: said" complained 'cannot create .*such/folder.*--out'
while read -r named arguments; do
    # shellcheck disable=SC2086
    run heat -o "$tmp/none" $arguments
    check "heat $arguments: exit code" [ $code = 2 ]
    check "heat $arguments: said" complained "$named"
    check "heat $arguments: nothing is made" [ ! -e "$tmp/none" ]
done <<'WRONG'
--day tank --day 2026-02-30
--day tank --day today
--day tank --day
--at tank --at 91 0
--at tank --at 48
--drive tank --drive 7:00
--drive tank --drive 09:00-08:00
--drive tank --drive 20:00-25:00
--heading tank --heading west
--step tank --step 0
--step tank --step 70
model tank truck
model --step 60
option tank --frob
WRONG
finish
