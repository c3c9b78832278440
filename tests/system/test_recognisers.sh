#!/usr/bin/env bash
# The recognisers of etc/examples: images made by hand, with targets that are known; and a run's files, whose answers
# `pitviper score` takes. labels: small
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.PIL

check "images made by hand" python3 tests/system/recognisers.py

exercise demo "$tmp/demo.pcap"
run replay "$tmp/demo.pcap" --out "$tmp/run" --size 96x64 --bands lwir,mwir --set sensor.preset=staring_lwir,staring_mwir --rate 0.5 \
    --from +14 --to +18 --planes none "${coarse[@]}"
check "a run to answer" [ "$code" = 0 ]
cp -r "$tmp/run" "$tmp/seen"
rm "$tmp/seen/truth.jsonl" # nothing of it is needed
for name in hottest contrast shape; do
    check "$name: answers it" eval 'python3 etc/examples/recognise_$name.py "$tmp/seen" --answers "$tmp/$name.jsonl" >"$tmp/said"'
    check "$name: every frame" eval '[ "$(grep -oE "\"frame\": [0-9]+" "$tmp/$name.jsonl" | sort -u | wc -l)" = "$(ls "$tmp/run/raw/lwir" | wc -l)" ]'
done
run score "$tmp/run" "$tmp/hottest.jsonl" "$tmp/contrast.jsonl" "$tmp/shape.jsonl"
check "score takes them" [ "$code" = 0 ]
check "each frame of each is answered" [ "$(grep -cE '([0-9]+) of \1 frames and bands answered' "$tmp/stdout")" = 3 ]
python3 etc/examples/recognise_shape.py "$tmp/seen" --bands lwir,optical >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a band that is not there: an error" eval '[ $code = 1 ] && complained "no images of optical"'
python3 etc/examples/recognise_hottest.py "$tmp/none" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a folder that is not there, too" eval '[ $code = 1 ] && complained "recognise_hottest.py: .*run.json"'
python3 etc/examples/recognise_hottest.py >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "neither a folder nor a ring: an error" eval '[ $code = 2 ] && complained "expected OUT, or --memory NAME"'
finish
