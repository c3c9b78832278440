#!/usr/bin/env bash
# Plants in a replay: the same planes to the bit for any number of threads, with every skip or none, causal as known; the
# truth, run.json and a frame file of them; and what they change.
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}" --set heat.shadow_m=64) # plants cast shadows that cool the ground

exercise demo "$tmp/demo.pcap"
few=(--from 1366 --to 1367 --no-png --size 64x48 --planes range,entity,instance,cover)
woods=(--set terrain.woods=on --set terrain.woods_half_m=800 --set terrain.woods_trees=6000)
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" "${woods[@]}" --threads 1 --save-frame 4
check "a replay" [ "$code" = 0 ] || cat "$tmp/stderr"
check "it says what stands there" said '^woods: [0-9]+ trees \(.*terrain\.woods'
check "it says what is cleared" said '^woods: cleared along the paths of 5 entities'
check "it says what the ground shows where trees are left out" said '^woods: [0-9]+ more are left out, .*: the ground there shows their canopy'
check "two frames" [ "$(frames "$tmp/one")" = 2 ]
check "their planes" [ -z "$(find "$tmp/one/frames/truth" -name '*.exr' -size -2k)" ]

replay "$tmp/demo.pcap" "$tmp/two" "${few[@]}" "${woods[@]}" --threads 2 --no-skip
check "2 threads, no skips: same bits" same_hashes "$tmp/one" "$tmp/two"

# numbers of run.json add up, and say what the settings allow
plants=$(json_numbers "$tmp/one/run.json" plants)
check "run.json: plants" is "$plants" '>' 1000
trees=0
for kind in pine alder birch english_oak sessile_oak red_oak white_oak; do
    trees=$((trees + $(json_numbers "$tmp/one/run.json" $kind)))
done
check "run.json: trees within the limit" is $trees '<=' 6000
check "run.json: kinds add up" [ $((trees + $(json_numbers "$tmp/one/run.json" bush) + $(json_numbers "$tmp/one/run.json" hedge))) = "$plants" ]
check "run.json: no entity begins in a trunk" [ "$(json_numbers "$tmp/one/run.json" in_trunks)" = 0 ]
check "run.json: some ways are cleared" is "$(json_numbers "$tmp/one/run.json" paths)" '>' 0

# truth: each target that has a visible fraction has one of foliage; both together are a whole at most
check "truth: foliage" [ "$(grep -o '"foliage_fraction"' "$tmp/one/truth.jsonl" | wc -l)" = "$(grep -o '"visible_fraction"' "$tmp/one/truth.jsonl" | wc -l)" ]
check "truth: of targets" [ "$(grep -o '"foliage_fraction"' "$tmp/one/truth.jsonl" | wc -l)" -ge 2 ]

# the frame by itself, with its plants grown again
mv "$tmp/one/frame_000004.pvf" "$tmp/saved.pvf"
run frame "$tmp/saved.pvf" --threads 2
check "a saved frame: the same" [ "$code" = 0 ]
check "a saved frame: all planes" said 'the same: all [0-9]+ planes, to the bit'

# the twins: without plants, others, and fewer
replay "$tmp/demo.pcap" "$tmp/bare" --from 1366 --to 1367 --no-png --size 64x48 --threads 1
check "without plants: other bits" not same_hashes "$tmp/one" "$tmp/bare"
check "without plants: nothing of them" not grep -qE 'foliage|"woods":' "$tmp/bare/truth.jsonl" "$tmp/bare/run.json"
replay "$tmp/demo.pcap" "$tmp/seed" "${few[@]}" "${woods[@]}" --threads 1 --seed 2
check "another seed, other bits" not same_hashes "$tmp/one" "$tmp/seed"
replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}" "${woods[@]}" --bands lwir --threads 1 --set terrain.woods_trees=0
check "no trees: said" said '^woods: 0 trees'
run replay "$tmp/demo.pcap" --out "$tmp/no" --planes instance
check "planes of plants without plants: refused" [ "$code" != 0 ]
check "planes of plants without plants: said" complained 'terrain\.woods'

# what is known at the beginning of a causal run is what is cleared
replay "$tmp/demo.pcap" "$tmp/causal" "${few[@]}" "${woods[@]}" --causal --host 1:3001:41
check "causal" [ "$code" = 0 ] || cat "$tmp/stderr"
replay "$tmp/demo.pcap" "$tmp/causal2" "${few[@]}" "${woods[@]}" --causal --host 1:3001:41 --threads 1
check "causal: 2 threads, same bits" same_hashes "$tmp/causal" "$tmp/causal2"
finish
