#!/usr/bin/env bash
# As test_publish_failures_encoder.sh, for as long as a recovery takes: an encoder that fails once, a receiver that vanishes and
# comes back. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "encoder that can be made to fail in this build" can_fail_encoder
judges python3

exercise crowd "$tmp/crowd.pcap" scale=0.01 duration_s=80
free_port
stream=udp://127.0.0.1:$port
LD_PRELOAD=$build/tests/libfail_encoder.so FAIL_ENCODER=5,1 watched_long encoder 20 --stream "$stream"
check "an encoder that fails once: the replay ends well" [ $code = 0 ]
check "every frame is made" [ "$(frames_of encoder)" = 101 ]
check "said once, that it fails and that it is back" \
    [ "$(said_times encoder 'going on without')" = 1 -a "$(said_times encoder 'the video of lwir again; [0-9]+ frames lack')" = 1 ]
check "it recovers: most frames were lost for ten seconds and no longer" is "$(grep -oE 'again; [0-9]+' "$tmp/encoder.out" | cut -d' ' -f2)" '<=' 60

receiver() { # takes the stream for so many seconds, and dies
    timeout -s KILL "$1" python3 -c 'import socket, sys
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("127.0.0.1", int(sys.argv[1])))
while True: s.recv(2048)' $port >/dev/null 2>&1
}
{ receiver 6; sleep 5; receiver 30; } 2>/dev/null &
others+=($!)
watched_long receiver 25 --stream "$stream"
check "a receiver that vanishes: the replay ends well" [ $code = 0 ]
check "every frame is made and sent" [ "$(frames_of receiver)" = 126 -a "$(consumer receiver video count)" = 126 ]
check "said once each time it is away" is "$(said_times receiver 'no program receives it')" '<=' 2
check "and that it is back" is "$(said_times receiver 'received again')" '>=' 1
finish
