#!/usr/bin/env bash
# replay --sweep: each variant is the run that its settings and the user's options make, what is made is kept, one that fails
# stops no other. Random draws, and files with slips: test_sweep_slips.sh. That no option is lost on the
# way is tests/sensor/test_options.c's.
. "$(dirname "$0")/common.sh"
judges python3.pycocotools

. "$(dirname "$0")/sweep.sh"
# what a picture shows is of no account here: twenty of them are made
few+=(--set models.sag_m=0.1 --set terrain.detail=off --set heat.step_s=3600 --set heat.shadow_m=0 --set quality.budget=off)
folders() { grep -oE '"folder":"v[0-9a-f]{10}"' "$1/manifest.jsonl" | cut -d'"' -f4; }

sweep "$tmp/grid.yaml" "$tmp/g" --coco
check "a grid" [ "$code" = 0 ]
check "four made" [ "$(statuses "$tmp/g")" = ' 4 "status":"made" ' ]
check "the last axis first" grep -q '"number":2,.*"weather.visibility_m":"5000","seed":"2"' <(sed -n 2p "$tmp/g/manifest.jsonl")
check "a page with four pictures, which lie beside it" [ "$(grep -oE 'src="v[0-9a-f]{10}/thumbnail.png"' "$tmp/g/manifest.html" | cut -d'"' -f2 | (cd "$tmp/g" && xargs ls) | wc -l)" = 4 ]
check "of both manifests less than 1 kB a variant, but for the page's head" [ "$(cat "$tmp/g/manifest.jsonl" <(grep '<figure>' "$tmp/g/manifest.html") | wc -c)" -lt 4000 ]
second=$(folders "$tmp/g" | sed -n 2p)
replay "$tmp/demo.pcap" "$tmp/direct" "${few[@]}" --set weather.visibility_m=5000 --seed 2 --set sensor.hfov_deg=5 --coco
check "its coco.json too" cmp -s "$tmp/direct/coco.json" "$tmp/g/$second/coco.json"
check "a variant is the run of its settings" same_hashes "$tmp/direct" "$tmp/g/$second"
check "with their hash" [ "$(json_numbers "$tmp/direct/run.json" seed)" = 2 -a "$(grep config_sha256 "$tmp/direct/run.json")" = "$(grep config_sha256 "$tmp/g/$second/run.json")" ]
check "which the manifest has" grep -qF "$(grep -oE '[0-9a-f]{64}' <(hashes "$tmp/direct") | head -n 1)" <(sed -n 2p "$tmp/g/manifest.jsonl")
"$pitviper" replay "$tmp/demo.pcap" -c "$tmp/g/$second/settings.yaml" --out "$tmp/again" >/dev/null 2>&1
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
sweep "$tmp/grid.yaml" "$tmp/g" --coco --threads 2
check "goes on" [ "$(statuses "$tmp/g")" = ' 2 "status":"kept" 2 "status":"made" ' ]
check "to the same bits" [ "$before" = "$(hashes "$tmp/g/$second")" ]
check "coco.json too" cmp -s "$tmp/coco.before" "$tmp/g/coco.json"
printf 'axes: {seed: [3, 2, 1], weather.visibility_m: 5000, sensor.hfov_deg: 5}\n' >"$tmp/wider.yaml"
sweep "$tmp/wider.yaml" "$tmp/g" --coco
check "wider: coco.json has them all" merged "$tmp/g" 3
check "an axis grows: what was made is kept" [ "$(statuses "$tmp/g")" = ' 2 "status":"kept" 1 "status":"made" ' ]
run replay "$tmp/demo.pcap" --out "$tmp/g" --rate 1 "${few[@]}" --sweep "$tmp/grid.yaml" --to 1367
check "another span: what is there is kept" [ "$code $(statuses "$tmp/g")" = '1  2 "status":"kept" 1 "status":"made" ' ]
sed 's/\[5000, 23000\]/5000/; s/\[1, 2\]/2/' "$tmp/grid.yaml" >"$tmp/one.yaml" # of those
sweep "$tmp/one.yaml" "$tmp/g" --to 1367
check "another span: nothing is kept" [ "$(statuses "$tmp/g")" = ' 1 "status":"made" ' ]
check "without --coco: none, and none of before" [ -z "$(find "$tmp/g" -maxdepth 1 -name 'coco.json*')" ]

# one that fails
printf 'axes:\n  exercise.host: ["9:9:9", ""]\n' >"$tmp/fails.yaml"
sweep "$tmp/fails.yaml" "$tmp/f" --set publish.files=false
check "one fails: exit code" [ "$code" = 1 ]
check "one fails: the other is made" [ "$(statuses "$tmp/f")" = ' 1 "status":"failed" 1 "status":"made" ' ]
check "one fails: said why, in one line" [ "$(grep -c 'variant 1, v[0-9a-f]*, exercise.host=9:9:9: .*9:9:9' "$tmp/stderr")" = 1 ]
sweep "$tmp/fails.yaml" "$tmp/f" --set publish.files=false
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

finish
