#!/usr/bin/env bash
# labels: two deep
# What is kept between runs (cache.*), beyond test_cache.sh: other plants beside those kept, two runs at once which find damage, and
# folders that cannot be used. The same bits each time.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--only 0 --size 64x48 --no-files --set terrain.woods=on)
kept() { find "$XDG_CACHE_HOME/pitviper" -name '*.kept' 2>/dev/null | wc -l; }
# what the last run fetched, made, and found damaged
counts() { cat "$tmp/stdout" "$tmp/stderr" | sed -n 's/.*cache: .*: \([0-9]*\) fetched, \([0-9]*\) made, \([0-9]*\) damaged.*/\1 \2 \3/p'; }

replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}" --set cache.on=off
replay "$tmp/demo.pcap" "$tmp/cold" "${few[@]}"

all=11 # as test_cache.sh lists them
# another seed has other ground and woods; prototypes, stands of far woods, warm ground and patches are the same
replay "$tmp/demo.pcap" "$tmp/seed" "${few[@]}" -v --seed 2
check "another seed: ground, woods, canopy and shadows alone are made" [ "$(counts)" = "7 4 0" ]
replay "$tmp/demo.pcap" "$tmp/seed_none" "${few[@]}" --seed 2 --set cache.on=off
check "and has its own bits" same_hashes "$tmp/seed" "$tmp/seed_none"
check "which are others" not same_hashes "$tmp/seed" "$tmp/none"

# bare trees are other prototypes, which let more light through: each way beside entries of the other
replay "$tmp/demo.pcap" "$tmp/bare" "${few[@]}" -v --set terrain.woods_leaves=off
check "bare trees: what has leaves is made" [ "$(counts)" = "6 5 0" ]
replay "$tmp/demo.pcap" "$tmp/bare_none" "${few[@]}" --set terrain.woods_leaves=off --set cache.on=off
check "and their own bits" same_hashes "$tmp/bare" "$tmp/bare_none"
check "which are others" not same_hashes "$tmp/bare" "$tmp/none"

# a bit of every entry; then two runs at once, which mend them
for entry in "$XDG_CACHE_HOME"/pitviper/*.kept; do printf x | dd of="$entry" bs=1 seek=9000 conv=notrunc status=none; done
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/at_once" "${few[@]}" >/dev/null 2>"$tmp/other_said" &
other=$!
replay "$tmp/demo.pcap" "$tmp/damaged" "${few[@]}"
wait "$other"
check "damaged: same bits" same_hashes "$tmp/none" "$tmp/damaged"
check "beside another run: same bits" same_hashes "$tmp/none" "$tmp/at_once"
check "and said, by the one that found it" grep -q "is damaged: what it held is made anew" "$tmp/stderr" "$tmp/other_said"
replay "$tmp/demo.pcap" "$tmp/mended" "${few[@]}" -v
check "mended" [ "$(counts)" = "$all 0 0" ]
check "same bits" same_hashes "$tmp/none" "$tmp/mended"

replay "$tmp/demo.pcap" "$tmp/unusable" "${few[@]}" --set cache.folder="$tmp/demo.pcap/below"
check "a folder that cannot be made: same bits" same_hashes "$tmp/none" "$tmp/unusable"
check "said once, with what to do" [ "$(grep -c 'cannot be made.*cache.folder' "$tmp/stderr")" = 1 ]
finish
