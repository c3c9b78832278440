#!/usr/bin/env bash
# labels: two
# What is kept between runs (cache.*) changes time alone: the same bits without a cache, from an empty one, a full one and a
# damaged one. test_cache_deep.sh: other plants, two runs at once, folders that cannot be used. tests/base/test_cache.c: every octet
# of an entry.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--only 0 --size 64x48 --no-files --set terrain.woods=on --set terrain.woods_far_m=0)
# invented ground, woods, light of prototypes, and what rays found of it at the finest leaves of 9 kinds, canopy, stands of far woods, warm
# ground, shadows, patches of 4 models
all=20
kept() { find "$XDG_CACHE_HOME/pitviper" -name '*.kept' 2>/dev/null | wc -l; }
# what the last run fetched, made, and found damaged
counts() { cat "$tmp/stdout" "$tmp/stderr" | sed -n 's/.*cache: .*: \([0-9]*\) fetched, \([0-9]*\) made, \([0-9]*\) damaged.*/\1 \2 \3/p'; }

replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}" --set cache.on=off
check "cache.on: off: a frame" [ "$(wc -l <"$tmp/none/truth.jsonl")" = 1 ]
check "and nothing is kept" [ "$(kept)" = 0 ]
replay "$tmp/demo.pcap" "$tmp/cold" "${few[@]}" -v
check "empty: same bits" same_hashes "$tmp/none" "$tmp/cold"
check "all is kept" [ "$(kept)" = $all ]
check "and said to be made" [ "$(counts)" = "0 $all 0" ]
replay "$tmp/demo.pcap" "$tmp/warm" "${few[@]}" -v --threads 1
check "a second run, one thread: same bits" same_hashes "$tmp/none" "$tmp/warm"
check "all is fetched" [ "$(counts)" = "$all 0 0" ]

for entry in "$XDG_CACHE_HOME"/pitviper/*.kept; do printf x | dd of="$entry" bs=1 seek=9000 conv=notrunc status=none; done
replay "$tmp/demo.pcap" "$tmp/damaged" "${few[@]}" -v
check "damaged: same bits" same_hashes "$tmp/none" "$tmp/damaged"
check "said of each" [ "$(counts)" = "0 $all $all" ]
check "with what is done" grep -q "is damaged: what it held is made anew" "$tmp/stderr"
# pages of far plants, as many as rays need
far=(--set terrain.woods_far_m=8000)
replay "$tmp/demo.pcap" "$tmp/far" "${few[@]}" "${far[@]}" -v
made=$(counts)
check "far plants: pages are kept" [ "$(wc -w <<<"$made")" = 3 -a "$(cut -d' ' -f2 <<<"$made")" -ge 4 ]
replay "$tmp/demo.pcap" "$tmp/far_again" "${few[@]}" "${far[@]}" -v --threads 1
check "far plants: all is fetched" [ "$(counts)" = "$(kept) 0 0" ]
check "far plants: same bits" same_hashes "$tmp/far" "$tmp/far_again"
check "far plants: others" not same_hashes "$tmp/far" "$tmp/none"
finish
