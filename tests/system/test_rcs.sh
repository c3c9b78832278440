#!/usr/bin/env bash
# `pitviper rcs` and `pitviper probe rcs`: a corner reflector's known peak, a sphere, a jeep; files, and what is refused.
. "$(dirname "$0")/common.sh"
judges python3

# cell FILE ROW COLUMN: row 1 is the first behind the header
cell() {
    awk -F, -v row="$2" -v name="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == row + 1 { print $c }' "$1"
}
near() { check "$1: $2, want $3 +- $4" awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN { d = a - b; exit !(a != "" && d <= t && -d <= t) }'; }

# 12 pi 0.3^4 / lambda^2 at 10 GHz; 4 pi (0.3 0.2)^2 / lambda^2; pi 0.5^2
cat >"$tmp/rows" <<'ROWS'
target,f_ghz,az_deg,el_deg,range_m,rx_az_deg,rx_el_deg
corner:0.3,10,45,35.26439,,,
plate:0.3x0.2,10,0,0,,,
sphere:0.5,10,20,5,,,
sphere:0.5,10,20,5,,60,5
plate:0.3x0.2,10,0,0,2000,,
cube:1,10,0,0,,,
plate:1x1,1000,0,0,,,
sphere:0.5,10,0,0,0.1,,
plate:1x1,10,0,95,,,
plate:1x1,10,0,0,,20,
ROWS
"$pitviper" probe rcs <"$tmp/rows" >"$tmp/rcs" 2>"$tmp/stderr"
near "square trihedral" "$(cell "$tmp/rcs" 1 hh_dbsm)" 25.308 0.1
# physical optics is the closed form; waves between the edges add 0.05 dB to it
near "plate" "$(cell "$tmp/rcs" 2 vv_dbsm)" 17.019 0.07
"$pitviper" rcs plate:0.3x0.2 --frequency 10 --elevation 0 --azimuth 0:0:1 --no-edges --image none -o "$tmp/flat" -q
near "plate without edges" "$(cell "$tmp/flat/rcs.csv" 1 vv_dbsm)" 17.0187 0.0001
"$pitviper" rcs plate:0.3x0.2 --frequency 10 --elevation 0 --azimuth 0:30:30 --no-edges --no-polygons --image none -o "$tmp/tubes" -q
near "plate by tubes" "$(cell "$tmp/tubes/rcs.csv" 1 vv_dbsm)" 17.019 0.001
check "by tubes it is not the same to the last digit" [ "$(sed -n 2p "$tmp/tubes/rcs.csv")" != "$(sed -n 2p "$tmp/flat/rcs.csv")" ]
near "sphere" "$(cell "$tmp/rcs" 3 hh_dbsm)" -1.049 0.1
near "sphere, bistatic" "$(cell "$tmp/rcs" 4 hh_dbsm)" -1.049 0.3
near "plate at 2 km" "$(cell "$tmp/rcs" 5 vv_dbsm)" "$(cell "$tmp/rcs" 2 vv_dbsm)" 0.01
for row in 6 7 8 9 10; do check "row $row has an error" [ -n "$(cell "$tmp/rcs" $row error)" ]; done

run rcs jeep -o "$tmp/jeep" --frequency 3,4 --azimuth -30:30:15 --elevation 10 --image 20 --cell 2
check "rcs jeep: exit code" [ $code = 0 ]
for file in rcs.csv rcs.svg isar.png; do check "$file" [ -s "$tmp/jeep/$file" ]; done
check "nothing half written" [ -z "$(find "$tmp/jeep" -name '*.part')" ]
check "a row each look and frequency" [ "$(wc -l <"$tmp/jeep/rcs.csv")" = 11 ]
check "each row has all cells" [ "$(awk -F, '{ print NF }' "$tmp/jeep/rcs.csv" | sort -u)" = 15 ]
check "a jeep is of -10 .. 40 dBsm" awk -F, 'NR > 1 && !($4 > 0 - 10 && $4 < 40) { exit 1 }' "$tmp/jeep/rcs.csv"
check "the summary" said 'jeep at 4 GHz: mean HH [0-9.-]+, VV [0-9.-]+ dBsm'
check "and the error of its grid" said 'another grid: -[0-9]+ dB'
check "and how far its facets are off curved surfaces: 2.4 degrees by what built-in models are made to" \
    said 'facets of curved surfaces.* (2[.][0-4]|1[.][0-9]) and '
check "the plot is XML" xml "$tmp/jeep/rcs.svg"
check "the picture is a PNG" [ "$(head -c 8 "$tmp/jeep/isar.png" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]

run rcs sphere:0.3 -o "$tmp/ball" --azimuth 0:20:10 --image none
check "a shape: exit code" [ $code = 0 ]
check "without a picture" [ ! -e "$tmp/ball/isar.png" ]
run rcs sphere:0.3 -o "$tmp/ball" --azimuth 0:20:10 --image none
check "existing files: exit code" [ $code = 1 ]
check "existing files: said" complained 'rcs\.csv exists already.*--overwrite'
cp "$tmp/ball/rcs.csv" "$tmp/first"
run rcs sphere:0.3 -o "$tmp/ball" --azimuth 0:20:10 --image none --overwrite
check "--overwrite" [ $code = 0 ]
check "the same again" cmp -s "$tmp/first" "$tmp/ball/rcs.csv"

# what it wrote is a signature: the same fields at its rows, between them those of a sphere, nothing beyond
run rcs "given:$tmp/first" -o "$tmp/given" --azimuth 0:20:10
check "a given signature: exit code" [ $code = 0 ] || cat "$tmp/stderr"
check "a given signature: the same rows" [ -n "$(cut -d, -f1-3,8,9,14,15 "$tmp/first")" -a \
    "$(cut -d, -f1-3,8,9,14,15 "$tmp/first")" = "$(cut -d, -f1-3,8,9,14,15 "$tmp/given/rcs.csv")" ]
check "a given signature: no picture" [ ! -e "$tmp/given/isar.png" ]
printf 'target,f_ghz,az_deg,el_deg,rx_az_deg,rx_el_deg\ngiven:%s,10,5,10,,\ngiven:%s,10,90,10,,\ngiven:%s,10,5,10,6,10\ngiven:none,10,5,10,,\n' \
    "$tmp/first" "$tmp/first" "$tmp/first" | "$pitviper" probe rcs >"$tmp/rcs" 2>/dev/null
near "a given sphere, between rows" "$(cell "$tmp/rcs" 1 hh_dbsm)" -5.486 0.1 # pi 0.3^2
for row in 2 3 4; do check "given, row $row has an error" [ -n "$(cell "$tmp/rcs" $row error)" ]; done
run rcs "given:$tmp/first" -o "$tmp/beyond" --azimuth 0:40:20
check "beyond its end: said" complained 'ends before 1 of these looks'

# a plate on a joint: turned by 30 degrees it flashes at an azimuth of 30 degrees, 4 pi (0.3 0.2)^2 / lambda^2
printf 'o stand\nv -2 0 0\nv -2 0.001 0\nv -2 0 0.001\nf 1 2 3\no plate\nv 0 -0.1 -0.15\nv 0 0.1 -0.15\nv 0 0.1 0.15\nv 0 -0.1 0.15\nf 4 5 6 7\n' >"$tmp/plate.obj"
printf 'axes: +x +y\norigin: 0 0 0\nmaterials: {"*": metal_steel_galvanized}\njoints:\n- {nodes: "plate*", name: sail, pivot: 0 0 0, axis: yaw, limits_deg: -90 90}\n' >"$tmp/plate.yaml"
turned=("$tmp/plate.obj" --elevation 0 --azimuth 0:30:30 --image none)
run rcs "${turned[@]}" -o "$tmp/sail" --joint sail=30
check "a joint: exit code" [ $code = 0 ] || cat "$tmp/stderr"
near "a turned plate" "$(cell "$tmp/sail/rcs.csv" 2 vv_dbsm)" 17.019 0.05
run rcs "${turned[@]}" -o "$tmp/rest"
near "at rest" "$(cell "$tmp/rest/rcs.csv" 1 vv_dbsm)" 17.019 0.05
check "and each elsewhere far less" awk -v a="$(cell "$tmp/sail/rcs.csv" 1 vv_dbsm)" -v b="$(cell "$tmp/rest/rcs.csv" 2 vv_dbsm)" \
    'BEGIN { exit !(a < 0 && b < 0) }'
run rcs "${turned[@]}" -o "$tmp/wrong" --joint mast=30
check "no such joint: the joints are said" complained 'no joint mast; it has sail'
run rcs "${turned[@]}" -o "$tmp/wrong" --joint sail=91
check "beyond its limits" complained '91 is outside its limits, -90 .. 90'
run rcs "${turned[@]}" -o "$tmp/wrong" --joint sail
check "no value" [ $code = 2 ] && complained 'needs NAME=VALUE'

# a library of signatures: interrupted, it goes on where it was, to the same bits; what is whole is left as it is, what
# is cut short is made again
bins=(rcs person --preset search_ku --azimuth 20:22 --elevation 5.2 --range 1000)
run "${bins[@]}" --library "$tmp/whole"
check "a library: exit code" [ $code = 0 ] || cat "$tmp/stderr"
check "a library: what was made" said 'person for search_ku: [1-9][0-9]* bins, [1-9][0-9]* made'
count=$(find "$tmp/whole" -name '*.sig' | wc -l)
check "a library: a file a bin" said "person for search_ku: $count bins, $count made"
check "a library: and nothing else" [ "$count" -ge 4 -a "$(find "$tmp/whole" -type f | wc -l)" = "$count" ]
"$pitviper" "${bins[@]}" --library "$tmp/part" >/dev/null 2>&1 &
going=$!
for _ in $(seq 600); do [ "$(find "$tmp/part" -name '*.sig' 2>/dev/null | wc -l)" -ge 1 ] && break; sleep 0.05; done
kill -KILL $going 2>/dev/null; wait $going 2>/dev/null
made=$(find "$tmp/part" -name '*.sig' | wc -l)
check "a library: it was interrupted after $made of $count" [ "$made" -ge 1 -a "$made" -lt "$count" ]
find "$tmp/part" -name '*.part' -delete
stamps() { (cd "$tmp/part" && stat -c '%n %i %y' "$@"); }
mapfile -t there < <(cd "$tmp/part" && ls -- *.sig)
before=$(stamps "${there[@]}")
run "${bins[@]}" --library "$tmp/part"
check "a library: resumed" [ $code = 0 ]
check "a library: only what was missing is made" said "$count bins, $((count - made)) made"
check "a library: what was there is left as it is" [ "$(stamps "${there[@]}")" = "$before" ]
check "a library: as if never interrupted" diff -r "$tmp/whole" "$tmp/part"
mapfile -t there < <(cd "$tmp/part" && ls -- *.sig)
truncate -s -1 "$tmp/part/${there[0]}"
: >"$tmp/part/${there[1]}"
run "${bins[@]}" --library "$tmp/part"
check "a library, two files cut short: both are made again" said "$count bins, 2 made"
check "a library, two files cut short: it is said" complained "${there[0]%.sig}.*damaged|${there[1]%.sig}.*damaged"
check "a library, two files cut short: whole again" diff -r "$tmp/whole" "$tmp/part"
run "${bins[@]}" --library "$tmp/part"
check "a library that is whole: nothing is made" said "$count bins, 0 made"

run rcs frigate9 -o "$tmp/none"
check "no such model: exit code" [ $code = 1 ]
check "no such model: said" complained "no built-in model of this name: 'frigate9'"
check "no such model: nothing is made" [ ! -e "$tmp/none" ]
while read -r named arguments; do
    # shellcheck disable=SC2086
    run rcs -o "$tmp/none" $arguments
    check "rcs $arguments: exit code" [ $code = 2 ]
    check "rcs $arguments: said" complained "$named"
    check "rcs $arguments: nothing is made" [ ! -e "$tmp/none" ]
done <<'WRONG'
--frequency tank --frequency 0
--frequency tank --frequency 10,x
--frequency tank --frequency
--azimuth tank --azimuth 0:360
--azimuth tank --azimuth 10:0:1
--azimuth tank --azimuth 0:360:0
--azimuth tank --azimuth 0:360:0.001
--elevation tank --elevation 91
--elevation tank --elevation 90
--range tank --range 0
--rays tank --rays 100
--warp tank --warp -1
--image tank --image north
--cell tank --cell 0
target tank truck
target --range 60
option tank --frob
WRONG
finish
