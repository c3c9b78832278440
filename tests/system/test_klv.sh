#!/usr/bin/env bash
# Metadata packets as readers that are not ours see them (klv_decode.py): any frame record gives a packet that they
# accept; pose and targets are those of truth.jsonl; frame centre and corners lie on the ground of the elevation file.
# labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
here=$(dirname "$0")
data=${PITVIPER_DATA:-../shared/data}

# no octet beyond the packet, the same packet twice, no refusal but of times before 1970 or after 2200
"$build/tests/klv_packets" 1000 2 >"$tmp/any.klv" 2>"$tmp/stderr"
check "packets of any record: $(cat "$tmp/stderr")" [ $? = 0 ]
"$build/tests/klv_packets" 30 1 >"$tmp/any.klv" 2>/dev/null
command -v python3 >/dev/null || { echo "skipped in part: no python3"; finish; }
python3 "$here/klv_decode.py" "$tmp/any.klv" >"$tmp/any.json" 2>"$tmp/stderr"
code=$?
if [ $code = 77 ]; then
    echo "skipped in part: no klvdata, stanag4609 or tstrans for python3 (PyPI)"
    finish
fi
check "readers accept them: $(tail -n 1 "$tmp/stderr" | cut -c 1-300)" [ $code = 0 ]
check "most of them are there" [ "$(wc -l <"$tmp/any.json")" -gt 20 ]

exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/missile" --size 63x47 --rate 0.3 --samples 1 --bands lwir --no-files \
    --set publish.klv_files=true --set publish.vmti=truth
check "a replay writes metadata" [ "$code" = 0 ]
judged=(pose "$tmp/missile")
free_port
python3 "$here/klv_test.py" send $port "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/atr" --size 32x24 --rate 5 \
    --from 1362 --to 1365 --speed 3 --samples 1 --bands lwir --threads 1 --no-files --set publish.klv_files=true \
    --set publish.detections_port=$port >"$tmp/stdout" 2>"$tmp/stderr"
check "a replay with a recogniser" [ $? = 0 ]
judged+=(atr "$tmp/atr")
if [ -r "$data/klv/st0903-jmisb.bin" ]; then
    judged+=(samples "$data/klv")
else
    echo "skipped in part: no reference data at $data/klv (set PITVIPER_DATA)"
fi
tif=$data/terrain/autzen/autzen_dtm_1m.tif
if [ -r "$tif" ]; then
    exercise demo "$tmp/real.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 place.height_m=106
    # --pairs all: a range plane of the ground alone
    replay "$tmp/real.pcap" "$tmp/real" --set "terrain.elevation=$(realpath "$tif")" --host observer --rate 0.05 \
        --size 63x47 --samples 1 --bands lwir --no-png --pairs all --set publish.klv_files=true --set publish.planes=range \
        --set observer.range_m=2600 --set observer.height_m=1500
    check "a replay over real ground" [ "$code" = 0 ]
    judged+=(ground "$tmp/real" "$tif" EPSG:26910+5773)
else
    echo "skipped in part: no reference data at $tif (set PITVIPER_DATA)"
fi
python3 "$here/klv_test.py" "${judged[@]}" >"$tmp/said" 2>&1
code=$?
grep -E 'FAILED|skipped|frames:' "$tmp/said"
check "what is in them: $(grep -E 'Error' "$tmp/said" | tail -n 1)" [ $code = 0 -o $code = 77 ]
finish
