#!/usr/bin/env bash
# Sensors of etc/sensors.csv through replay: what they add, what they leave alone, and how slips are named. labels: small
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
all=scanning_flir,staring_mwir,tv
small=(--size 96x64 --rate 1 --bands optical,mwir,lwir)

files() { find "$1" -name "*.$2" 2>/dev/null | wc -l; }
same_files() { (cd "$1" && find . -name '*.png' | sort | xargs sha256sum) >"$tmp/a"; (cd "$2" && find . -name '*.png' | sort | xargs sha256sum) >"$tmp/b"; [ -s "$tmp/a" ] && cmp -s "$tmp/a" "$tmp/b"; }

run replay "$tmp/demo.pcap" --out "$tmp/none" "${small[@]}" --threads 2
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

from=$(json_numbers "$tmp/all/truth.jsonl" time_s | sed -n 5p)
run replay "$tmp/demo.pcap" --out "$tmp/part" "${small[@]}" --threads 2 --set sensor.preset=$all --set sensor.hfov_deg=6 --from "$from"
check "begun in the middle: fewer frames" [ "$(files "$tmp/part/raw/lwir" png)" -lt "$(files "$tmp/all/raw/lwir" png)" ]
# counts and truth; a display's automatic level begins with the first frame made (test_level.sh)
for name in $(cd "$tmp/part" && find raw frames/truth -name '*.png'); do
    check "begun in the middle: $name is the same" cmp -s "$tmp/part/$name" "$tmp/all/$name"
done

# a raster and a field of view of its own, where the user has none
run replay "$tmp/demo.pcap" --out "$tmp/own" --rate 0.2 --bands lwir --set sensor.preset=staring_lwir --set detector.raw=false
check "own raster: replay ends well" [ $code -eq 0 ]
size=$(od -An -tu1 -j16 -N8 "$tmp/own/frames/lwir/000000.png" | tr -s ' ')
check "a picture of 384 x 288" [ "$size" = " 0 0 1 128 0 0 1 32" ]
check "raw=false: no raw counts" [ ! -e "$tmp/own/raw" ]

# an earlier run's counts go with it
run replay "$tmp/demo.pcap" --out "$tmp/all" "${small[@]}" --threads 2
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
slip "key of no sensor" "detector.f_number: needs a sensor" --set detector.f_number=2
slip "noise beside a sensor's" "detector.netd_lwir_k: the noise of lwir is that of its sensor, staring_lwir" --set sensor.preset=staring_lwir --set detector.netd_lwir_k=0.1
slip "empty list" "names no sensor" --set sensor.preset=,
slip "out of range" "detector.bad_share: '0.9' is not a number in 0 .. 0.2" --set sensor.preset=tv --set detector.bad_share=0.9
finish
