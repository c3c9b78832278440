#!/usr/bin/env bash
# As test_publish_failures.sh: a reader that is stopped for a minute. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"

exercise crowd "$tmp/crowd.pcap" scale=0.01 duration_s=80
reader stopped; stopped=$reader
( until_true test -s "$tmp/stopped"; kill -STOP $stopped; sleep 60; kill -CONT $stopped ) &
watched_long minute 66 --memory $memory
check "a reader stopped for a minute: every frame is made and written" \
    [ $code = 0 -a "$(frames_of minute)" = 331 -a "$(consumer minute memory count)" = 331 ]
wait $stopped
check "and it goes on" [ $? = 0 ] # the last frames, then the node's end
check "with the newest frames" grep -qE '^frame 33[0-9] ' "$tmp/stopped"
finish
