# What the tests of failing consumers share; source it after common.sh and live.sh.
frames_of() { json_numbers "$tmp/$1/run.json" frames | tail -n 1; }
# consumer OUT NAME FIELD: of latency_ms.consumers in its run.json
consumer() { run_json "$tmp/$1" | grep -oE "\"$2\":\{\"[a-z][^}]*\}" | tail -n 1 | grep -oE "\"$3\":[0-9.]+" | cut -d: -f2; }
said_times() { grep -cE -e "$2" "$tmp/$1.out"; } # said_times NAME TEXT
others=() # processes that end with the test
trap 'kill -KILL "${others[@]}" 2>/dev/null; wait "${others[@]}" 2>/dev/null; clean_up' EXIT
# own_disk: a file system of one's own can be mounted; by root of a user name space
own_disk() { unshare -rm true && unshare -rm bash -c "mount -t tmpfs -o size=4k none '$tmp'"; }
# encoder that fails: has_video and libfail_encoder.so, which sanitized builds have not
can_fail_encoder() { has_video && [ -f "$build/tests/libfail_encoder.so" ]; }
# watched NAME options: 11 frames of a replay by the clock, 48x36, one band, without files and truth
watched() {
    local name=$1; shift
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/$name" --size 48x36 --bands lwir --rate 10 --from 1364 --to 1365 --threads 1 \
        --speed 1 --no-files --set publish.truth=false "$@" >"$tmp/$name.out" 2>&1
    code=$?
}
# watched_long NAME SECONDS options: another replay by the clock, 5 frames a second
watched_long() {
    local name=$1 seconds=$2; shift 2
    "$pitviper" replay "${bare[@]}" "$tmp/crowd.pcap" --out "$tmp/$name" --size 64x48 --bands lwir --rate 5 --to +$seconds --threads 1 \
        --speed 1 --no-files --set quality.budget=off "$@" >"$tmp/$name.out" 2>&1
    code=$?
}
# reader NAME options: the example reader of the shared memory $memory in the background, its process in $reader
memory=pitviper_failures_$$
reader() {
    local name=$1; shift
    [ -x "$tmp/reader" ] || cc -O1 -I etc/include etc/examples/read_memory.c -o "$tmp/reader" || fail "the example reader is not built"
    "$tmp/reader" $memory --wait $patience "$@" >"$tmp/$name" 2>&1 &
    reader=$!
    others+=($reader)
}
