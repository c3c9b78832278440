#!/usr/bin/env bash
# labels: two deep
# What is kept between runs (cache.*), beyond test_cache.sh: other plants beside those kept, two runs at once which find damage, and
# folders that cannot be used; another build; frame, explain, a radar and regress, cold and warm; killed runs; a small cache; no more
# room on the disk and a disk that cannot be written, where mounts can be made. The same bits each time.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--only 0 --size 64x48 --no-files --set terrain.woods=on --set terrain.woods_far_m=0)
kept() { find "$XDG_CACHE_HOME/pitviper" -name '*.kept' 2>/dev/null | wc -l; }
# what the last run fetched, made, and found damaged
counts() { cat "$tmp/stdout" "$tmp/stderr" | sed -n 's/.*cache: .*: \([0-9]*\) fetched, \([0-9]*\) made, \([0-9]*\) damaged.*/\1 \2 \3/p'; }

replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}" --set cache.on=off
replay "$tmp/demo.pcap" "$tmp/cold" "${few[@]}"

all=20 # as test_cache.sh lists them
# another seed has other ground and woods; prototypes, stands of far woods, warm ground and patches are the same
replay "$tmp/demo.pcap" "$tmp/seed" "${few[@]}" -v --seed 2
read -r there made _ <<<"$(counts)"
check "another seed: ground, woods, canopy and shadows are made, the rest is there; more of what rays find" [ "$there" -ge 16 -a "$made" -ge 4 -a "$made" -le 16 ]
replay "$tmp/demo.pcap" "$tmp/seed_none" "${few[@]}" --seed 2 --set cache.on=off
check "and has its own bits" same_hashes "$tmp/seed" "$tmp/seed_none"
check "which are others" not same_hashes "$tmp/seed" "$tmp/none"

# bare trees are other prototypes, which let more light through: each way beside entries of the other
replay "$tmp/demo.pcap" "$tmp/bare" "${few[@]}" -v --set terrain.woods_leaves=off
check "bare trees: what has leaves is made" [ "$(counts)" = "6 12 0" ]
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

# another build of the program has its own entries, and leaves those of this one
before=$(kept)
mutant=$build/tests/mutants/pitviper_mutant_sun
check "another build is there" [ -x "$mutant" ]
"$mutant" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/build" "${few[@]}" -v >"$tmp/stdout" 2>"$tmp/stderr"
check "it fetches none of them" [ "$(counts)" = "0 $all 0" ]
check "and keeps its own beside them" [ "$(kept)" = $((before + all)) ]

# a frame file and a pixel of it: the world is made again from what was kept, to the same bits
replay "$tmp/demo.pcap" "$tmp/saved" "${few[@]}" --save-frame 0
frame_counts=()
for way in cold warm; do
    run frame "$tmp/saved/frame_000000.pvf" -v
    check "frame, $way: the same" [ $code = 0 ]
    frame_counts+=("$(counts)")
    run explain "$tmp/saved" 0 30 20
    check "explain, $way: adds up" [ $code = 0 ]
    mv "$tmp/stdout" "$tmp/explained_$way"
done
check "frame: all is there, its woods since it was proved" [ "${frame_counts[0]#* }" = "0 0" -a "${frame_counts[0]%% *}" -ge 19 ]
check "frame: again" [ "${frame_counts[1]}" = "${frame_counts[0]}" ]
check "explain: the same words" cmp -s "$tmp/explained_cold" "$tmp/explained_warm"

# a seeker's radar: signatures of its targets
radar=(--rate 5 --only 20 --size 64x48 --no-files --set radar.preset=seeker_94)
replay "$tmp/demo.pcap" "$tmp/radar_cold" "${radar[@]}" -v
signatures=$(counts)
check "signatures are kept" [ "${signatures% 0}" != "$signatures" -a "$(counts | cut -d' ' -f2)" -ge 2 ]
replay "$tmp/demo.pcap" "$tmp/radar_warm" "${radar[@]}" -v
check "all are fetched" [ "$(counts | cut -d' ' -f2,3)" = "0 0" ]
check "radar: same bits" same_hashes "$tmp/radar_cold" "$tmp/radar_warm"
check "radar: same detections" cmp -s "$tmp/radar_cold/truth.jsonl" "$tmp/radar_warm/truth.jsonl"

# a case of regress, cold and warm: the same bits, the same verdict
mkdir -p "$tmp/cases"
cp -r "$(dirname "$0")/../regress/woods" "$tmp/cases/"
for way in cold warm; do
    XDG_CACHE_HOME=$tmp/cache_regress run regress "$tmp/cases" --work "$tmp/regress_$way"
    check "regress, $way: passes" [ $code = 0 ]
    sed -n 's/^woods *\([a-z]*\).*/\1/p' "$tmp/stdout" >"$tmp/verdict_$way"
done
check "regress: a verdict" [ -s "$tmp/verdict_cold" ]
check "the same verdict" cmp -s "$tmp/verdict_cold" "$tmp/verdict_warm"
check "regress: same bits" same_hashes "$tmp/regress_cold/woods/out" "$tmp/regress_warm/woods/out"

# killed at any moment of its set-up, again and again: what it was writing goes with a later run, the bits stay
export XDG_CACHE_HOME=$tmp/cache_killed
for ((k = 0; k < 12; k++)); do
    rm -f "$XDG_CACHE_HOME"/pitviper/*.kept
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/killed" --overwrite "${few[@]}" >/dev/null 2>&1 &
    until_true eval "[ -n \"\$(ls '$XDG_CACHE_HOME/pitviper' 2>/dev/null)\" ] || ! kill -0 $! 2>/dev/null"
    sleep 0.$((RANDOM % 5))
    kill -KILL $! 2>/dev/null
    wait $! 2>/dev/null
done
replay "$tmp/demo.pcap" "$tmp/after" "${few[@]}"
check "after killed ones: same bits" same_hashes "$tmp/none" "$tmp/after"
check "nothing is left of them" [ -z "$(find "$XDG_CACHE_HOME" -name '*.aside')" ]
check "nothing is called damaged" not complained damaged

# two runs at once that write and evict in a cache that has no room for one world
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/small_other" "${few[@]}" --set cache.most_mb=20 >/dev/null 2>&1 &
other=$!
replay "$tmp/demo.pcap" "$tmp/small" "${few[@]}" --set cache.most_mb=20
wait "$other"
check "a small cache, two runs: both end well" [ "$?$code" = 00 ]
check "same bits" same_hashes "$tmp/none" "$tmp/small"
check "and of the other" same_hashes "$tmp/none" "$tmp/small_other"
check "it keeps its size" [ "$(du -sk "$XDG_CACHE_HOME/pitviper" | cut -f1)" -le 20480 ]

replay "$tmp/demo.pcap" "$tmp/unusable" "${few[@]}" --set cache.folder="$tmp/demo.pcap/below"
check "a folder that cannot be made: same bits" same_hashes "$tmp/none" "$tmp/unusable"
check "said once, with what to do" [ "$(grep -c 'cannot be made.*cache.folder' "$tmp/stderr")" = 1 ]

# a full disk, and one that cannot be written: file systems of their own, in a name space of mounts that ends with the command
if ! unshare -m mount -t tmpfs -o size=1m none "$tmp/regress_cold" 2>/dev/null; then
    echo "not tried: a full disk, a read-only one: no mounts can be made here (unshare -m)"
    finish
fi
mkdir -p "$tmp/disk/pitviper"
on_disk() { # OPTIONS OUT: a run whose cache is on a disk mounted so
    unshare -m sh -c 'mount $1 "$2" && shift 2 && XDG_CACHE_HOME=$1 && export XDG_CACHE_HOME && shift && "$@"; code=$?
        ls "$XDG_CACHE_HOME/pitviper" | sed "s/^/left: /"; exit $code' sh "$1" "$tmp/disk" "$tmp/disk" "$pitviper" replay \
        "${bare[@]}" "$tmp/demo.pcap" --out "$2" --threads 2 --rate 1 "${few[@]}" -v >"$tmp/stdout" 2>"$tmp/stderr"
}
on_disk "-t tmpfs -o size=7m none" "$tmp/full"
check "a full disk: same bits" same_hashes "$tmp/none" "$tmp/full"
check "said once, what it is" [ "$(grep -c 'cache: .* cannot be written: No space left' "$tmp/stderr")" = 1 ]
check "no half of an entry stays" not grep -q 'left: .*aside' "$tmp/stdout"
cp "$tmp"/cache/pitviper/*.kept "$tmp/disk/pitviper/"
on_disk "--bind -o ro $tmp/disk" "$tmp/read_only"
check "a disk that cannot be written: same bits" same_hashes "$tmp/none" "$tmp/read_only"
check "said once" [ "$(grep -c 'cache: .* cannot be written: Read-only.*what is in it is used' "$tmp/stderr")" = 1 ]
check "what is there is fetched" [ "$(counts)" = "$all 0 0" ]
rm "$tmp/disk/pitviper/"*
on_disk "--bind -o ro $tmp/disk" "$tmp/read_only_empty"
check "an empty one: same bits" same_hashes "$tmp/none" "$tmp/read_only_empty"
check "nothing is written" [ "$(counts)" = "0 $all 0" -a -z "$(ls "$tmp/disk/pitviper")" ]
finish
