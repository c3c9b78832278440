#!/usr/bin/env bash
# What takes the frames fails: readers of the shared memory that stop or die, a receiver of the stream that vanishes, an
# encoder that fails, a full disk. Every frame that is due is made; what is lost is counted and said once. Longer, with
# recovery: test_publish_failures_deep.sh. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

exercise demo "$tmp/demo.pcap"
frames_of() { json_numbers "$tmp/$1/run.json" frames | tail -n 1; }
# consumer OUT NAME FIELD: of latency_ms.consumers in its run.json
consumer() { run_json "$tmp/$1" | grep -oE "\"$2\":\{\"[a-z][^}]*\}" | tail -n 1 | grep -oE "\"$3\":[0-9.]+" | cut -d: -f2; }
said_times() { grep -cE -e "$2" "$tmp/$1.out"; } # said_times NAME TEXT
# watched NAME options: 11 frames of a replay by the clock, 48x36, one band, without files and truth
watched() {
    local name=$1; shift
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/$name" --size 48x36 --bands lwir --rate 10 --from 1364 --to 1365 --threads 1 \
        --speed 1 --no-files --set publish.truth=false "$@" >"$tmp/$name.out" 2>&1
    code=$?
}

# ---- a full disk: the live node writes into a file system of its own, which is too small -------------------------
own_disk() { unshare -rm true 2>/dev/null && unshare -rm bash -c "mount -t tmpfs -o size=4k none '$tmp'" 2>/dev/null; }
if own_disk; then
    mkdir "$tmp/disk"
    free_port
    unshare -rm bash -c "mount -t tmpfs -o size=16k none '$tmp/disk' && \"\$@\"" bash "$pitviper" run "${bare[@]}" --out "$tmp/disk/out" \
        --address 127.0.0.1 --port $port --size 48x36 --rate 5 --frames 5 --for 900 --bands lwir --threads 1 \
        --set exercise.listen_s=0.5 --set quality.budget=off >"$tmp/full.out" 2>&1 &
    node[full]=$!
    sender demo --set duration_s=900 --send 127.0.0.1:$port
else
    echo "skipped in part: this user may not mount a file system of their own: no full disk"
fi

# ---- readers of the shared memory, and a receiver of the stream -------------------------------------------------
name=pitviper_failures_$$
stream=udp://127.0.0.1:$((port + 3001))
if command -v cc >/dev/null && cc -O1 -I etc/include etc/examples/read_memory.c -o "$tmp/reader" 2>/dev/null; then
    # slow, so that it misses frames however late it is stopped
    "$tmp/reader" $name --wait $patience --slow 300 >"$tmp/stopped" 2>&1 & stopped=$!
    "$tmp/reader" $name --wait $patience >"$tmp/killed" 2>&1 & killed=$!
    "$tmp/reader" $name --wait $patience --in-order >"$tmp/reads" 2>&1 & reads=$!
    disown $killed
    (
        until_true test -s "$tmp/stopped"
        kill -STOP $stopped
        until_true test -s "$tmp/killed"
        kill -KILL $killed
    ) &
else
    reads=
    echo "skipped in part: no C compiler: no readers of the shared memory"
fi
options=(--memory $name)
"$pitviper" run --help | grep -q -- --stream && options+=(--stream "$stream")
preload=
[ -f "$build/tests/libfail_encoder.so" ] && preload=$build/tests/libfail_encoder.so
LD_PRELOAD=$preload FAIL_ENCODER=5,1 watched readers "${options[@]}"
check "readers that stop and die: the replay ends well" [ "$code" = 0 ] || cat "$tmp/readers.out"
check "readers that stop and die: every frame is made" [ "$(frames_of readers)" = 11 ]
check "and written" [ "$(consumer readers memory count)" = 11 -a "$(consumer readers memory left_out)" = 0 ]
check "without truth, as told: neither lines nor hashes, and the run says so" \
    [ ! -e "$tmp/readers/truth.jsonl" -a -z "$(hashes "$tmp/readers")" -a "$(grep -c 'no truth.jsonl' "$tmp/readers/run.json")" = 1 ]
run replay "$tmp/demo.pcap" --out "$tmp/plain" --set publish.truth=false
check "but not at full speed" [ $code = 1 ] && complained 'publish.truth: false is for'
check "the memory's name is gone" [ ! -e /dev/shm/$name ]
if [ -n "$reads" ]; then
    kill -CONT $stopped
    wait $reads
    check "a reader beside them gets every frame" [ "$(grep -c '^frame ' "$tmp/reads")" = 11 ] || tail -n 3 "$tmp/reads"
    check "the one that was stopped misses some" [ "$(grep -c '^frame ' "$tmp/stopped")" -lt 11 ]
    wait $stopped 2>/dev/null
fi
if grep -q "^video: $stream" "$tmp/readers.out"; then
    check "nothing receives: said once" [ "$(said_times readers 'no program receives it')" = 1 ]
    check "and counted" grep -qE "datagrams: sent=[0-9]+ refused=[1-9]" "$tmp/readers.out"
fi

# ---- the encoder, which fails at the sixth frame ----------------------------------------------------------------
if [ -n "$preload" ] && grep -q "^video: $stream" "$tmp/readers.out"; then
    check "an encoder that fails: said once" \
        [ "$(said_times readers 'the encoder .* failed')" = 1 -a "$(said_times readers 'going on without')" = 1 ]
    check "and counted" grep -qE ' 6 frames lack the video of lwir' "$tmp/readers.out"
    check "and it gets every frame" [ "$(consumer readers video count)" = 11 -a "$(consumer readers video left_out)" = 0 ]
else
    echo "skipped in part: no encoder, or none that can be made to fail"
fi

# ---- the disk, at the end -------------------------------------------------------------------------------------
if [ -d "$tmp/disk" ]; then
    ended full
    end_sender
    check "a full disk: exit code 1" [ $code = 1 ]
    check "every frame is made" grep -q 'frames made 5,' "$tmp/full.out"
    check "said once of images, once of truth" is "$(said_times full 'going on without')" '<=' 2
    check "and counted" grep -qE 'frames without their files: .* [1-9][0-9]* could not be written' "$tmp/full.out"
fi
finish
