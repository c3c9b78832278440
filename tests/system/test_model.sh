#!/usr/bin/env bash
# `pitviper model info` and `pitviper probe rays`: built-in models, files, sidecars, and what is wrong with them; and a
# replay whose catalog names a file.
. "$(dirname "$0")/common.sh"

run model --help
check "model --help ends well" [ $code = 0 ]
check "model --help shows its usage" grep -q 'pitviper model info NAME|FILE' "$tmp/stdout"
run model info tank --sag 0.02
check "model info tank" [ $code = 0 ]
check "the tank's turret and its DIS class" said 'turret on hull .*DIS class 4096 primary_turret_1 metric 11 azimuth'
check "the tank is closed" said 'edges: 0 open'
run model list
check "model list: a shape, its size, what moves" grep -qE '^  tank +9\.53 x 3\.59 x 2\.60 +primary_turret_1 azimuth, primary_gun_1 elevation' "$tmp/stdout"
check "model list: a row" grep -qE '^  1\.1\.225\.6\.1\.\*\.\* +land +jeep +4\.57 x 2\.16 x 1\.83 +catalog\.csv:[0-9]+ +HMMWV' "$tmp/stdout"
check "model list: every row of the catalog" [ "$(grep -c 'catalog\.csv:[0-9]' "$tmp/stdout")" = "$(grep -cE '^[0-9*]' etc/catalog.csv)" ]
run model --keys
keys=$(sed -nE 's/^  ([a-z_.]+): .*/\1/p' "$tmp/stdout")
check "model --keys: all of the reader's" [ "$(wc -w <<<"$keys")" = 31 ]
for key in $keys; do # each with a value that none takes is refused with file, line and its name
    case $key in
        joints.*) printf 'joints:\n- {%s: {a: b}}\n' "${key#joints.}" ;;
        *materials) continue ;; # maps of patterns: any words
        *) printf '%s: {a: b}\n' "$key" ;;
    esac >"$tmp/key.yaml"
    "$pitviper" model info "$tmp/key.yaml" 2>"$tmp/stderr"
    check "model --keys: $key" grep -qE "key\.yaml:[12]: $key(:| needs one value)" "$tmp/stderr"
done
cat >"$tmp/names.gltf" <<'GLTF'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2,3]}],
 "nodes":[{"mesh":0},{"mesh":0,"name":"wheel"},{"mesh":0,"name":"wheel","translation":[2,0,0]},{"mesh":0,"name":"Turret_01"}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
 "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
 "bufferViews":[{"buffer":0,"byteLength":36}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}
GLTF
printf 'joints:\n- {nodes: turret, class: primary_turret_1, metric: azimuth, pivot: centre}\n' >"$tmp/names.yaml"
run model info "$tmp/names.gltf"
check "names: the one that was meant" complained "names.yaml:2: joints: no node of the file matches 'turret'.*did you mean 'Turret_01'\?"
check "names: those that there are, and how many have none" complained '1 have no name; there are: .*wheel \(2 times\), Turret_01'
printf 'joints:\n- {nodes: wheel, pivot: centre, axis: pitch}\n' >"$tmp/names.yaml"
run model info "$tmp/names.gltf"
check "names: twice" complained "names.yaml:2: joints: nodes: 2 nodes of the file have the name 'wheel' and will move as one; .each: true."
printf 'joints:\n- {nodes: wheel, each: true, pivot: centre, axis: pitch}\n' >"$tmp/names.yaml"
run model info "$tmp/names.gltf"
check "names: each its own: nothing to warn of but the one without" not complained 'will move as one'
check "names: the one without" complained 'names.gltf: 1 of 4 meshes hang on nodes without a name'
check "names: and counted" grep -q '1 nodes have none, 2 share theirs' "$tmp/stdout"

# materials of one's own, by the settings, in every command that reads a model
{ grep -m1 '^name' etc/materials.csv; grep '^canvas,' etc/materials.csv | sed 's/^canvas/my_canvas/'; } >"$tmp/own.csv"
printf 'models: {materials: own.csv}\n' >"$tmp/node.yaml"
box_obj crate 0 2 0 4 0 6 >"$tmp/crate.obj"
printf 'axes: +x +z\nmaterials: {"*": my_canvas}\n' >"$tmp/crate.yaml"
run model info "$tmp/crate.obj"
check "own materials: not known without the settings" complained "crate.yaml:2: materials: 'my_canvas' is not a row"
run model info "$tmp/crate.obj" --config "$tmp/node.yaml"
check "own materials: info" said 'crate on hull, my_canvas,'
run model show "$tmp/crate.obj" -c "$tmp/node.yaml" -o "$tmp/crate.png"
check "own materials: show" [ $code = 0 ]
run rcs "$tmp/crate.obj" -c "$tmp/node.yaml" --azimuth 0:10:10 --image none --frequency 3 -o "$tmp/rcs"
check "own materials: rcs" [ $code = 0 ]
run heat "$tmp/crate.obj" -c "$tmp/node.yaml" --step 600 -o "$tmp/heat"
check "own materials: heat" [ $code = 0 ]
printf 'ox_m,oy_m,oz_m,dx,dy,dz\n-9,0,-1,1,0,0\n' | "$pitviper" probe -c "$tmp/node.yaml" rays "$tmp/crate.obj" body >"$tmp/stdout" 2>"$tmp/stderr"
check "own materials: probe rays" grep -q ',1,8,-1,0,0,crate,' "$tmp/stdout"
exercise demo "$tmp/small.pcap"
{ echo 'type,model,origin'; echo '1.1.225.1,crate.obj,base'; } >"$tmp/mine.csv"
printf 'models: {materials: own.csv, catalog: mine.csv}\n' >"$tmp/both.yaml"
run inspect "$tmp/small.pcap" -c "$tmp/both.yaml"
check "own catalog: inspect" [ $code = 0 ]
check "own catalog: what was read is said before use" complained 'model: .*crate.obj: 2 x 4 x 6 m, 12 triangles; 1 m a unit .*axes by the sidecar; lost: nothing'
run model info "$tmp/crate.obj" -c "$tmp/none.yaml"
check "settings that are not there: exit code" [ $code = 1 ]

# --json is the report, field by field
run model info "$tmp/crate.obj" -c "$tmp/node.yaml" --json
check "info --json" python3 - "$tmp/stdout" <<'PY'
import json, sys
d = json.load(open(sys.argv[1]))
i = d['import']
assert d['model'] == 'crate' and d['size_m'] == [2, 4, 6] and d['triangles'] == 12 and d['edges']['open'] == 0, d
assert i['scale_m'] == 1 and i['axes_from'] == 'the sidecar' and (i['forward'], i['up']) == ('+x', '+z') and i['octets'] > 100, i
assert d['parts'][0]['material'] == 'my_canvas' and i['material_parts_by']['sidecar'] == 1 and 'odd_size' not in d, d
PY
run model info tank --json
check "info --json: joints of a built-in model" python3 -c 'import json,sys; d = json.load(open(sys.argv[1])); n = {x["name"]: x for x in d["nodes"]}; assert n["turret"]["dis_class"] == 4096 and n["turret"]["joint"] == "turns" and "import" not in d' "$tmp/stdout"

# a size that no such thing has: by the type's row, by its kind, and by what a thing may be
box_obj crate 0 700 0 350 0 260 >"$tmp/large.obj"
{ echo 'type,model,origin'; echo '1.1.222.1,large.obj,base'; echo '1,large.obj,base'; echo '2.9,large.obj,base'; } >"$tmp/mine.csv"
printf 'axes: +x +z\n' >"$tmp/large.yaml"
run model list -c "$tmp/both.yaml"
check "size: of the type" complained 'mine.csv:2: .*large.obj is 700 x 350 x 260 m .*catalog.csv:[0-9]+ \(tank.*scale: 0.01. \(the file is in centimetres\)'
check "size: of the kind" complained 'mine.csv:[34]: .*large.obj is 700 m large, but what etc/catalog.csv has of its kind'
printf 'axes: +x +z\nscale: 0.01\n' >"$tmp/large.yaml"
{ echo 'type,model,origin'; echo '1.1.222.1,large.obj,base'; } >"$tmp/mine.csv"
run model list -c "$tmp/both.yaml"
check "size: right" not complained 'large.obj is'

for wrong in "" "frob" "info" "info tank truck" "info tank --sag 3" "info --frob"; do
    # shellcheck disable=SC2086
    run model $wrong
    check "model $wrong: exit code" [ $code = 2 ]
done
run model info frigate9
check "no such model: exit code" [ $code = 1 ]
check "no such model: said" complained "no built-in model of this name: 'frigate9'"
run model info "$tmp/none.glb"
check "no such file: exit code" [ $code = 1 ]
check "no such file: said" complained 'none.glb'

# a block 2 x 4 x 6
box_obj block 0 2 0 4 0 6 >"$tmp/block.obj"
rays() { # rays MODEL [AXES]: one ray along the file's +x, one that misses, one without a direction
    printf 'ox_m,oy_m,oz_m,dx,dy,dz\n-3,1,1,2,0,0\n-3,9,1,1,0,0\n0,0,0,0,0,0\n' |
        "$pitviper" probe rays "$@" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
}
rays "$tmp/block.obj"
check "rays: exit code" [ $code = 0 ]
check "rays: from x = -3 the block is 3 m off, normal -x" grep -qx -- '-3,1,1,2,0,0,1,3,-1,0,0,block,' "$tmp/stdout"
check "rays: a miss" grep -qx -- '-3,9,1,1,0,0,0,,,,,,' "$tmp/stdout"
check "rays: no direction" grep -q -- 'must not all be 0' "$tmp/stdout"
rays "$tmp/block.obj" body # x is forward, 6 m long, on its base's centre: 1 m up and down is below ground
check "rays body: misses what is above z = 0" grep -qx -- '-3,1,1,2,0,0,0,,,,,,' "$tmp/stdout"
printf 'axes: +x +z\norigin: 0 0 0\nscale: 0.5\njoints:\n- {nodes: block, axis: yaw, pivot: 0 0 0, limits_deg: -10 10}\n' >"$tmp/block.yaml"
rays "$tmp/block.obj" file
check "rays file: units of the file, distance in m" grep -qx -- '-3,1,1,2,0,0,1,1.5,-1,0,0,block,' "$tmp/stdout"
run model info "$tmp/block.obj"
check "info with a sidecar" [ $code = 0 ]
check "info: the joint's limits" said 'turns about 0.000 0.000 1.000 -10 .. 10 deg'
check "info: half the size" said 'size: 1.000 x 2.000 x 3.000'
printf 'materials: {"*": rubber_black}\nroles: {block: wheel}\nthickness_mm: {"*": 7, block: 12.5}\n' >"$tmp/block.yaml"
run model info "$tmp/block.obj"
check "info: material, role and skin of the sidecar" said 'block on hull, rubber_black, heat wheel, skin 12.5 mm, 12 triangles|rubber_black, heat wheel, 12 triangles, skin 12.5 mm'
echo 'thickness_mm: {block: 5000}' >"$tmp/block.yaml"
run model info "$tmp/block.obj"
check "a skin too thick: said" complained "block.yaml:1: thickness_mm: '5000' is not a thickness in 0.1 .. 1000 mm"
echo 'scael: 3' >"$tmp/block.yaml"
run model info "$tmp/block.obj"
check "a slip in the sidecar: exit code" [ $code = 1 ]
check "a slip in the sidecar: said" complained 'block.yaml:1: no such key: scael'

# the exercise's tanks as blocks
printf 'axes: +z +y\nscale: 1\n' >"$tmp/block.yaml"
cp -r etc "$tmp/etc"
{ echo 'type,model,origin'; echo '1.1.*.1,../block.obj,base'; grep -E '^(1|2)' etc/catalog.csv | cut -d, -f1-3; } >"$tmp/etc/catalog.csv"
exercise demo "$tmp/demo.pcap"
bare=("${quick[@]}")
PITVIPER_ETC=$tmp/etc replay "$tmp/demo.pcap" "$tmp/out" --only 0 --bands lwir --size 16x16 --threads 1 --no-png
check "a replay with a file in its catalog" [ $code = 0 ]
check "truth calls it by its name" grep -rqs '"block"' "$tmp/out" --include='*.json*'
finish
