#!/usr/bin/env bash
# A frame saved by replay is re-rendered by itself, in another folder and with another number of threads, to the same
# bits; a damaged file is refused, and a table that differs is named. labels: small
. "$(dirname "$0")/common.sh"

pitviper=$(realpath "$pitviper")
exercise demo "$tmp/demo.pcap"
# for radars: a person, and a helicopter that flies past it a kilometre off
cat >"$tmp/past.yaml" <<'Y'
duration_s: 6
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
vehicles:
  - {name: Man, id: 11, type: person, force: 2, route_m: [[0, 0]]}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-985, -100], [-985, 300]], speed_mps: 40, height_m: 100}
Y
exercise "$tmp/past.yaml" "$tmp/past.pcap"
past=("$tmp/past.pcap" 3 --rate 1 --bands radar --host 1:3001:31 --set exercise.aim=1:3001:11 --set sensor.gimbal_limit_deg=180)
mkdir "$tmp/elsewhere"

# saved NAME LOG FRAME options: a replay that saves a frame
saved() {
    local name=$1 log=$2 frame=$3; shift 3
    run replay "$log" --out "$tmp/$name" --size 64x48 --only "$frame" --save-frame "$frame" --overwrite --threads 1 "${coarse[@]}" "$@"
    check "$name: is saved" [ "$code" = 0 ]
    [ "$code" = 0 ] || cat "$tmp/stderr"
    mv "$tmp/$name"/frame_*.pvf "$tmp/elsewhere/$name.pvf"
}
# again NAME options: rendered in another folder, without data
again() {
    local name=$1 made was size; shift
    (cd "$tmp/elsewhere" && env -u PITVIPER_DATA "$pitviper" frame "$name.pvf" --threads 3 "$@") \
        >"$tmp/stdout" 2>"$tmp/stderr"
    check "$name: rendered again" [ $? = 0 ]
    made=$(grep -oE 'frame [0-9a-f]{64}' "$tmp/stdout")
    was=$(grep -oE '"frame_sha256":"[0-9a-f]{64}' "$tmp/$name/truth.jsonl" | grep -oE '[0-9a-f]{64}' | tail -1)
    check "$name: the frame of the replay" [ "$made" = "frame $was" ]
    size=$(stat -c %s "$tmp/elsewhere/$name.pvf")
    check "$name: $size octets" [ "$size" -lt 100000 ]
}
# a sensor's lens and detector, a channel in the place of a band, weather, seed, the user's own materials, smoke, a range
# profile; an earlier run's frame file is removed with its other products
grep -E '^(name|grass_green),' etc/materials.csv >"$tmp/own.csv"
mkdir "$tmp/demo"
echo '{"frame": 3}' >"$tmp/demo/truth.jsonl"
touch "$tmp/demo/frame_000003.pvf"
saved demo "$tmp/demo.pcap" 12 --bands swir,mwir,lwir,radar --set sensor.preset=staring_lwir --set sensor.lens_k1=-0.1 \
    --set weather.visibility_m=5000 --set weather.air_temp_k=275 --seed 7 --set models.materials="$tmp/own.csv"
check "demo: frame files of an earlier run are removed" [ ! -e "$tmp/demo/frame_000003.pvf" ]
again demo --out "$tmp/again" --no-skip
check "products: truth.jsonl is the replay's" cmp "$tmp/demo/truth.jsonl" "$tmp/again/truth.jsonl"
# a radar over the same ground: its map, its files and its truth
# (at 13 GHz, where ray tubes are a seventh of those at 35 GHz)
{ grep '^name,' etc/radars.csv; sed -n 's/^seeker_35,lfm,35,/seeker,lfm,13,/p' etc/radars.csv; } >"$tmp/seeker.csv"
saved radar "${past[@]}" --set radar.table="$tmp/seeker.csv" --set radar.preset=seeker --no-png
again radar --out "$tmp/radar_again"
check "radar: the same map" grep -q "the same: the radar's map, to the bit; [1-9]" "$tmp/stdout"
check "radar: truth.jsonl is the replay's" cmp "$tmp/radar/truth.jsonl" "$tmp/radar_again/truth.jsonl"
for file in radar/000003.csv radar/000003.exr; do check "radar: $file" cmp "$tmp/radar/$file" "$tmp/radar_again/$file"; done
# the same with a scan: over range and azimuth, and on the pixels
printf 'x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,-1,20,20\n' >"$tmp/point.csv"
printf 'entity,signature\n*,point.csv\n' >"$tmp/given.csv"
saved scan "${past[@]}" --set radar.preset=search_ku --set radar.scan_deg=4 \
    --set radar.given="$tmp/given.csv"
again scan --out "$tmp/scan_again"
check "scan: the same map and scan" grep -q "the same: the radar's map and scan, to the bit; [1-9]" "$tmp/stdout"
check "scan: truth.jsonl is the replay's" cmp "$tmp/scan/truth.jsonl" "$tmp/scan_again/truth.jsonl"
check "scan: its files are the replay's" diff -r "$tmp/scan/radar" "$tmp/scan_again/radar"
# all files of a scan, and no others; the next run clears them away, and leaves what is not of a run
files="000003.csv 000003.exr 000003.png 000003_dbs.csv 000003_dbs.exr 000003_dbs.png 000003_scan.exr 000003_scan.png"
files+=" 000003_view.exr 000003_view_dbs.png 000003_view_scan.png"
check "scan: its files have these names" [ "$(ls "$tmp/scan/radar" | tr '\n' ' ')" = "$files " ]
patterns=()
while read -ra words; do
    for word in "${words[@]}"; do
        word=${word%,}
        case $word in
            radar/NNNNNN*) word=${word#radar/NNNNNN}; stem=${word%.*} ;;
            .*) word=$stem$word ;;
            _*) ;;
            *) break ;;
        esac
        patterns+=("$word")
    done
done < <("$pitviper" help products | grep '^ *radar/NNNNNN')
listed() { for p in "${patterns[@]}"; do [[ $1 == $p ]] && return; done; false; }
for file in $files; do check "scan: help products lists ${file#000003}" listed "${file#000003}"; done
check "scan: help products lists nothing else" not listed _scan.csv
echo mine >"$tmp/scan/radar/000003_mine.png"
run replay "${past[0]}" --out "$tmp/scan" --size 32x24 --only 3 "${past[@]:2}" --overwrite --threads 1 "${coarse[@]}"
check "scan: the next run clears its files away, and no others" [ "$(ls "$tmp/scan/radar")" = 000003_mine.png ]
for band in swir mwir lwir radar truth; do
    png=frames/$band/000012.png
    check "products: $band.png is the replay's" cmp "$tmp/demo/$png" "$tmp/again/$png"
done
run frame "$tmp/elsewhere/demo.pvf" --out "$tmp/again"
check "products: kept without --overwrite" [ "$code" != 0 ]
check "products: the message names --overwrite" complained 'overwrite'

# damaged
file=$tmp/elsewhere/demo.pvf
size=$(stat -c %s "$file")
refused() { # refused WHAT WORDS
    run frame "$tmp/damaged.pvf"
    check "$1: refused" [ "$code" = 1 ]
    check "$1: it says $2" complained "$2"
}
head -c $((size / 2)) "$file" >"$tmp/damaged.pvf"; refused "cut" 'ends too early'
cp "$file" "$tmp/damaged.pvf"
printf '\377\377\377\377' | dd of="$tmp/damaged.pvf" bs=1 seek=$((size / 2)) conv=notrunc status=none
refused "octets turned" 'damaged'
printf '\013' | dd of="$tmp/damaged.pvf" bs=1 seek=8 conv=notrunc status=none; refused "a later format" 'another version'

# another table, named; forced: the planes that it changes, named
cp -r etc "$tmp/etc"
sed '/^[a-z]/s/,0\.0\([0-9]\)/,0.1\1/g' etc/materials.csv >"$tmp/etc/materials.csv"
check "the table is another" not cmp -s etc/materials.csv "$tmp/etc/materials.csv"
export PITVIPER_ETC=$tmp/etc
run frame "$file" --force
check "another table: named" complained 'materials\.csv is not the table'
check "another table: other bits" [ "$code" = 1 ]
check "another table: planes named" complained 'swir/Y differs: mean'
check "another table: range stays" not complained 'truth/range_m differs'
unset PITVIPER_ETC
sed -i 's/0\.0413/0.2413/' "$tmp/own.csv"
run frame "$file"
check "the user's own materials: refused" [ "$code" = 1 ]
check "the user's own materials: named" complained 'models\.materials is not the table'
finish
