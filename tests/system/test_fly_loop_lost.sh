#!/usr/bin/env bash
# `pitviper fly` in the loop with a recogniser that fails: mute, killed, slow, late; the missile coasts, and the program ends by
# itself. And what is refused.
. "$(dirname "$0")/common.sh"

judges python3.numpy
export TMPDIR=$tmp
. "$(dirname "$0")/../tools/loop_common.sh"

# ---- it never answers; it dies on the way
loop mute --recogniser "$knows --mute" --start 0.3 --limit 0.01
check "mute: no frame was answered" [ "$(cell mute none)" = "$(cell mute frames)" ]
check "mute: nothing guided" [ "$(cell mute guided_share)" = 0.0000 ]
check "mute: it does not hit: $(cell mute end)" [ "$(cell mute hit)" != entity ]
loop killed --recogniser "$knows --dies 10"
check "killed: said" complained 'recogniser (ended with code 137|was ended by signal 9)'
check "killed: its first ten answers were used" [ "$(cell killed seen)" = 10 ]
check "killed: no further one" [ "$(cell killed none)" = "$(($(cell killed frames) - 10))" ]
check "killed: coasts after $(cell killed guided_share)" is "$(cell killed guided_share)" '<' 0.6
check "killed: guided until then" is "$(cell killed guided_share)" '>' 0.1
check "no recogniser is left" not pgrep -f "loop_recogniser.py.*--dies 10"

# ---- an answer that comes after the limit is refused, and the next ones are used
loop slow --recogniser "$knows --slow 10,1.2" --limit 0.6
check "slow: it was waited for no longer: $(cell slow none)" is "$(cell slow none)" '>' 0
check "slow: the answer was refused: $(cell slow late)" is "$(cell slow late)" '>' 0
check "slow: those after it were used: $(cell slow seen)" is "$(cell slow seen)" '>' 25

# ---- the older the answers, the larger the miss
loop late0 --recogniser "$knows --box"
loop late2 --recogniser "$knows --box" --set shots.Missile.sight_late_s=0.2
check "by boxes of its own reckoning it hits: $(cell late0 miss_m)" [ "$(cell late0 hit)" = entity ]
check "0.2 s late: $(cell late2 miss_m) m after $(cell late0 miss_m)" is "$(cell late2 miss_m)" '>' "$(awk -v m="$(cell late0 miss_m)" 'BEGIN { print 2 * m }')"

# ---- refused, and said
refused() { # refused WHAT CODE PATTERN ARGUMENTS...
    local what=$1 wanted=$2 pattern=$3; shift 3
    run fly "$@"
    check "$what: ended with $code" [ "$code" = "$wanted" ]
    check "$what: said" complained "$pattern"
}
s=$tmp/short.yaml
refused "two sources" 2 'without --recogniser' "$s" --recogniser true --sights x.csv
refused "options without frames" 2 'with --frames DIR or --recogniser' "$s" -- --size 96x64
refused "a wait for no answers" 2 'with --recogniser COMMAND' "$s" --frames "$tmp/x" --limit 3
refused "no time" 2 'limit.*seconds above 0' "$s" --frames "$tmp/x" --limit -1
refused "a missile without a seeker" 1 'has no seeker' "$s" --frames "$tmp/x" --set shots.Missile.flies=wire_at
refused "a gimbal of its own" 1 "gimbal_lag_s.*leave it out" "$s" --frames "$tmp/x" -- --set sensor.gimbal_lag_s=0.2
refused "a mount" 1 "sensor.mount_yaw_deg.*leave it out" "$s" --frames "$tmp/x" -- --set sensor.mount_yaw_deg=3
refused "another host" 1 'missile is the host' "$s" --frames "$tmp/x" -- --speed 2
refused "no such sights" 1 'none.csv' "$s" --sights "$tmp/none.csv"
refused "a seed that no node has" 1 'seeds up to 2147483647.*not 2147483648' "$s" --sights "$tmp/none.csv" --set seed=2147483648
refused "seeds that end there" 1 'seeds up to 2147483647.*not 2147483649' "$s" --frames "$tmp/x" --seeds 5 --set seed=2147483645
printf 'frame,sight,column_px,row_px\n10,seen,,\n' >"$tmp/poor.csv"
refused "sights without a place" 1 'column_px.*a place in the image' "$s" --sights "$tmp/poor.csv"
printf 'frame,sight,column_px,row_px\n7,seen,48,32\n' >"$tmp/other.csv"
refused "sights of another flight" 1 'no frame [0-9]+: they are of another flight' "$s" --sights "$tmp/other.csv" -- "${small[@]}"
check "nothing is left of it all" [ -z "$(find "$tmp" -maxdepth 1 -name 'pitviper-fly-*')" ]
finish
