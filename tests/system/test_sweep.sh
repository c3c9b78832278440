#!/usr/bin/env bash
# replay --sweep: each variant is the run that its settings and the user's options make, what is made is kept, one that fails
# stops no other, and a file with slips runs nothing. That no option is lost on the way is tests/sensor/test_options.c's.
. "$(dirname "$0")/common.sh"
judges python3.pycocotools

exercise demo "$tmp/demo.pcap"
few=(--from 1366 --to 1366 --bands lwir)
sweep() { local file=$1 out=$2; shift 2; replay "$tmp/demo.pcap" "$out" "${few[@]}" --sweep "$file" "$@"; }
statuses() { grep -oE '"status":"[a-z]+"' "$1/manifest.jsonl" | sort | uniq -c | tr -s ' \n' ' '; }
folders() { grep -oE '"folder":"v[0-9a-f]{10}"' "$1/manifest.jsonl" | cut -d'"' -f4; }

cat >"$tmp/grid.yaml" <<'Y'
axes:
  weather:
    visibility_m: [5000, 23000]
  seed: [1, 2]
  sensor.hfov_deg: 5
Y
sweep "$tmp/grid.yaml" "$tmp/g" --coco
check "a grid" [ "$code" = 0 ]
check "four made" [ "$(statuses "$tmp/g")" = ' 4 "status":"made" ' ]
check "the last axis first" grep -q '"number":2,.*"weather.visibility_m":"5000","seed":"2"' <(sed -n 2p "$tmp/g/manifest.jsonl")
check "a page with four pictures" [ "$(grep -c '<img src="data:image/png' "$tmp/g/manifest.html")" = 4 ]
second=$(folders "$tmp/g" | sed -n 2p)
replay "$tmp/demo.pcap" "$tmp/direct" "${few[@]}" --set weather.visibility_m=5000 --seed 2 --set sensor.hfov_deg=5 --coco
check "its coco.json too" cmp -s "$tmp/direct/coco.json" "$tmp/g/$second/coco.json"
check "a variant is the run of its settings" same_hashes "$tmp/direct" "$tmp/g/$second"
check "with their hash" [ "$(json_numbers "$tmp/direct/run.json" seed)" = 2 -a "$(grep config_sha256 "$tmp/direct/run.json")" = "$(grep config_sha256 "$tmp/g/$second/run.json")" ]
check "which the manifest has" grep -qF "$(grep -oE '[0-9a-f]{64}' <(hashes "$tmp/direct") | head -n 1)" <(sed -n 2p "$tmp/g/manifest.jsonl")
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" -c "$tmp/g/$second/settings.yaml" --out "$tmp/again" >/dev/null 2>&1
check "its settings.yaml makes it again" same_hashes "$tmp/again" "$tmp/g/$second"
# merged OUT VARIANTS: one coco.json of all, that its own reader takes
cat >"$tmp/merged.py" <<'PY'
import json, os, sys
out, variants = sys.argv[1], int(sys.argv[2])
merged = json.load(open(f"{out}/coco.json"))
parts = [json.loads(line)["folder"] for line in open(f"{out}/manifest.jsonl")]
own = {p: json.load(open(f"{out}/{p}/coco.json")) for p in parts}
assert len(parts) == variants == merged["info"]["variants"]
images = {i["id"]: i for i in merged["images"]}
assert len(images) == len(merged["images"]) == sum(len(c["images"]) for c in own.values())
assert sorted(a["id"] for a in merged["annotations"]) == list(range(1, len(merged["annotations"]) + 1))
for i in images.values(): assert os.path.exists(f"{out}/{i['file_name']}"), i["file_name"]
def plain(a, image): return {**a, "id": 0, "image_id": (image["band"], image["frame"])}
for p, c in own.items():  # each annotation is there, at its own image
    its = {i["id"]: i for i in c["images"]}
    want = [plain(a, its[a["image_id"]]) for a in c["annotations"]]
    got = [plain(a, images[a["image_id"]]) for a in merged["annotations"] if images[a["image_id"]]["variant"] == p]
    assert want == got and len(want) > 0, p
    assert c["categories"] == merged["categories"]
from pycocotools.coco import COCO
c = COCO(f"{out}/coco.json")
for a in c.loadAnns(c.getAnnIds()): assert c.annToMask(a).sum() == a["area"]
PY
merged() { python3 "$tmp/merged.py" "$@" >/dev/null; }
check "one coco.json of all" merged "$tmp/g" 4
cp "$tmp/g/coco.json" "$tmp/coco.before"
check "seeds change nothing else" [ "$(folders "$tmp/g" | sort -u | wc -l)" = 4 ]

# again: kept; one spoilt, one cut short: those two are made anew, to the same bits
before=$(hashes "$tmp/g/$second")
rm "$tmp/g/$second/run.json"
third=$(folders "$tmp/g" | sed -n 3p)
sed -i 's/"log_sha256":"./"log_sha256":"x/' "$tmp/g/$third/variant.json"
sweep "$tmp/grid.yaml" "$tmp/g" --coco --threads 1
check "goes on" [ "$(statuses "$tmp/g")" = ' 2 "status":"kept" 2 "status":"made" ' ]
check "to the same bits" [ "$before" = "$(hashes "$tmp/g/$second")" ]
check "coco.json too" cmp -s "$tmp/coco.before" "$tmp/g/coco.json"
printf 'axes: {seed: [3, 2, 1], weather.visibility_m: [5000, 23000], sensor.hfov_deg: 5}\n' >"$tmp/wider.yaml"
sweep "$tmp/wider.yaml" "$tmp/g" --coco
check "wider: coco.json has them all" merged "$tmp/g" 6
check "an axis grows: what was made is kept" [ "$(statuses "$tmp/g")" = ' 4 "status":"kept" 2 "status":"made" ' ]
run replay "$tmp/demo.pcap" --out "$tmp/g" --size 96x64 --rate 1 "${few[@]}" --sweep "$tmp/grid.yaml" --to 1367
check "another span: what is there is kept" [ "$code $(statuses "$tmp/g")" = '1  4 "status":"kept" 2 "status":"made" ' ]
sweep "$tmp/grid.yaml" "$tmp/g" --to 1367
check "another span: nothing is kept" [ "$(statuses "$tmp/g")" = ' 4 "status":"made" ' ]
check "without --coco: none, and none of before" [ -z "$(find "$tmp/g" -maxdepth 1 -name 'coco.json*')" ]

# one that fails
printf 'axes:\n  exercise.host: ["9:9:9", ""]\n' >"$tmp/fails.yaml"
sweep "$tmp/fails.yaml" "$tmp/f"
check "one fails: exit code" [ "$code" = 1 ]
check "one fails: the other is made" [ "$(statuses "$tmp/f")" = ' 1 "status":"failed" 1 "status":"made" ' ]
check "one fails: said why, in one line" [ "$(grep -c 'variant 1, v[0-9a-f]*, exercise.host=9:9:9: .*9:9:9' "$tmp/stderr")" = 1 ]
sweep "$tmp/fails.yaml" "$tmp/f"
check "again: the failed one is tried" [ "$(statuses "$tmp/f")" = ' 1 "status":"failed" 1 "status":"kept" ' ]

# options that are no settings, and such as are flags for one; a setting that needs the sensor of an axis
printf 'mode: zip\naxes: {seed: [1, 2], sensor.hfov_deg: [3, 6], weather.visibility_m: 9000, sensor.table: %s}\n' "$PWD/etc/sensors/example_flir2.sheet" >"$tmp/zip.yaml"
options=(--to 1367 --causal --no-png --only 14 --no-skip --set detector.smear=false --set quality.table=etc/quality.csv)
sweep "$tmp/zip.yaml" "$tmp/z" "${options[@]}"
check "zip: two" [ "$(statuses "$tmp/z")" = ' 2 "status":"made" ' ]
replay "$tmp/demo.pcap" "$tmp/flags" "${few[@]}" "${options[@]}" --seed 2 --set sensor.hfov_deg=6 --set weather.visibility_m=9000 \
    --set sensor.table="$PWD/etc/sensors/example_flir2.sheet"
zipped=$tmp/z/$(folders "$tmp/z" | sed -n 2p)
check "zip: the options are a variant's too" same_hashes "$tmp/flags" "$zipped"
check "zip: the same counts of the sensor, and truth" [ "$(cd "$tmp/flags" && cat raw/lwir/*.png truth.jsonl | sha256sum)" = \
    "$(cd "$zipped" && cat raw/lwir/*.png truth.jsonl | sha256sum)" ]
check "zip: the frame of --only, raw counts, no display" [ "$(cd "$zipped" && find frames raw -type f | sort | xargs)" = \
    "frames/lwir/000014.exr frames/truth/000014.exr raw/lwir/000014.png" ]
check "zip: how it is made again" grep -qx '# To reproduce: pitviper replay LOG --config THIS --only 14' "$zipped/settings.yaml"
check "zip: side by side" grep -q '"seed":"2","sensor.hfov_deg":"6","weather.visibility_m":"9000",' "$tmp/z/manifest.jsonl"
check "no pictures: words" grep -q 'sensor.hfov_deg=6' "$tmp/z/manifest.html"

draws() { printf 'mode: random\ncount: %s\ndraw: %s\naxes: {sensor.hfov_deg: {from: 2, to: 6}, seed: {from: 1, to: 9}}\n' "$1" "$2"; }
draws 2 5 >"$tmp/r2.yaml"; draws 3 5 >"$tmp/r3.yaml"; draws 2 6 >"$tmp/other.yaml"
sweep "$tmp/r2.yaml" "$tmp/r" --no-files
sweep "$tmp/r3.yaml" "$tmp/r" --no-files
check "random: --no-files, and none is there" [ -z "$(find "$tmp/r" -path '*/frames*')" ]
check "random: more draws keep the first" [ "$(statuses "$tmp/r")" = ' 2 "status":"kept" 1 "status":"made" ' ]
check "random: within" bash -c "grep -oE 'hfov_deg\":\"[0-9.]+' '$tmp/r/manifest.jsonl' | cut -d'\"' -f3 | awk '\$1 < 2 || \$1 > 6 { bad = 1 } END { exit bad || NR != 3 }'"
check "random: whole seeds" [ "$(grep -cE '"seed":"[1-9]"' "$tmp/r/manifest.jsonl")" = 3 ]
sweep "$tmp/other.yaml" "$tmp/r" --no-files
check "random: another seed, other draws" [ "$(statuses "$tmp/r")" = ' 2 "status":"made" ' ]
printf 'axes: {weather.visibility_m: [9000, 9000]}\n' >"$tmp/same.yaml"
sweep "$tmp/same.yaml" "$tmp/same" --no-files
check "a value said twice is run once" said '1 variant left out: equal to others'

slip() { # slip WHAT PATTERN TEXT
    printf "$3" >"$tmp/slip.yaml"
    sweep "$tmp/slip.yaml" "$tmp/slip"
    check "$1: exit code $code" [ "$code" = 2 ]
    check "$1: named" complained "$2"
    check "$1: nothing is run" [ ! -e "$tmp/slip" ]
}
slip "unknown key" 'slip.yaml:3: no such key: weather.visibilty_m; did you mean weather.visibility_m' 'axes:\n  seed: [1]\n  weather: {visibilty_m: [5000]}\n'
slip "out of range" "slip.yaml:4: weather.visibility_m: '50' is not a number in 100 .. 300000 m" 'axes:\n  weather.visibility_m:\n    - 5000\n    - 50\n'
slip "not a word of the key's" "slip.yaml:1: sensor.optical: 'red' is not one of rgb.pan.nir" 'axes: {sensor.optical: [rgb, red]}\n'
slip "given twice" 'slip.yaml:3: sensor.hfov_deg:.*twice' 'axes:\n  sensor.hfov_deg: [3]\n  sensor: {hfov_deg: [4]}\n'
slip "together wrong" 'in variant 2, exercise.from_s=1400' 'axes: {exercise.from_s: [1366, 1400]}\n'
slip "a time that is none" "exercise.utc: 'noon'" 'axes: {exercise.utc: [noon]}\n'
slip "an unknown sensor" "no sensor named 'hubble'" 'axes: {sensor.preset: [none, hubble]}\n'
slip "mode" "slip.yaml:1: mode: 'dance' is not one of grid.zip.random" 'mode: dance\naxes: {seed: [1]}\n'
slip "a stray key" "slip.yaml:1: no such key: 'seed'" 'seed: [1, 2]\n'
slip "unequal lists" 'slip.yaml:4: sensor.hfov_deg: has 3 values, but seed has 2' 'mode: zip\naxes:\n  seed: [1, 2]\n  sensor.hfov_deg: [3, 4, 5]\n'
slip "random without count" 'count: is missing' 'mode: random\naxes: {seed: [1, 2]}\n'
slip "more draws than there are" 'slip.yaml:2: count: 7 different draws are requested, but the axes have 6 combinations' \
    'mode: random\ncount: 7\naxes: {seed: [1, 2, 3], weather.visibility_m: [5000, 23000]}\n'
slip "count out of range" "count: '0' is not a whole number in 1 .. 10000" 'mode: random\ncount: 0\naxes: {seed: [1]}\n'
slip "count without random" 'count: .*applies to `mode: random`' 'count: 3\naxes: {seed: [1]}\n'
slip "a range in a grid" 'slip.yaml:1: seed: only `mode: random` draws' 'axes: {seed: {from: 1, to: 9}}\n'
slip "a range of words" 'is not a number' 'mode: random\ncount: 2\naxes: {sensor.optical: {from: rgb, to: pan}}\n'
slip "a range upside down" 'from is above to' 'mode: random\ncount: 2\naxes: {seed: {from: 9, to: 1}}\n'
slip "too many" 'more than 10000 variants' "axes: {seed: [$(seq -s, 1 101)], weather.pressure_mbar: [$(seq -s, 900 1000)]}\n"
slip "overflow" 'more than 10000 variants' "axes: {$(for k in sensor.width_px sensor.height_px seed radar.bins weather.visibility_m detector.level; do echo "$k: [$(seq -s, 100 2000)],"; done | sed '$d')}\n"
slip "no axes" 'axes: are missing' 'mode: grid\n'
slip "empty axes" 'axes' 'axes:\n'
slip "an empty list" 'empty list' 'axes: {seed: []}\n'
slip "a list of lists" 'needs single values' 'axes: {seed: [[1]]}\n'
slip "not YAML" 'slip.yaml:[12]:' 'axes: {seed: [1\n'
slip "empty" 'expected `axes:`' ''
slip "aliases to itself" 'slip.yaml' 'axes: &a\n  sensor: *a\n'
sweep "$tmp/none.yaml" "$tmp/slip"
check "no such file" [ "$code" != 0 ]
sweep "$tmp/grid.yaml" "$tmp/slip" --host 1:3001:41 --host 1:3001:42
check "several hosts: an axis" complained 'make exercise.host an axis'
sweep "$tmp/same.yaml" "$tmp/odd" --set record.path=$'a\nb'
check "a setting that no file holds: said, not lost" complained 'variant 1, .*its settings cannot be written or read back'
sweep "$tmp/grid.yaml" "$tmp/slip" --memory frames
check "one place for many variants" complained 'publish.memory names one place'
sweep "$tmp/grid.yaml" "$tmp/slip" --coco --no-files
check "what does not go together, in no variant" complained 'publish.coco: needs image files'
# bytes of no sense end in a line, not in a crash (run counts exit codes above 123 as failures)
for seed in 1 2 3 4 5 6; do
    awk -v s=$seed 'BEGIN { srand(s) } { line = $0; for (i = 0; i < 2; i++) { at = int(rand() * (length(line) + 1)); line = substr(line, 1, at) substr("[]{}:,&*-\x27\"%!", int(rand() * 13) + 1, 1) substr(line, at + 2) } print line }' "$tmp/grid.yaml" >"$tmp/noise.yaml"
    "$pitviper" replay "${bare[@]}" "$tmp/none.pcap" --out "$tmp/noise" --sweep "$tmp/noise.yaml" >/dev/null 2>"$tmp/stderr"
    check "noise $seed: refused" [ $? -gt 0 -a $? -lt 124 ]
done
finish
