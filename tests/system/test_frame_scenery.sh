#!/usr/bin/env bash
# A frame with buildings and clutter is kept whole in its file: invented ones by what they follow from, those of files by
# their records, with trees of files; elsewhere, without those files and with other threads, it has the same bits. `explain`
# says of a wall what it is, of what it is built, what is behind it; of clutter what heats it.
. "$(dirname "$0")/common.sh"
bare=("${built[@]}")
judges python3.OpenEXR python3.numpy python3.PIL
pitviper=$(realpath "$pitviper")
judge() { python3 tests/system/explain_judge.py "$@"; }
coarse_heat=(--set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=64)

# again NAME: rendered where nothing else is
again() {
    local name=$1 made was size
    mkdir -p "$tmp/elsewhere"
    cp "$tmp/$name/frame_000000.pvf" "$tmp/elsewhere/$name.pvf"
    (cd "$tmp/elsewhere" && env -u PITVIPER_DATA "$pitviper" frame "$name.pvf" --threads 3) >"$tmp/stdout" 2>"$tmp/stderr"
    check "$name: rendered again" [ $? = 0 ]
    made=$(grep -oE 'frame [0-9a-f]{64}' "$tmp/stdout")
    was=$(grep -oE '"frame_sha256":"[0-9a-f]{64}' "$tmp/$name/truth.jsonl" | grep -oE '[0-9a-f]{64}')
    check "$name: the frame of the replay" [ "$made" = "frame $was" ]
    size=$(stat -c %s "$tmp/elsewhere/$name.pvf")
    check "$name: $size octets" [ "$size" -lt 60000 ]
}

# ---- invented -------------------------------------------------------------------------------------
regress_case village
run replay "$tmp/village.pcap" "${case_options[@]}" "${coarse_heat[@]}" --out "$tmp/village" --only 0 --save-frame 0 --threads 1
check "village: saved" [ "$code" = 0 ]
again village
count() { python3 -c "import json, sys; print(json.load(open('$tmp/$1/run.json'))['scenery']$2)"; }
check "village: run.json counts what the choices say" \
    grep -q "buildings: $(count village '["buildings"]') invented, $(count village '["lines"]') walls" "$tmp/village/run.json"
check "village: classes add up" [ "$(count village '["clutter"]')" = "$(python3 -c "
import json; print(sum(json.load(open('$tmp/village/run.json'))['scenery']['classes'].values()))")" ]

# a pixel of what shows most, of buildings and of clutter
judge "$tmp/village" 0 pixels >"$tmp/pixels"
for kind in building clutter; do
    read -r _ x y < <(grep "^$kind " "$tmp/pixels")
    check "village: a pixel of $kind" [ -n "${y:-}" ]
    "$pitviper" explain "$tmp/village" 0 "$x" "$y" --json --threads 2 >"$tmp/$kind.json" 2>"$tmp/stderr"
    check "$kind $x $y: explained" [ $? = 0 ]
    judge "$tmp/village" 0 judge "$kind" "$x" "$y" <"$tmp/$kind.json" >"$tmp/said"
    check "$kind $x $y: the judge agrees" [ $? = 0 ]
    cat "$tmp/said"
done
# the judge refuses another construction, room or share of the sun; plane and record name the same material
spoilt() {
    python3 - "$tmp/building.json" "$1" "$2" <<'P' >"$tmp/spoilt.json"
import json, sys
e = json.load(open(sys.argv[1]))
for s in e['samples'][0]:
    if 'construction' in s.get('temperature', {}):
        s['temperature'][sys.argv[2]] = json.loads(sys.argv[3])
json.dump(e, sys.stdout)
P
    ! judge "$tmp/village" 0 judge building "$x" "$y" <"$tmp/spoilt.json" >/dev/null
}
read -r _ x y < <(grep "^building " "$tmp/pixels")
check "the judge refuses another construction" spoilt construction '"glazing_triple"'
check "the judge refuses another temperature in the sun" spoilt in_sun_k 250
python3 - "$tmp" "$x" "$y" <<'P'
import json, sys
import Imath, OpenEXR, numpy as np
tmp, x, y = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
f = OpenEXR.InputFile(f'{tmp}/village/frames/truth/000000.exr')
box = f.header()['dataWindow']
plane = lambda name, kind, of: np.frombuffer(f.channel(name, Imath.PixelType(kind)), of).reshape(box.max.y + 1, -1)[y, x]
name = json.load(open(f'{tmp}/village/run.json'))['materials'][plane('material', Imath.PixelType.UINT, np.uint32) - 1]
first = json.load(open(f'{tmp}/building.json'))['samples'][0][0]
assert first['material'] == name, (first['material'], name)
assert abs(first['temperature']['temp_k'] - plane('temp_k', Imath.PixelType.FLOAT, np.float32)) < 0.01
assert first['surface'].split()[0] in ('house', 'flats', 'barn', 'shed', 'hall', 'church'), first['surface']
assert first['instance'] == plane('instance', Imath.PixelType.UINT, np.uint32)
P
check "a building's material, temperature and number are the truth planes'" [ $? = 0 ]
run explain "$tmp/village" 0 "$x" "$y"
check "text: building and part" said '(house|flats|barn|shed|hall|church) [0-9a-f]{16}, (wall|roof|window|door|chimney)'
check "text: its construction and what is behind it" \
    said 'construction [a-z_]+ \(etc/constructions.csv\), [0-9]+ layers? before (a heated room|an unheated room|a flue)? ?.*K in the sun of the hours before'
check "text: no more than 50 lines" [ "$(wc -l <"$tmp/stdout")" -le 50 ]

# ---- of files, with trees, among woods -------------------------------------------------------------
python3 - "$tmp" <<'P'
import json, sys
def house(lon, lat, levels):
    ring = [[lon, lat], [lon + 159e-6, lat], [lon + 159e-6, lat + 81e-6], [lon, lat + 81e-6], [lon, lat]]
    return {'type': 'Feature', 'properties': {'building': 'house', 'building:levels': levels, 'roof:shape': 'gabled'},
            'geometry': {'type': 'Polygon', 'coordinates': [ring]}}
road = {'type': 'Feature', 'properties': {'highway': 'residential'},
        'geometry': {'type': 'LineString', 'coordinates': [[9.0990, 47.2999], [9.1010, 47.2999]]}}
features = [house(9.1003, 47.3001, '2'), house(9.0995, 47.3002, '1'), road]
json.dump({'type': 'FeatureCollection', 'features': features}, open(sys.argv[1] + '/hamlet.geojson', 'w'))
P
printf 'lat,lon,kind,height_m\n47.30005,9.0999,english_oak,11\n47.3001,9.1001,birch,9\n' >"$tmp/trees.csv"
run replay "$tmp/village.pcap" "${case_options[@]}" "${coarse_heat[@]}" --out "$tmp/files" --only 0 --save-frame 0 --threads 2 \
    --bands lwir --set terrain.buildings="$tmp/hamlet.geojson" --set terrain.trees="$tmp/trees.csv" --set terrain.woods=on \
    --set terrain.woods_trees=300 --set terrain.detail=off
check "files: saved" [ "$code" = 0 ]
[ "$code" = 0 ] || cat "$tmp/stderr"
check "files: two houses, a road, two trees" [ "$(count files '["buildings"]') $(count files '["lines"]') $(count files '["trees"]')" = "2 1 2" ]
rm "$tmp/hamlet.geojson" "$tmp/trees.csv"
again files
check "files: their names are not in it" [ "$(grep -ac hamlet "$tmp/elsewhere/files.pvf")" = 0 ]

finish
