#!/usr/bin/env bash
# Motion in truth.jsonl against differences of its own ranges; the seeker flying on when its missile falls
# silent; every frame's boresight on its own tick.
. "$(dirname "$0")/common.sh"
judges oiiotool
bare=("${quick[@]}")

# aim OUT ENTITY: a line a frame: time, range, closing speed, boresight error right and up of that target
aim() {
    awk -v id="$2" '{
        t = $0; sub(/.*"time_s": */, "", t)
        if (!match($0, "\"entity\": *\"" id "\", *\"marking\"")) next
        one = substr($0, RSTART); if (!match(one, /"type"/)) next
        r = one; sub(/.*"range_m"/, "\"range_m\"", r)
        split(one, parts, /"range_m": */); r = parts[2] + 0
        split(one, parts, /"closing_mps": */); c = parts[2] + 0
        split(one, parts, /"boresight_error_deg": *\[/); split(parts[2], b, /[],]/)
        printf "%.6f %.6f %.6f %.6f %.6f\n", t + 0, r, c, b[1], b[2]
    }' "$1/truth.jsonl"
}
# closing: worst difference between the closing speed and the central difference of the range, m/s
closing() { aim "$@" | awk 'BEGIN { w = 0 } { t[NR] = $1; r[NR] = $2; c[NR] = $3 }
    END { for (i = 2; i < NR; i++) { d = (r[i-1] - r[i+1]) / (t[i+1] - t[i-1]) - c[i]; if (d < 0) d = -d; if (d > w) w = d; n++ }
          print (n ? w : "nothing") }'; }

exercise demo "$tmp/demo.pcap"
exercise no-missile "$tmp/quiet.pcap"
fine=(--no-files --bands lwir --size 16x16 --threads 1)

# The missile: past its motor it slows smoothly; differences over 80 ms are good to a third derivative of some
# 50 m/s3, 0.02 m/s; the reports it is interpolated between bend its path a little more.
replay "$tmp/demo.pcap" "$tmp/flight" "${fine[@]}" --rate 25 --from 1365 --to 1366
check "missile: 26 frames" [ "$(wc -l <"$tmp/flight/truth.jsonl")" = 26 ]
check "missile: closing speed is the range's slope" is "$(closing "$tmp/flight" 1:3001:22)" '<' 1
check "missile: it does close" is "$(aim "$tmp/flight" 1:3001:22 | awk 'NR == 1 { print $3 }')" '>' 200

# The observer rides with its aim on a circle: the range stays, whatever the vehicle does.
replay "$tmp/quiet.pcap" "$tmp/circle" "${fine[@]}" --rate 20 --from 1365 --to 1366
target=$(grep -oE 'aim: [0-9:]+' "$tmp/stdout" | cut -d' ' -f2)
check "observer: closing speed is the range's slope" is "$(closing "$tmp/circle" "$target")" '<' 0.5
check "observer: and small" is "$(aim "$tmp/circle" "$target" | awk 'BEGIN { w = 0 } { c = $3 < 0 ? -$3 : $3; if (c > w) w = c } END { print w }')" '<' 0.5

# The gimbal moves on ticks of 10 ms; each frame must show its own. On a smooth flight the boresight error then
# changes smoothly: no second difference beyond 0.02 deg, a third of a pixel of a picture 96 wide.
jump() { aim "$1" "$2" | awk 'BEGIN { w = 0 } { b[NR] = $4 } END { for (i = 2; i < NR; i++) { d = b[i-1] - 2 * b[i] + b[i+1]; if (d < 0) d = -d; if (d > w) w = d }
    print (NR > 2 ? w : "nothing") }'; }
replay "$tmp/demo.pcap" "$tmp/smooth" "${fine[@]}" --rate 20 --from 1366 --to 1368
check "gimbal: no frame shows the tick before" is "$(jump "$tmp/smooth" 1:3001:22)" '<' 0.02

# A gimbal at its limit is warned of when it is, once; how often it was is no second warning.
replay "$tmp/demo.pcap" "$tmp/limit" "${fine[@]}" --rate 5 --from 1366 --to 1367 --set sensor.gimbal_limit_deg=0.1
check "limit: one warning" [ "$(grep -c '^pitviper: warning: ' "$tmp/stderr")" = 1 ]
check "limit: of it" complained 'is beyond its gimbal at'
check "limit: how often" said 'beyond the gimbal in 6 of 6 frames'

# Silence for the last 1.5 s, some 470 m: the seeker flies on to its target.
sed 's/^    time_s: 12$/&\n    silent_s: 1.5/' etc/scenarios/demo.yaml >"$tmp/silent.yaml"
exercise "$tmp/silent.yaml" "$tmp/silent.pcap"
replay "$tmp/silent.pcap" "$tmp/silent" "${fine[@]}" --rate 5 --from 1368
last() { aim "$1" 1:3001:22 | tail -n 1 | cut -d' ' -f2; }
check "silent missile: replays" [ $code = 0 ]
check "silent missile: still comes near" is "$(last "$tmp/silent")" '<' 100
replay "$tmp/silent.pcap" "$tmp/causal" "${fine[@]}" --rate 5 --from 1368 --causal --host munition
check "causal: replays" [ $code = 0 ]
check "causal: comes near, too" is "$(last "$tmp/causal")" '<' 100

# One panchromatic channel, by a configuration file.
printf 'sensor:\n  optical: pan\n' >"$tmp/pan.yaml"
replay "$tmp/demo.pcap" "$tmp/twice" --rate 1 --size 32x24 --threads 1 --bands optical,lwir --config "$tmp/pan.yaml"
check "pan: replays" [ $code = 0 ]
check "pan: one channel Y" grep -q '1 channel' <(oiiotool --info "$(find "$tmp/twice/frames/optical" -name '*.exr' | head -n 1)")

# An interrupted run leaves no frames among those of the next; and progress is shown only on a terminal (test_progress.sh).
check "first run: more frames" [ "$(frames "$tmp/twice" optical)" -ge 6 ]
rm "$tmp/twice/run.json" # as if it had been killed
replay "$tmp/demo.pcap" "$tmp/twice" --rate 0.5 --size 32x24 --threads 1 --bands lwir
check "second run: fewer than 6 frames" [ "$(frames "$tmp/twice")" -gt 0 -a "$(frames "$tmp/twice")" -lt 6 ]
check "second run: as many frames as it says" [ "$(frames "$tmp/twice" lwir)" = "$(frames "$tmp/twice")" ]
check "second run: no picture of the first" [ "$(find "$tmp/twice" -name '*.png' | wc -l)" = $((2 * $(frames "$tmp/twice"))) ]
check "second run: no other band" [ "$(frames "$tmp/twice" optical)" = 0 ]
check "no terminal, no progress" [ "$(grep -c 'frame 1 of' "$tmp/stderr")" = 0 ]

# The tracer's instruction set changes no bit: frames from afar and near, and the shadows that cool the ground.
traced=(--rate 1 --only 3,8 --no-files --threads 1 --set models.sag_m=0.002 --set heat.shadow_m=64)
replay "$tmp/demo.pcap" "$tmp/avx2" "${traced[@]}"
replay "$tmp/demo.pcap" "$tmp/sse" "${traced[@]}" --isa sse4.2
check "--isa: same bits" same_hashes "$tmp/avx2" "$tmp/sse"
check "--isa: of two frames" [ "$(wc -l <"$tmp/avx2/truth.jsonl")" = 2 ]
finish
