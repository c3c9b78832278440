#!/usr/bin/env bash
# Sensors of etc/sensors.csv through replay: what they add, what they leave alone, and how slips are named.
. "$(dirname "$0")/common.sh"
judges python3

exercise demo "$tmp/demo.pcap"
all=scanning_flir,staring_mwir,tv
small=(--size 64x48 --rate 0.5 --from 1365 --bands optical,mwir,lwir "${coarse[@]}")

files() { find "$1" -name "*.$2" 2>/dev/null | wc -l; }
same_files() { (cd "$1" && find . -name '*.png' | sort | xargs sha256sum) >"$tmp/a"; (cd "$2" && find . -name '*.png' | sort | xargs sha256sum) >"$tmp/b"; [ -s "$tmp/a" ] && cmp -s "$tmp/a" "$tmp/b"; }

run replay "$tmp/demo.pcap" --out "$tmp/none" "${small[@]}" --threads 1
check "no sensor: replay ends well" [ $code -eq 0 ]
check "no sensor: no raw counts" [ ! -e "$tmp/none/raw" ]

run replay "$tmp/demo.pcap" --out "$tmp/all" "${small[@]}" --threads 2 --set sensor.preset=$all --set sensor.hfov_deg=6
check "sensors: replay ends well" [ $code -eq 0 ]
for band in optical mwir lwir; do
    check "$band: raw counts beside each frame" [ "$(files "$tmp/all/raw/$band" png)" = "$(frames "$tmp/all" $band)" ]
    check "$band: a picture beside each frame" [ "$(files "$tmp/all/frames/$band" png)" = "$(frames "$tmp/all" $band)" ]
done
check "its sensor is said, with its key" said 'lwir: scanning_flir, .*NEdT [0-9]+ mK.*sensor.preset'
check "radiance at the aperture knows nothing of the detector" same_hashes "$tmp/none" "$tmp/all"
check "pictures do" test "$(sha256sum <"$tmp/all/frames/lwir/000003.png")" != "$(sha256sum <"$tmp/none/frames/lwir/000003.png")"

run replay "$tmp/demo.pcap" --out "$tmp/one" "${small[@]}" --threads 1 --set sensor.preset=$all --set sensor.hfov_deg=6
check "one thread or two: the same pictures and counts" same_files "$tmp/one" "$tmp/all"

from=$(json_numbers "$tmp/all/truth.jsonl" time_s | sed -n 2p)
run replay "$tmp/demo.pcap" --out "$tmp/part" "${small[@]}" --threads 1 --set sensor.preset=$all --set sensor.hfov_deg=6 --from "$from"
check "begun in the middle: fewer frames" [ "$(files "$tmp/part/raw/lwir" png)" -lt "$(files "$tmp/all/raw/lwir" png)" ]
# counts and truth; a display's automatic level begins with the first frame made (test_level.sh)
for name in $(cd "$tmp/part" && find raw frames/truth -name '*.png'); do
    check "begun in the middle: $name is the same" cmp -s "$tmp/part/$name" "$tmp/all/$name"
done

# a raster and a field of view of its own, where the user has none
run replay "$tmp/demo.pcap" --out "$tmp/own" --only 0 --bands lwir --threads 1 "${coarse[@]}" --set sensor.preset=staring_lwir --set detector.raw=false
check "own raster: replay ends well" [ $code -eq 0 ]
size=$(od -An -tu1 -j16 -N8 "$tmp/own/frames/lwir/000000.png" | tr -s ' ')
check "a picture of 384 x 288" [ "$size" = " 0 0 1 128 0 0 1 32" ]
check "raw=false: no raw counts" [ ! -e "$tmp/own/raw" ]

# counts of a helicopter of 1.5 px that leaves nothing on the ground and in the air: it is where it is in a picture of four
# times as many pixels, not in the middle of a pixel
cat >"$tmp/small.yaml" <<'YAML'
duration_s: 6
vehicles:
  - {name: H, id: 22, type: helicopter, engine: false, height_m: 60, route_m: [0, 0]}
YAML
run exercise "$tmp/small.yaml" -o "$tmp/small.pcap"
near=(--host observer --set exercise.aim=1:3001:22 --set observer.range_m=2800 --set observer.height_m=500
      --set exercise.utc=2026-06-21T20:00:00Z
      --bands lwir --rate 1 --from +1 --to +5 --set sensor.preset=staring_lwir --set sensor.hfov_deg=12
      --set detector.noise=0 --set detector.bad_share=0 --set detector.smear=false --pairs target
      --threads 1 --set models.sag_m=0.02 --set quality.budget=off)
run replay "$tmp/small.pcap" --out "$tmp/coarse" --size 96x64 "${near[@]}"
run replay "$tmp/small.pcap" --out "$tmp/fine" --size 384x256 "${near[@]}"
check "a small target's counts are where it is" python3 - "$tmp/coarse" "$tmp/fine" <<'END'
import json, struct, sys, zlib

def counts(path):
    """Rows of a grey PNG of 16 bits."""
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR": width, height = struct.unpack(">II", data[at + 8:at + 16])
        if kind == b"IDAT": packed += data[at + 8:at + 8 + n]
        at += 12 + n
    raw, step = zlib.decompress(packed), 2 * width
    above, rows = bytes(step), []
    for y in range(height):
        filtered, line = raw[y * (step + 1)], bytearray(raw[y * (step + 1) + 1:(y + 1) * (step + 1)])
        for i in range(step):
            a, b, c = line[i - 2] if i > 1 else 0, above[i], above[i - 2] if i > 1 else 0
            pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            paeth = a if pa <= pb and pa <= pc else b if pb <= pc else c
            line[i] = (line[i] + [0, a, b, (a + b) // 2, paeth][filtered]) & 255
        above = bytes(line)
        rows.append(struct.unpack(">%dH" % width, above))
    return rows

def place(out, frame, scale, box):
    shown, hidden = (counts(f"{out}/pairs/{m}/raw/lwir/{frame:06d}.png") for m in ("clean", "background_clean"))
    total = across = down = 0
    for y in range(box[1] * scale, box[3] * scale):
        for x in range(box[0] * scale, box[2] * scale):
            e = shown[y][x] - hidden[y][x]
            total, across, down = total + e, across + e * (x + 0.5), down + e * (y + 0.5)
    return across / total / scale, down / total / scale

square = n = 0
for line in open(sys.argv[1] + "/truth.jsonl"):
    frame = json.loads(line)
    b = [t for t in frame["targets"] if t["entity"] == "1:3001:22"][0]["amodal_box_px"]
    box = int(b[0]) - 6, int(b[1]) - 6, int(b[2]) + 7, int(b[3]) + 7
    for ours, want in zip(place(sys.argv[1], frame["frame"], 1, box), place(sys.argv[2], frame["frame"], 4, box)):
        square, n = square + (ours - want) ** 2, n + 1
rms = (square / n) ** 0.5
print("off by %.3f px rms of %d" % (rms, n))
sys.exit(not (n == 10 and rms < 0.1))
END

# an earlier run's counts go with it
run replay "$tmp/demo.pcap" --out "$tmp/all" --overwrite "${small[@]}" --threads 1 --only 3
check "cleared" [ ! -e "$tmp/all/raw" ]

slip() { # slip WHAT PATTERN options
    local what=$1 pattern=$2; shift 2
    run replay "$tmp/demo.pcap" --out "$tmp/slip" "${small[@]}" "$@"
    check "$what: refused" [ $code -ne 0 ]
    check "$what: named" complained "$pattern"
    check "$what: before the first frame" [ ! -e "$tmp/slip/frames" ]
}
slip "unknown sensor" "no sensor named 'hubble'; there are: staring_lwir" --set sensor.preset=hubble
slip "two of a band" "staring_lwir and scanning_flir are both for lwir" --set sensor.preset=staring_lwir,scanning_flir
slip "band not shown" "tv is for optical, which sensor.bands does not name" --set sensor.preset=tv --bands lwir
slip "key of no sensor" "detector.f_number: overrides a sensor preset" --set detector.f_number=2
slip "noise beside a sensor's" "detector.netd_lwir_k: the noise of lwir is set by its sensor, staring_lwir" --set sensor.preset=staring_lwir --set detector.netd_lwir_k=0.1
slip "empty list" "is empty" --set sensor.preset=,
slip "out of range" "detector.bad_share: '0.9' is not a number in 0 .. 0.2" --set sensor.preset=tv --set detector.bad_share=0.9
slip "a lens that folds" "is not invertible within" --set sensor.hfov_deg=20 --set sensor.lens_k1=-60
slip "a lens out of range" "sensor.lateral_r: '0.5' is not a number in -0.02 .. 0.02" --set sensor.lateral_r=0.5
slip "no such sheet" "cannot read $tmp/none.sheet" --set sensor.table="$tmp/none.sheet"
sed 's/^f_number .*/f_number 0/' etc/sensors/example_flir2.sheet >"$tmp/bad.sheet"
slip "a sheet's slip" "bad.sheet:[0-9]*: f_number: '0' is not a number in 0.5 .. 100" --set sensor.table="$tmp/bad.sheet"
slip "a sheet beside a preset of its band" "example_flir2 and staring_lwir are both for lwir" --set sensor.table=etc/sensors/example_flir2.sheet --set sensor.preset=staring_lwir

# a lens: truth says which, boxes follow it, any number of threads gives the same; and a sheet is a sensor
# five different coefficients, in the order of OpenCV's distCoeffs: k1, k2, p1, p2, k3
lens=(--set sensor.lens_k1=-6 --set sensor.lens_k2=60 --set sensor.lens_k3=5 --set sensor.lens_p1=0.001 --set sensor.lens_p2=-0.002 --set sensor.lateral_r=0.01 --set sensor.lateral_b=-0.01 --set sensor.hfov_deg=20)
run replay "$tmp/demo.pcap" --out "$tmp/lens" "${small[@]}" --threads 2 "${lens[@]}"
check "a lens: replay ends well" [ $code -eq 0 ]
check "the lens is said" said 'lens: k1=-6 k2=60 .*sensor.lens_k1'
check "and in truth" grep -q '"distortion":\[-6.0,60.0,0.001,-0.002,5.0\]' "$tmp/lens/truth.jsonl"
run replay "$tmp/demo.pcap" --out "$tmp/lens1" "${small[@]}" --threads 1 "${lens[@]}" --no-skip
check "a lens: one thread and nothing skipped, or two and skips" same_hashes "$tmp/lens" "$tmp/lens1"
run replay "$tmp/demo.pcap" --out "$tmp/plain" "${small[@]}" --threads 1 --set sensor.hfov_deg=20 --only 3 --no-files
plain=$(hashes "$tmp/plain" | grep -oE '[0-9a-f]{64}')
check "a lens is no pinhole" [ -n "$plain" -a "$(hashes "$tmp/lens" | grep -c "$plain")" = 0 ]
run replay "$tmp/demo.pcap" --out "$tmp/sheet" --only 0 --size 96x64 --bands lwir --threads 1 "${coarse[@]}" --set sensor.table=etc/sensors/example_flir2.sheet
check "a sheet: replay ends well" [ $code -eq 0 ]
check "a sheet is a sensor" said 'lwir: example_flir2, .*NEdT 50 mK.*sensor.table'
check "of raw counts" [ -e "$tmp/sheet/raw/lwir" ]
finish
