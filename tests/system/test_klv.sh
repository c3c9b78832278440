#!/usr/bin/env bash
# Metadata packets as readers that are not ours see them (klv_decode.py): any frame record gives a packet that they
# accept; pose and targets are those of truth.jsonl; answers of a recogniser, in three forms. Over real ground: test_klv_ground.sh. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
here=$(dirname "$0")
judges python3.klvdata python3.stanag4609 python3.tstrans

# no octet beyond the packet, the same packet twice, no refusal but of times before 1970 or after 2200
"$build/tests/klv_packets" 1000 2 >"$tmp/any.klv" 2>"$tmp/stderr"
check "packets of any record: $(cat "$tmp/stderr")" [ $? = 0 ]
"$build/tests/klv_packets" 30 1 >"$tmp/any.klv" 2>/dev/null
python3 "$here/klv_decode.py" "$tmp/any.klv" >"$tmp/any.json" 2>"$tmp/stderr"
check "readers accept them: $(tail -n 1 "$tmp/stderr" | cut -c 1-300)" [ $? = 0 ]
check "most of them are there" [ "$(wc -l <"$tmp/any.json")" -gt 20 ]

exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/missile" --size 63x47 --rate 0.3 --samples 1 --bands lwir --no-files \
    --set publish.klv_files=true --set publish.vmti=truth
check "a replay writes metadata" [ "$code" = 0 ]
answered() { # answered VERB FROM OUT: a replay with a recogniser, which answers as that verb has it
    free_port
    python3 "$here/klv_test.py" "$1" $port "$tmp/$2" "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/$3" --size 32x24 --rate 5 \
        --from 1362 --to 1365 --speed 3 --samples 1 --bands lwir --threads 1 --no-files --set publish.klv_files=true \
        --set sensor.lens_k1=-20 --set publish.detections_port=$port >"$tmp/stdout" 2>"$tmp/stderr"
    check "a replay with a recogniser: $1" [ $? = 0 ]
}
answered send atr atr
python3 "$here/klv_test.py" pose "$tmp/missile" atr "$tmp/atr" || fail "what is in them"
answered again atr other
python3 "$here/klv_test.py" same "$tmp/atr" "$tmp/other" || fail "answers sent back"

# twins: truth that says something else of the pose, the field of view, a box, a distance
cp -r "$tmp/missile" "$tmp/spoilt"
while read -r what change; do
    sed "$change" "$tmp/missile/truth.jsonl" >"$tmp/spoilt/truth.jsonl"
    python3 "$here/klv_test.py" pose "$tmp/spoilt" >"$tmp/said" 2>&1
    check "twin, $what: noticed" grep -q "^FAILED: $what" "$tmp/said"
done <<'SPOILT'
sensor.position s/"ecef_m":\[\([-0-9]*\)/"ecef_m":[\11/
horizontal.field s/"hfov_deg":/&1/
VMTI:.box s/"box_px":\[/&1/
VMTI:.distance s/"range_m":/&1/
SPOILT
finish
