#!/usr/bin/env bash
# The system's clock is set back by an hour while a live node runs: frames go on, it is said, and the recording replays
# to the same bits. Another node's recording is deleted under it: that is no success.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

shim=$build/tests/libset_clock.so
[ -f "$shim" ] || { echo "skipped: no $shim"; exit 77; }
options=(--size 32x24 --threads 1 --rate 5 --bands lwir --no-files --host observer --set exercise.listen_s=0.3)
free_port
export SET_CLOCK_S=-3600 SET_CLOCK_WHEN=$tmp/when
LD_PRELOAD=$shim node set --address 127.0.0.1 --port $port "${options[@]}" --record "$tmp/set.pcapng"
check "it listens" heard_by set 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
free_port
node lost --address 127.0.0.1 --port $port "${options[@]}" --record "$tmp/lost.pcapng"
check "the other listens" heard_by lost 'listening on'
rm -f "$tmp/lost.pcapng"
check "it makes frames" makes set 3
touch "$tmp/when"
check "the clock is seen to be set" heard_by set 'clock was set'
before=$(lines_in "$tmp/set/truth.jsonl")
check "frames go on" makes set $((before + 6)) # lines of frames made before may be still to come, three at most
stop set
end_sender
check "it ends well" [ $code = 0 ]
check "it says that the clock was set" grep -q "clock was set back by 3600 s" "$tmp/set.out"
made=$(numbered "$tmp/set" | wc -l)
check "by arrivals that go on" is "$(awk -v a="$(time_of "$tmp/set" 1)" -v b="$(time_of "$tmp/set" '$')" 'BEGIN { print b - a }')" '>=' "$(awk -v n="$made" 'BEGIN { print (n - 1) / 5 - 1e-6 }')"
stop lost
check "a recording that is gone is no success" [ $code = 1 ]
check "and that is said" grep -q 'cannot be read again' "$tmp/lost.out"
replay "$tmp/set.pcapng" "$tmp/again" --causal --port 0 --to "$(time_of "$tmp/set" '$')" "${options[@]}" --only "$(frames_of set)"
check "its recording replays" [ $code = 0 ]
check "to the same bits" part_of "$tmp/set" "$tmp/again" "$made"
[ "$failures" = 0 ] || { tail -n 20 "$tmp/set.out" "$tmp/lost.out"; cat "$tmp/stderr"; }
finish
