#!/usr/bin/env bash
# replay --coco: boxes are those of truth.jsonl, masks the pixels of the truth picture, read back by others' readers:
# pycocotools where it is there, and a decoder of run lengths written here. labels: small
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--from 1364 --to 1368 --bands optical,lwir)
replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}" --coco
check "a replay" [ "$code" = 0 ]
check "coco.json" [ -s "$tmp/c/coco.json" ]
check "no parts are left" [ -z "$(find "$tmp/c" -name '*.part')" ]
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --coco --threads 1
check "one thread or two: the same bytes" cmp -s "$tmp/one/coco.json" "$tmp/c/coco.json"
# very near: boxes that fill the picture's height, and are cut by its edges
replay "$tmp/demo.pcap" "$tmp/near" --bands lwir --rate 5 --from 1368 --to 1371 --set sensor.hfov_deg=1 --coco
replay "$tmp/demo.pcap" "$tmp/exr" --bands lwir --from 1368 --to 1368 --no-png --coco
check "no displays: the radiance is named" grep -q '"file_name":"frames/lwir/[0-9]*.exr"' "$tmp/exr/coco.json"

if python3 -c 'import numpy, PIL' 2>/dev/null && command -v oiiotool >/dev/null; then
    cat >"$tmp/check.py" <<'PY'
import json, os, subprocess, sys
import numpy as np
from PIL import Image
out = sys.argv[1]
coco = json.load(open(f"{out}/coco.json"))
truth = {t["frame"]: t for t in map(json.loads, open(f"{out}/truth.jsonl"))}
images = {i["id"]: i for i in coco["images"]}
assert len(images) == len(coco["images"]) == sum(len(t["sensors"][0]["bands"]) for t in truth.values()), "images"
assert len({a["id"] for a in coco["annotations"]}) == len(coco["annotations"]) > 0, "annotations"
names = {c["id"]: c["name"] for c in coco["categories"]}
assert len(names) == len(coco["categories"])
for i in images.values(): assert os.path.exists(f"{out}/{i['file_name']}"), i["file_name"]
planes = {}
def plane(frame):
    if frame not in planes:
        path = f"{out}/frames/truth/{frame:06d}.exr"
        subprocess.run(["oiiotool", path, "--ch", "entity", "-d", "uint32", "-o", f"{out}/x.tif"], check=True)
        info = subprocess.run(["oiiotool", "--info", "-v", path], check=True, capture_output=True, text=True).stdout
        ids = [l for l in info.splitlines() if "entity_ids" in l][0].split('"')[1].split(",")
        planes[frame] = np.array(Image.open(f"{out}/x.tif")), ids
    return planes[frame]
seen, cut, tall = {}, 0, 0
for a in coco["annotations"]:
    image = images[a["image_id"]]
    frame = image["frame"]
    target = [t for t in truth[frame]["targets"] if t["entity"] == a["entity"]][0]
    x, y, w, h = a["bbox"]
    assert [x, y, x + w, y + h] == target["box_px"], (frame, a["bbox"], target["box_px"])
    assert a["area"] == target["pixels"] and a["iscrowd"] == 0 and names[a["category_id"]] == target["model"]
    assert a["range_m"] == target["range_m"] and a["visible_fraction"] == target["visible_fraction"]
    rows, columns = a["segmentation"]["size"]
    assert (columns, rows) == (image["width"], image["height"])
    counts = a["segmentation"]["counts"]
    assert sum(counts) == rows * columns and all(c > 0 for c in counts[1:]), "runs"
    bits = np.repeat(np.arange(len(counts)) % 2, counts).reshape(columns, rows).T
    entity, ids = plane(frame)
    assert (bits == (entity == ids.index(a["entity"]) + 1)).all(), (frame, a["entity"], "mask")
    seen.setdefault((frame, image["band"]), set()).add(a["entity"])
    cut += x + w == columns or x == 0
    tall += y == 0 and y + h == rows
for t in truth.values():  # whoever has a box, and nobody else
    for band in t["sensors"][0]["bands"]:
        want = {k["entity"] for k in t["targets"] if "box_px" in k}
        assert seen.get((t["frame"], band), set()) == want, (t["frame"], band)
print(len(coco["annotations"]), "annotations,", cut, "cut,", tall, "from top to bottom")
try:
    from pycocotools.coco import COCO
except ImportError:
    sys.exit(0)
c = COCO(f"{out}/coco.json")
for a in c.loadAnns(c.getAnnIds()):
    entity, ids = plane(images[a["image_id"]]["frame"])
    assert (c.annToMask(a) == (entity == ids.index(a["entity"]) + 1)).all()
print("and pycocotools agrees")
PY
    check "boxes and masks are the truth's" python3 "$tmp/check.py" "$tmp/c"
    check "near, and cut by the edges" python3 "$tmp/check.py" "$tmp/near"
else
    echo "skipped in part: no python3 with numpy and PIL, or no oiiotool"
fi

# whole or not at all
if [ -w /dev/full ]; then
    mkdir -p "$tmp/full" && ln -sf /dev/full "$tmp/full/coco.json.part"
    replay "$tmp/demo.pcap" "$tmp/full" "${few[@]}" --coco
    check "a full disk: exit code" [ "$code" = 1 ]
    check "a full disk: said" complained "coco: cannot write .*coco.json: No space"
    check "a full disk: nothing half" [ ! -e "$tmp/full/coco.json" ]
fi
replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}"
check "an earlier run's coco.json goes" [ ! -e "$tmp/c/coco.json" ]
replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}" --coco --no-files
check "without files: refused" complained "publish.coco: needs pictures in files"
finish
