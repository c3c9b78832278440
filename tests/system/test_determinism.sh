#!/usr/bin/env bash
# Same log, configuration and version: the same planes to the bit, for any number of threads, at any speed,
# with every skip or none, whoever wants files, pictures or all bands. More scenes: test_determinism_scenes.sh; other
# builds and tracers: test_determinism_builds.sh; live against replay: test_live.sh, where one node publishes on the
# network and its replay does not.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--rate 1 --no-png "${coarse[@]}")
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1
check "a replay" [ "$code" = 0 ]
check "some frames" [ "$(frames "$tmp/one")" -ge 8 ]
check "a hash a frame" [ "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sort -u | wc -l)" = "$(frames "$tmp/one")" ]
check "--no-png: none" [ -z "$(find "$tmp/one" -name '*.png')" ]

# Bits that are the same with several things changed at once are so with each of them: a replay stands for several.
replay "$tmp/demo.pcap" "$tmp/again" "${few[@]}" --threads 2 --speed 10 --no-files
check "2 threads, speed 10, --no-files: same bits" same_hashes "$tmp/one" "$tmp/again"
check "and no picture" [ -z "$(find "$tmp/again" -name '*.exr' -o -name '*.png')" ]
replay "$tmp/demo.pcap" "$tmp/noskip" "${few[@]}" --threads 4 --no-skip
check "4 threads, no skips: same bits" same_hashes "$tmp/one" "$tmp/noskip"

# from the middle: a frame does not depend on those before it
if [ "$(frames "$tmp/one")" -ge 8 ]; then
    first=$(json_numbers <(sed -n 4p "$tmp/one/truth.jsonl") time_s | head -n 1)
    replay "$tmp/demo.pcap" "$tmp/late" --rate 1 "${coarse[@]}" --from "$first" --to "$(awk -v t="$first" 'BEGIN { print t + 2 }')" --speed 1
    check "speed 1, --from, --to, display pictures: the fourth to sixth frame of the whole" \
        [ "$(hashes "$tmp/late" | grep -oE '[0-9a-f]{64}')" = "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sed -n 4,6p)" ]
    check "speed 1: all frames of 2 s" [ "$(frames "$tmp/late")" = 3 ]
    check "and display pictures there are" [ "$(find "$tmp/late" -name '*.png' | wc -l)" -ge 12 ]
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
finish
