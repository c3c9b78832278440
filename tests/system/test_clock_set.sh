#!/usr/bin/env bash
# The system's clock is set back by an hour while a live node runs: frames go on, it is said, and the recording replays
# to the same bits. Another node's recording is deleted under it: that is no success.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

shim=$build/tests/libset_clock.so
[ -f "$shim" ] || { echo "skipped: no $shim"; exit 77; }
options=(--address 127.0.0.1 --size 48x32 --threads 1 --rate 5 --bands lwir --no-files --host observer --set exercise.listen_s=0.3)
free_port
export SET_CLOCK_S=-3600 SET_CLOCK_WHEN=$tmp/when
LD_PRELOAD=$shim node set --port $port "${options[@]}" --for 60 --frames 12 --record "$tmp/set.pcapng"
check "it listens" heard_by set 'listening on' 20
sender demo --send 127.0.0.1:$port
free_port
node lost --port $port "${options[@]}" --for 0.5 --record "$tmp/lost.pcapng"
check "the other listens" heard_by lost 'listening on' 20
rm -f "$tmp/lost.pcapng"
for ((i = 0; i < 300; i++)); do [ "$(cat "$tmp/set/truth.jsonl" 2>/dev/null | wc -l)" -ge 3 ] && break; sleep 0.1; done
touch "$tmp/when"
ended set 20
end_sender
check "it ends well" [ $code = 0 ]
check "it says that the clock was set" grep -q "clock was set back by 3600 s" "$tmp/set.out"
made=$(numbered "$tmp/set" | wc -l)
check "frames go on: $made" [ "$made" = 12 ]
check "by arrivals that go on" is "$(awk -v a="$(time_of "$tmp/set" 1)" -v b="$(time_of "$tmp/set" '$')" 'BEGIN { print b - a }')" '>' 1.9
ended lost 20
check "a recording that is gone is no success" [ $code = 1 ]
check "and that is said" grep -q 'cannot be read again' "$tmp/lost.out"
replay "$tmp/set.pcapng" "$tmp/again" --causal --port 0 --size 48x32 --threads 1 --rate 5 --bands lwir --no-files --host observer --set exercise.listen_s=0.3 \
    --from "$(time_of "$tmp/set" 1)"
check "its recording replays" [ $code = 0 ]
check "to the same bits" agree "$tmp/set" "$tmp/again" 9
[ "$failures" = 0 ] || { tail -n 20 "$tmp/set.out" "$tmp/lost.out"; cat "$tmp/stderr"; }
finish
