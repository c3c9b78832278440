#!/usr/bin/env bash
# What truth.jsonl says of who is seen and who is hidden agrees with itself, from the first frame to the impact: an
# occluder is named just where the visible fraction is below 1, a box of visible pixels is there just where there are
# some.
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}")

# seen OUT: a line a target: pixels, visible fraction, box or -, occluder or -
seen() {
    grep -oE '"pixels":[^{]*"amodal_box_px":\[[^]]*\](,"occluded_by":"[^"]*")?' "$1/truth.jsonl" | sed -E '
        s/"amodal_box_px".*"occluded_by":"([^"]*)"/\1/; s/"amodal_box_px":.*/-/
        /"box_px"/!s/,([^,]*)$/,-,\1/; s/"box_px":\[[^]]*\]/box/
        /"visible_fraction"/!s/,/,none,/; s/"(pixels|visible_fraction)"://g; s/,/ /g'
}
exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/out" --bands lwir --no-files --rate 2 --threads 1
seen "$tmp/out" >"$tmp/seen"
check "targets are there" is "$(wc -l <"$tmp/seen")" '>' 40
# from low beside the road, vehicles hide each other
replay "$tmp/demo.pcap" "$tmp/low" --bands lwir --no-files --threads 1 --from +10 --to +20 --host observer --set observer.range_m=200 \
    --set observer.height_m=5 --set exercise.aim=1:3001:22
seen "$tmp/low" >>"$tmp/seen"
check "partly hidden ones are there" [ "$(awk '$2 != "none" && $2 < 1' "$tmp/seen" | wc -l)" -ge 5 ]
check "all of four words" [ -z "$(awk 'NF != 4' "$tmp/seen")" ]
check "no fraction beyond 0 .. 1" [ -z "$(awk '$2 != "none" && !($2 >= 0 && $2 <= 1)' "$tmp/seen")" ]
check "whole, and no occluder named; hidden, and an occluder" \
    [ -z "$(awk '$2 != "none" && ($2 == 1) != ($4 == "-")' "$tmp/seen")" ]
check "nor at two decimals" [ -z "$(awk '$2 != "none" && (sprintf("%.2f", $2) == "1.00") != ($4 == "-")' "$tmp/seen")" ]
check "a box where there are pixels" [ -z "$(awk '($1 > 0) != ($3 == "box")' "$tmp/seen")" ]
check "whole ones are there" [ -n "$(awk '$2 == 1' "$tmp/seen")" ]
check "not sampled: not seen" [ -z "$(awk '$2 == "none" && $1 > 0' "$tmp/seen")" ]
finish
