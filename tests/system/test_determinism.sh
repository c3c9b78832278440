#!/usr/bin/env bash
# Same log, configuration and version: the same planes to the bit, for any number of threads, at any speed,
# with every skip or none, whoever wants files, pictures or all bands. More scenes: test_determinism_scenes.sh; other
# builds and tracers: test_determinism_builds.sh; live against replay: test_live.sh, where one node publishes on the
# network and its replay does not.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--rate 1 --no-png)
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1
check "a replay" [ "$code" = 0 ]
check "some frames" [ "$(frames "$tmp/one")" -ge 8 ]
check "a hash a frame" [ "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sort -u | wc -l)" = "$(frames "$tmp/one")" ]

for threads in 2 4; do
    replay "$tmp/demo.pcap" "$tmp/t$threads" "${few[@]}" --threads $threads
    check "$threads threads, same bits" same_hashes "$tmp/one" "$tmp/t$threads"
done
replay "$tmp/demo.pcap" "$tmp/again" "${few[@]}" --threads 2 --speed 10
check "speed 10, same bits" same_hashes "$tmp/one" "$tmp/again"
first=$(json_numbers <(head -n 1 "$tmp/one/truth.jsonl") time_s | head -n 1)
span=(--from "$first" --to "$(awk -v t="$first" 'BEGIN { print t + 2 }')")
replay "$tmp/demo.pcap" "$tmp/real" "${few[@]}" "${span[@]}" --speed 1
replay "$tmp/demo.pcap" "$tmp/max" "${few[@]}" "${span[@]}" --speed max
check "speed 1, same bits as max" same_hashes "$tmp/real" "$tmp/max"
check "speed 1: all frames of 2 s" [ "$(frames "$tmp/real")" = 3 ]
replay "$tmp/demo.pcap" "$tmp/noskip" "${few[@]}" --no-skip
check "no skips, same bits" same_hashes "$tmp/one" "$tmp/noskip"

# from the middle: a frame does not depend on those before it
if [ "$(frames "$tmp/one")" -ge 8 ]; then
    first=$(json_numbers <(sed -n 4p "$tmp/one/truth.jsonl") time_s | head -n 1)
    replay "$tmp/demo.pcap" "$tmp/late" "${few[@]}" --from "$first"
    check "--from: its first frame is the fourth of the whole" \
        [ "$(hashes "$tmp/late" | grep -oE '[0-9a-f]{64}' | head -n 1)" = "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sed -n 4p)" ]
fi

# the twin: what should change the bits does
replay "$tmp/demo.pcap" "$tmp/seed" "${few[@]}" --seed 2
check "another seed, other bits" not same_hashes "$tmp/one" "$tmp/seed"
check "another seed still makes frames" [ "$(frames "$tmp/seed")" = "$(frames "$tmp/one")" ]
config_of() { grep -oE '"config_sha256": *"[0-9a-f]{64}"' "$1/run.json"; }
check "the configuration hash leaves out threads and speed" [ "$(config_of "$tmp/one")" = "$(config_of "$tmp/again")" ]
check "and knows the seed" [ "$(config_of "$tmp/one")" != "$(config_of "$tmp/seed")" ]

# nothing is made that was not asked for, and what is asked for does not change
for bands in lwir optical,radar; do
    replay "$tmp/demo.pcap" "$tmp/some" "${few[@]}" --bands $bands
    for band in optical mwir lwir radar; do
        wanted=0
        case ,$bands, in *,$band,*) wanted=$(frames "$tmp/one" $band) ;; esac
        check "--bands $bands: $wanted frames of $band" [ "$(frames "$tmp/some" $band)" = "$wanted" ]
    done
    check "--bands $bands: the same planes" same_planes "$tmp/one" "$tmp/some"
    rm -rf "$tmp/some"
done
check "the twin: planes of another seed are not the same" not quiet same_planes "$tmp/one" "$tmp/seed"
replay "$tmp/demo.pcap" "$tmp/display" --rate 1 "${span[@]}"
check "display pictures beside: same bits" same_hashes "$tmp/max" "$tmp/display"
check "and there they are" [ "$(find "$tmp/display" -name '*.png' | wc -l)" -ge 12 ]
replay "$tmp/demo.pcap" "$tmp/none" --rate 1 "${span[@]}" --no-files
check "--no-files: same bits" same_hashes "$tmp/max" "$tmp/none"
check "and no picture" [ -z "$(find "$tmp/none" -name '*.exr' -o -name '*.png')" ]
check "--no-png: none" [ -z "$(find "$tmp/one" -name '*.png')" ]
finish
