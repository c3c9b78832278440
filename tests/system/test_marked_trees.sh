#!/usr/bin/env bash
# Trees of a table stand where it says, without any building; a trunk's painted ring is seen in its colour from 1.0 to 1.6 m over the
# foot, in the plane of materials and in the heat, and nowhere else. An independent reader measures it in pixels.
. "$(dirname "$0")/common.sh"
judges python3.OpenEXR python3.numpy
bare=(--set heat.facets=3 --set heat.step_s=1800 --set heat.shadow_m=0 --set heat.vehicle_step_s=600 --set terrain.detail=off)
cat >"$tmp/marked.yaml" <<'Y'
seed: 3
duration_s: 12
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
vehicles:
  - {name: Tank, id: 11, type: tank, route_m: [[0, 0]]}
Y
# metres east and north of the tank; a degree of 50.1 north is 111230 m of latitude and 71550 m of longitude
awk 'BEGIN {
    print "lat,lon,kind,height_m,marked"
    n = split("-7.5 -6 white|-4 -6 red|4 -6 green|7.5 -6 blue|-11 -6 no|11 -6 ", tree, "|")
    for (i = 1; i <= n; i++) { split(tree[i], p, " "); printf "%.8f,%.8f,pine,22,%s\n", 50.1 + p[2] / 111230, 8.6 + p[1] / 71550, p[3] }
}' >"$tmp/trees.csv"
exercise "$tmp/marked.yaml" "$tmp/marked.pcap"
look=(--size 400x240 --from +2 --to +2 --bands optical,lwir --set exercise.host=observer --set exercise.aim=1:3001:11 --set observer.range_m=120
    --set observer.height_m=20 --set observer.rate_dps=0 --set sensor.hfov_deg=12 --set terrain.woods_half_m=60 --set terrain.woods_trees=400)
replay "$tmp/marked.pcap" "$tmp/o" "${look[@]}" --set terrain.trees="$tmp/trees.csv"
check "a replay with trees of a table" [ "$code" = 0 ]
check "run.json has how many are marked" grep -q '"marked":4,' <<<"$(run_json "$tmp/o")"
cat >"$tmp/judge.py" <<'PY'
import json, sys
import numpy as np, OpenEXR
out, want = sys.argv[1], sys.argv[2] == "marked"
truth = OpenEXR.File(out + "/frames/truth/000002.exr")
names = truth.header()["material_names"].split(",")
material, instance, range_m, temp_k = (truth.channels()[k].pixels for k in ("material", "instance", "range_m", "temp_k"))
rgb = OpenEXR.File(out + "/frames/optical/000002.exr").channels()["RGB"].pixels
px_m = lambda where: range_m[where].mean() * 12 * np.pi / 180 / 400
marks = {k: material == names.index("paint_%s_wood" % k) + 1 for k in ("white", "red", "green", "blue")}
if not want:
    assert not any(m.any() for m in marks.values()), "paint where nothing is marked"
    sys.exit()
bark = material == names.index("bark_pine") + 1
trees, colours, feet = set(), {}, 0
for name, mark in marks.items():
    assert mark.sum() > 40, (name, mark.sum())
    tree = np.unique(instance[mark])
    assert len(tree) == 1 and tree[0] not in trees, (name, tree)  # one trunk each, with its own number
    trees.add(tree[0])
    columns = np.unique(np.nonzero(mark)[1])
    middle = int(np.median(columns))
    rows, own = np.nonzero(mark[:, middle])[0], np.nonzero((instance[:, middle] == tree[0]))[0]
    per = px_m(mark)
    high, low = (own.max() - rows.min() + 1) * per, (own.max() - rows.max()) * per
    # the foot is a pixel's edge; the trunk leans within 15 degrees, the eye looks down by 9.5
    assert abs(high - low - 0.6) < 2 * per, (name, high, low)
    if instance[own.max() + 1, middle] == 0:  # the foot is not behind a bush
        feet += 1
        assert abs(high - 1.6) < 0.16 and abs(low - 1.0) < 0.16, (name, high, low)
    above = bark & (instance == tree[0]) & (np.arange(len(rgb))[:, None] < rows.min()) & (np.arange(len(rgb))[:, None] > rows.min() - 20)
    colours[name] = rgb[mark].mean(axis=0) / rgb[above].mean(axis=0)  # over the bark beside it, in the same light
    assert np.isfinite(temp_k[mark]).all() and abs(temp_k[mark].mean() - temp_k[above].mean()) < 15, name
assert feet >= 2, feet
white, red, green, blue = (colours[k] for k in ("white", "red", "green", "blue"))
print({k: v.round(2).tolist() for k, v in colours.items()})
assert white.min() > 2.5 and white.max() < 12
assert red[0] > 2.5 * red[1] / (white[1] / white[0]) and red[0] > red[2]
assert green[1] / green[0] > 1.5 * red[1] / red[0] and blue[2] / blue[0] > 1.5 * red[2] / red[0]
# the white ring is the warmest reflector, and no warmer than the dark ones in the sun
assert temp_k[marks["white"]].mean() < temp_k[marks["red"]].mean() - 1
PY
check "rings of their colour and height" python3 "$tmp/judge.py" "$tmp/o" marked
sed 's/,[a-z]*$/,no/; 1s/.*/lat,lon,kind,height_m,marked/' "$tmp/trees.csv" >"$tmp/plain.csv"
replay "$tmp/marked.pcap" "$tmp/p" "${look[@]}" --set terrain.trees="$tmp/plain.csv"
check "none where no trunk is marked" python3 "$tmp/judge.py" "$tmp/p" plain
check "the judge sees that there is none" not python3 "$tmp/judge.py" "$tmp/p" marked 2>/dev/null
sed 's/,red$/,pink/' "$tmp/trees.csv" >"$tmp/pink.csv"
replay "$tmp/marked.pcap" "$tmp/q" "${look[@]}" --set terrain.trees="$tmp/pink.csv"
check "another colour is refused" complained 'no, yes \(white\), white, red, green or blue'
finish
