#!/usr/bin/env bash
# Senders whose time stamps are no clock: the missile's eye stays on the path that proper stamps give, and above the
# ground; what was found out is said.
. "$(dirname "$0")/common.sh"

# path OUT: x y z height of the host, a line a frame
path() {
    awk '{ one = $0; sub(/.*"host": */, "", one)
           e = one; sub(/.*"ecef_m": *\[/, "", e); split(e, p, /[],]/)
           h = one; sub(/.*"height_m": */, "", h); printf "%.3f %.3f %.3f %.3f\n", p[1], p[2], p[3], h + 0 }' "$1/truth.jsonl"
}
# off_path OUT: farthest that the host is from the reference's path, m
off_path() {
    awk 'BEGIN { n = 0 } NR == FNR { x[n] = $1; y[n] = $2; z[n] = $3; n++; next }
         { best = 1e9
           for (i = 0; i + 1 < n; i++) {
               a = x[i+1] - x[i]; b = y[i+1] - y[i]; c = z[i+1] - z[i]; l = a * a + b * b + c * c
               u = l > 0 ? (a * ($1 - x[i]) + b * ($2 - y[i]) + c * ($3 - z[i])) / l : 0
               u = u < 0 ? (i ? 0 : u) : u > 1 ? (i + 2 < n ? 1 : u) : u # the first and last frames differ
               d = sqrt((x[i] + u * a - $1)^2 + (y[i] + u * b - $2)^2 + (z[i] + u * c - $3)^2)
               if (d < best) best = d
           }
           if (best > worst) worst = best; frames++ }
         END { print (frames && n > 1 ? worst : "nothing") }' "$tmp/path" <(path "$1")
}

quick=(--no-files --bands lwir --size 16x16 --rate 5)
exercise demo "$tmp/relative.pcap"
replay "$tmp/relative.pcap" "$tmp/relative" "${quick[@]}"
check "proper stamps: replays" [ $code = 0 ]
cp "$tmp/stdout" "$tmp/relative.said"
check "proper stamps: none is doubted" grep -q '"stamps_doubted":0' <(run_json "$tmp/relative")
path "$tmp/relative" >"$tmp/path"

# The dead-reckoning threshold of the demo is 1 m; half a metre for corners between the frames of the reference.
try() { # try KIND WORDS options
    local kind=$1 words=$2; shift 2
    exercise demo "$tmp/$kind.pcap" dis.stamps="$kind"
    replay "$tmp/$kind.pcap" "$tmp/$kind" "${quick[@]}" "$@"
    check "$kind: replays" [ $code = 0 ]
    check "$kind: as many frames" [ "$(($(lines_in "$tmp/$kind/truth.jsonl") - $(lines_in "$tmp/relative/truth.jsonl") + 1))" -le 2 ]
    echo "$kind: $(off_path "$tmp/$kind") m off the path"
    check "$kind: the eye is where it was" is "$(off_path "$tmp/$kind")" '<' 1.5
    check "$kind: the eye is above the ground" [ "$(grep -c 'below the ground' "$tmp/stderr")" = 0 ]
    check "$kind: said" grep -q "time stamps of 1:3001 $words: .* count from their arrival" "$tmp/stdout"
    check "$kind: counted" grep -q '"stamps_doubted":[1-9]' <(run_json "$tmp/$kind")
}
try constant "stand still"
# two seconds of listening are too few to tell what they count
try milliseconds "count something else than time" --causal --host munition
try half-rate "run at 0.5 times the rate of their arrivals" --causal --host munition

exercise demo "$tmp/none.pcap" dis.stamps=none
replay "$tmp/none.pcap" "$tmp/none" "${quick[@]}" --rate 0.2
check "no stamps: said" grep -q 'clock: no PDU has a time stamp, all are 0: every PDU counts from its arrival' "$tmp/stdout"
check "stamps: none lacks" [ "$(grep -c 'has a time stamp' "$tmp/relative.said")" = 0 ]

# ---- --host munition of a recording: the demo's one missile is what is chosen by itself, to the bit
replay "$tmp/relative.pcap" "$tmp/munition" "${quick[@]}" --host munition
check "munition: replays" [ $code = 0 ]
check "munition: is followed" complained 'host: 1:3001:41, the first guided munition'
check "munition: the frames of the missile chosen by name" same_hashes "$tmp/relative" "$tmp/munition"
exercise no-missile "$tmp/no-missile.pcap" duration_s=5
replay "$tmp/no-missile.pcap" "$tmp/no-missile" "${quick[@]}" --host munition
check "munition: none flies: exit code" [ $code = 1 ]
check "munition: none flies: what to do" complained 'none flies in the log, which has 0 munitions.*--host ID or --host observer'
check "munition: none flies: one line" [ "$(wc -l <"$tmp/stderr")" = 1 ]
replay "$tmp/no-missile.pcap" "$tmp/no-missile" "${quick[@]}" --host munition --causal
check "munition: none flies, causal: what to do" complained 'none flew at a frame.*--host ID or --host observer'

run inspect "$tmp/half-rate.pcap"
check "inspect says it" grep -q "time stamps of 1:3001 run at 0.5 times" "$tmp/stdout"
check "inspect keeps the packet times" [ "$(grep -c 'keep pace' "$tmp/stdout")" = 0 ]
finish
