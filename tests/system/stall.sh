# What the tests of stalled consumers share; after common.sh, live.sh and publish_failures.sh.
# stalled NAME ENDING options: a live node, one band, 48x36, whose writes to files of that ending hang from the first on; it streams,
# and a reader of its ring and the receiver of its stream stop for a while. Its exit code in $code
stalled() {
    local name=$1 ending=$2; shift 2
    : >"$tmp/disk_hangs"
    : >"$tmp/$name.out"
    rm -f "$tmp/stream.ts" "$tmp/receiver" "$tmp/stopped_reader"
    free_port
    stream_port=$((port + 1000))
    python3 -c 'import socket, sys
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
s.bind(("127.0.0.1", int(sys.argv[1])))
with open(sys.argv[2], "wb", 0) as out:
    print("ready", flush=True)
    while True: out.write(s.recv(2048))' $stream_port "$tmp/stream.ts" >"$tmp/receiver" &
    others+=($!)
    receiver=$!
    until_true test -s "$tmp/receiver"
    LD_PRELOAD=$build/tests/libstall_disk.so STALL_NAME=$ending STALL_WHILE=$tmp/disk_hangs "$pitviper" run "${quick[@]}" --out "$tmp/$name" \
        --address 127.0.0.1 --port $port --size 48x36 --rate 10 --for 900 --bands lwir --threads 1 --host observer --no-files \
        --memory $memory --stream udp://127.0.0.1:$stream_port --set exercise.listen_s=0.5 --set quality.budget=off \
        --set publish.video_labels=off "$@" >"$tmp/$name.out" 2>&1 &
    node[$name]=$!
    heard_by $name 'listening on'
    sender demo --set duration_s=900 --send 127.0.0.1:$port
    until_true test -s "$tmp/stream.ts"
    kill -STOP $receiver # what comes meanwhile waits in its socket
    reader stopped_reader; stopped=$reader
    until_of $name test -s "$tmp/stopped_reader"
    kill -STOP $stopped
    ended $name
    end_sender
    kill -CONT $receiver
    kill -KILL $stopped
    until_true quiet_stream
    kill -KILL $receiver
    wait $receiver $stopped 2>/dev/null
    rm -f "$tmp/disk_hangs"
}
# quiet_stream: nothing has come for a while
quiet_stream() {
    local before
    before=$(stat -c %s "$tmp/stream.ts")
    sleep 0.3
    [ "$before" = "$(stat -c %s "$tmp/stream.ts")" ]
}
# frames_in_stream: packets of video that begin one
frames_in_stream() {
    python3 -c 'import sys
d = open(sys.argv[1], "rb").read()
print(sum(d[i] == 0x47 and (d[i + 1] & 0x5F) << 8 | d[i + 2] == 0x4100 for i in range(0, len(d), 188)))' "$tmp/stream.ts"
}
