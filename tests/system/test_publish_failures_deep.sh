#!/usr/bin/env bash
# As test_publish_failures.sh, for as long as a recovery takes: an encoder that fails once, a receiver that vanishes and comes
# back, a disk that has room again, a reader that is stopped for a minute. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

exercise crowd "$tmp/crowd.pcap" scale=0.01 duration_s=80
frames_of() { json_numbers "$tmp/$1/run.json" frames | tail -n 1; }
consumer() { run_json "$tmp/$1" | grep -oE "\"$2\":\{\"[a-z][^}]*\}" | tail -n 1 | grep -oE "\"$3\":[0-9.]+" | cut -d: -f2; }
said_times() { grep -cE -e "$2" "$tmp/$1.out"; }
# watched NAME SECONDS options: a replay by the clock, 5 frames a second
watched() {
    local name=$1 seconds=$2; shift 2
    "$pitviper" replay "${bare[@]}" "$tmp/crowd.pcap" --out "$tmp/$name" --size 64x48 --bands lwir --rate 5 --to +$seconds --threads 1 \
        --speed 1 --no-files --set quality.budget=off "$@" >"$tmp/$name.out" 2>&1
    code=$?
}
free_port
stream=udp://127.0.0.1:$((port + 3001))

if "$pitviper" run --help | grep -q -- --stream && [ -f "$build/tests/libfail_encoder.so" ]; then
    LD_PRELOAD=$build/tests/libfail_encoder.so FAIL_ENCODER=5,1 watched encoder 20 --stream "$stream"
    check "an encoder that fails once: the replay ends well" [ $code = 0 ]
    check "every frame is made" [ "$(frames_of encoder)" = 101 ]
    check "said once, that it fails and that it is back" \
        [ "$(said_times encoder 'going on without')" = 1 -a "$(said_times encoder 'the video of lwir again; [0-9]+ frames lack')" = 1 ]
    check "it recovers: most frames were lost for ten seconds and no longer" is "$(grep -oE 'again; [0-9]+' "$tmp/encoder.out" | cut -d' ' -f2)" '<=' 60
    if command -v python3 >/dev/null; then
        receiver() { # takes the stream for so many seconds, and dies
            timeout -s KILL "$1" python3 -c 'import socket, sys
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("127.0.0.1", int(sys.argv[1])))
while True: s.recv(2048)' $((port + 3001)) >/dev/null 2>&1
        }
        { receiver 6; sleep 5; receiver 30; } 2>/dev/null &
        watched receiver 25 --stream "$stream"
        check "a receiver that vanishes: the replay ends well" [ $code = 0 ]
        check "every frame is made and sent" [ "$(frames_of receiver)" = 126 -a "$(consumer receiver video count)" = 126 ]
        check "said once each time it is away" is "$(said_times receiver 'no program receives it')" '<=' 2
        check "and that it is back" is "$(said_times receiver 'received again')" '>=' 1
    fi
fi

if command -v cc >/dev/null && cc -O1 -I etc/include etc/examples/read_memory.c -o "$tmp/reader" 2>/dev/null; then
    name=pitviper_failures_$$
    "$tmp/reader" $name --wait $patience >"$tmp/stopped" 2>&1 & stopped=$!
    ( until_true test -s "$tmp/stopped"; kill -STOP $stopped; sleep 60; kill -CONT $stopped ) &
    watched minute 66 --memory $name
    check "a reader stopped for a minute: every frame is made and written" \
        [ $code = 0 -a "$(frames_of minute)" = 331 -a "$(consumer minute memory count)" = 331 ]
    wait $stopped
    check "and it goes on" [ $? = 0 ] # the last frames, then the node's end
    check "with the newest frames" grep -qE '^frame 33[0-9] ' "$tmp/stopped"
fi

# a live node on a disk that is full from the start, for eight seconds
if unshare -rm true 2>/dev/null && unshare -rm bash -c "mount -t tmpfs -o size=4k none '$tmp'" 2>/dev/null; then
    mkdir "$tmp/disk"
    unshare -rm bash -c "mount -t tmpfs -o size=4m none '$tmp/disk' && head -c 4180000 /dev/zero >'$tmp/disk/ballast'
        (sleep 12; rm '$tmp/disk/ballast') & \"\$@\"; code=\$?; cp '$tmp/disk/out/run.json' '$tmp/disk.json'; exit \$code" \
        bash "$pitviper" run "${bare[@]}" --out "$tmp/disk/out" --address 127.0.0.1 --port $port --size 64x48 --rate 2 --frames 60 --for 900 \
        --bands lwir --threads 1 --set exercise.listen_s=0.5 --set quality.budget=off --no-png --set publish.planes=none >"$tmp/disk.out" 2>&1 &
    node[disk]=$!
    heard_by disk 'listening on'
    sender demo --set duration_s=900 --send 127.0.0.1:$port
    ended disk
    end_sender
    check "a disk with room again: the node ends well" [ $code = 0 ]
    check "every frame is made" grep -q 'frames made 60,' "$tmp/disk.out"
    check "said once each, that it is full and that there is room" \
        [ "$(said_times disk 'going on without')" -le 2 -a "$(said_times disk ' again; [0-9]+ frames lack')" -ge 1 ]
    check "counted" [ "$(tr -d ' \n' <"$tmp/disk.json" | grep -oE '"files_failed":[0-9]+' | cut -d: -f2)" -ge 1 ]
else
    echo "skipped in part: this user may not mount a file system of their own: no full disk"
fi
finish
