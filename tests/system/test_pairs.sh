#!/usr/bin/env bash
# replay --pairs: each frame with and without its target, with and without noise. What can differ between with and without
# is bounded so: of what leaves nothing on the ground and in the air, at night (no sun, no shadow), without contact shadows,
# with one ray a pixel (none that also asks its neighbour's edge), radiance outside the box of all the target's vertices must be
# the same to the bit. And what vehicles leave goes with them: their dust, smoke, shadows and tracks are not in a background,
# which is that of the same exercise without them, to the bit.
. "$(dirname "$0")/common.sh"
judges oiiotool python3.numpy python3.PIL
bare=("${quick[@]}" --set terrain.detail=on)

exercise demo "$tmp/demo.pcap"
few=(--from 1366 --to 1367 --bands optical,lwir,mwir --threads 1)
night=(--set exercise.utc=2026-06-22T08:00:00Z --set sensor.antialias=off --set sensor.sky_visibility=off)
manual=(--set detector.level=manual)
pngs() { (cd "$1" && find . -name '*.png' | sort | xargs sha256sum); }
same_pngs() { pngs "$1" >"$tmp/a"; pngs "$2" >"$tmp/b"; [ -s "$tmp/a" ] && cmp -s "$tmp/a" "$tmp/b"; }

replay "$tmp/demo.pcap" "$tmp/p" "${few[@]}" "${night[@]}" "${manual[@]}" --pairs target
check "a replay with pairs" [ "$code" = 0 ]
replay "$tmp/demo.pcap" "$tmp/plain" "${few[@]}" "${night[@]}" "${manual[@]}"
check "with its target: the planes of a plain replay" same_hashes "$tmp/p" "$tmp/plain"
check "and its pictures" same_pngs "$tmp/p/frames" "$tmp/plain/frames"
check "plain: no pairs" [ ! -e "$tmp/plain/pairs" ]
replay "$tmp/demo.pcap" "$tmp/quiet" "${few[@]}" "${night[@]}" "${manual[@]}" --set detector.noise=0
for band in optical lwir mwir; do
    check "clean: $band of a replay without noise" same_pngs "$tmp/p/pairs/clean/frames/$band" "$tmp/quiet/frames/$band"
done
check "a line a frame" [ "$(wc -l <"$tmp/p/pairs.jsonl")" = 2 ]
check "the seed in each" [ "$(grep -c '"seed":1,' "$tmp/p/pairs.jsonl")" = 2 ]
check "who was taken away" [ "$(grep -c '"removed":\["[0-9:]*"\]' "$tmp/p/pairs.jsonl")" = 2 ]
grep -oE '"(pairs|frames|raw)/[^"]*"' "$tmp/p/pairs.jsonl" | tr -d '"' | sort -u >"$tmp/named"
check "every file named is there" bash -c "cd '$tmp/p' && xargs ls <'$tmp/named' >/dev/null"
check "every picture there is named" [ "$(cd "$tmp/p" && find pairs frames \( -name '*.exr' -o -name '*.png' \) ! -path '*/truth/*.png' | wc -l)" = "$(wc -l <"$tmp/named")" ]

replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" "${night[@]}" "${manual[@]}" --pairs target --threads 2
check "one thread or two: the same pairs" cmp -s "$tmp/one/pairs.jsonl" "$tmp/p/pairs.jsonl"
check "and pictures" same_pngs "$tmp/one" "$tmp/p"

# automatic level, which follows: each member's from its own pictures, begun where the run begins
auto=(--set detector.agc_s=3 --set sensor.preset=staring_lwir,staring_mwir,tv --set sensor.hfov_deg=6)
replay "$tmp/demo.pcap" "$tmp/auto" "${few[@]}" "${auto[@]}" --pairs target
replay "$tmp/demo.pcap" "$tmp/auto_quiet" "${few[@]}" "${auto[@]}" --set detector.noise=0
check "sensors: clean counts are those without noise" same_pngs "$tmp/auto/pairs/clean/raw" "$tmp/auto_quiet/raw"
check "sensors: and their displays" same_pngs "$tmp/auto/pairs/clean/frames/lwir" "$tmp/auto_quiet/frames/lwir"
differ() { ! same_pngs "$@"; }
check "sensors: the background has counts of its own" differ "$tmp/auto/pairs/background/raw" "$tmp/auto/raw"

replay "$tmp/demo.pcap" "$tmp/all" "${few[@]}" "${night[@]}" "${manual[@]}" --pairs all --to 1366
check "all: several are taken away" grep -q '"removed":\["[0-9:]*","[0-9:]*"' "$tmp/all/pairs.jsonl"

cat >"$tmp/compare.py" <<'PY'
import json, math, subprocess, sys
import numpy as np
from PIL import Image
out, planes, kind = sys.argv[1:]
def plane(path, channel): return f"{planes}/{path.replace('/', '_')}.{channel}.tif"
def exr(path, channel): return np.array(Image.open(plane(path, channel)))
def unpack(wanted):  # by one oiiotool, which takes longer to start than to work
    arguments = []
    for path, channel, type in wanted:
        arguments += [f"{out}/{path}", "--ch", channel, "-d", type, "-o", plane(path, channel)]
    subprocess.run(["oiiotool", *arguments], check=True)
def png(path): return np.array(Image.open(f"{out}/{path}")).astype(int)
truths = [json.loads(line) for line in open(f"{out}/truth.jsonl")]
pairs = [json.loads(line) for line in open(f"{out}/pairs.jsonl")]
channels = {"optical": "RGB", "mwir": "Y", "lwir": "Y"}
unpack({(m["truth"], "entity", "uint32") for p in pairs for m in p["members"]} |
       {(m["bands"][b]["radiance"], c, "float") for p in pairs for m in p["members"] for b in channels for c in channels[b]})
changed = 0
for truth, pair in zip(truths, pairs):
    assert truth["frame_sha256"] == pair["frame_sha256"] != pair["background_sha256"], "hashes"
    member = {(m["target"], m["noise"]): m for m in pair["members"]}
    assert len(member) == 4
    here = exr(member[True, True]["truth"], "entity")
    gone = exr(member[False, True]["truth"], "entity")
    outside = np.ones(here.shape, bool)
    for t in truth["targets"]:
        if t["entity"] in pair["removed"]:
            x0, y0, x1, y1 = t["amodal_box_px"]
            outside[max(0, math.floor(y0)):math.ceil(y1), max(0, math.floor(x0)):math.ceil(x1)] = False
    assert outside.any() and (gone[outside] == here[outside]).all(), "truth outside"
    if kind == "all": assert (gone == 0).all(), "somebody is left"
    for band in channels:
        files = {k: m["bands"][band] for k, m in member.items()}
        assert files[True, True]["radiance"] == files[True, False]["radiance"]
        for channel in channels[band]:
            d = (exr(files[True, True]["radiance"], channel) != exr(files[False, True]["radiance"], channel))
            assert not (d & outside).any(), (pair["frame"], band, "radiance outside", int((d & outside).sum()))
            if band == "lwir": changed += int(d.sum())
        for noise in (True, False):  # one noise field: under a fixed level the displays differ nowhere else
            d = png(files[True, noise]["display"]) != png(files[False, noise]["display"])
            d = d.any(axis=2) if d.ndim == 3 else d
            assert not (d & outside).any(), (pair["frame"], band, "display outside", int((d & outside).sum()))
        noisy = png(files[False, True]["display"]) != png(files[False, False]["display"])
        if band == "lwir": assert noisy.any(), "no noise at all"
assert changed > 0, "the target was never seen"
print(changed)
PY
cat >"$tmp/air.yaml" <<'YAML'
duration_s: 3
vehicles:
  - {name: H, id: 11, type: helicopter, engine: false, height_m: 40, route_m: [0, 0]}
  - {name: H, id: 12, type: helicopter, engine: false, height_m: 45, route_m: [25, 12]}
YAML
exercise "$tmp/air.yaml" "$tmp/air.pcap"
air=(--host observer --set exercise.aim=1:3001:11 --from +1 --to +2 --bands optical,lwir,mwir)
replay "$tmp/air.pcap" "$tmp/p" "${air[@]}" "${night[@]}" "${manual[@]}" --pairs target
check "outside the target's box nothing differs" python3 "$tmp/compare.py" "$tmp/p" "$(mktemp -d -p "$tmp")" target
replay "$tmp/air.pcap" "$tmp/all" "${air[@]}" "${night[@]}" "${manual[@]}" --pairs all
check "outside of all boxes nothing differs" python3 "$tmp/compare.py" "$tmp/all" "$(mktemp -d -p "$tmp")" all

# traces: by day, a tank that drives, a truck that stands and smokes; and the same without them. The post in the middle of them all
# gives both the same origin.
cat >"$tmp/bare.yaml" <<'YAML'
duration_s: 75
vehicles:
  - {name: H, id: 11, type: helicopter, engine: false, height_m: 40, route_m: [0, 0]}
  - {name: Post, id: 41, type: truck, engine: false, route_m: [-200, 12]}
YAML
cp "$tmp/bare.yaml" "$tmp/traces.yaml"
cat >>"$tmp/traces.yaml" <<'YAML'
  - {name: Tank, id: 21, type: tank, dust: large, speed_mps: 8, route_m: [[-500, 0], [500, 20]]}
  - {name: Truck, id: 31, type: truck, route_m: [15, 25], heading_deg: 30}
YAML
# ground that does not follow from who stands on it
{ printf 'ncols 300\nnrows 300\nxllcorner -123.015\nyllcorner 35.985\ncellsize 1e-4\n'; yes 120 | head -n 90000; } >"$tmp/flat.asc"
for kind in bare traces; do
    exercise "$tmp/$kind.yaml" "$tmp/$kind.pcap"
    replay "$tmp/$kind.pcap" "$tmp/$kind" --host observer --set exercise.aim=1:3001:11 --from +68 --to +69 --bands optical,lwir \
        --set sensor.hfov_deg=12 --set exercise.utc=2026-06-21T20:00:00Z --set "terrain.elevation=$tmp/flat.asc@ellipsoid@srs=EPSG:4326" \
        --pairs all
    grep -oE '"background_sha256":"[0-9a-f]*"' "$tmp/$kind/pairs.jsonl" >"$tmp/$kind.hashes"
done
check "traces: two backgrounds" [ "$(wc -l <"$tmp/traces.hashes")" = 2 ]
check "traces: they are of the exercise without who made them" cmp -s "$tmp/bare.hashes" "$tmp/traces.hashes"
check "traces: there were some" differ "$tmp/traces/frames/lwir" "$tmp/bare/frames/lwir"

replay "$tmp/demo.pcap" "$tmp/p" "${few[@]}" "${auto[@]}"
check "sensors: with, noisy is a plain replay" same_pngs "$tmp/auto/raw" "$tmp/p/raw"
check "sensors: and its displays" same_pngs "$tmp/auto/frames" "$tmp/p/frames"
check "an earlier run's pairs go" [ ! -e "$tmp/p/pairs" -a ! -e "$tmp/p/pairs.jsonl" ]
replay "$tmp/demo.pcap" "$tmp/bad" --pairs some
check "some: refused" [ "$code" != 0 ]
check "some: what there is" complained "publish.pairs: 'some' is not one of off.target.all"
replay "$tmp/demo.pcap" "$tmp/bad" --pairs all --no-files
check "without files: refused" complained "publish.pairs: needs image files"
run run --out "$tmp/bad" --for 1 --set publish.pairs=all
check "live: refused" complained "publish.pairs: only made by .replay."
finish
