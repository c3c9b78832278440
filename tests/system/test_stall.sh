#!/usr/bin/env bash
# A consumer that stalls costs its own frames alone: the disk of a live node's video hangs, later that of its truth.jsonl; a receiver
# of its stream is stopped, and a reader of its shared memory. The others get every frame, and the node ends by itself.
# labels: two small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "video, and disks that can be made to hang: built without FFmpeg's libraries, or sanitized" \
    eval 'has_video && [ -f "$build/tests/libstall_disk.so" ]'
. "$(dirname "$0")/stall.sh"

# all_of NAME CONSUMER: each frame was given to it or counted as left out, and it got more than the one that hangs
all_of() {
    local got
    got=$(consumer $1 $2 count)
    [ $((got + $(consumer $1 $2 left_out))) = "$(frames_of $1)" ] && [ "$got" -gt "$(consumer $1 $hung count)" ]
}

hung=video_file
stalled hangs .ts --video "$tmp/hangs.ts" --frames 45
check "the video's disk hangs: every frame is made" [ "$(frames_of hangs)" = 45 ]
check "the ring and the truth lack none" [ "$(consumer hangs memory count) $(lines_in "$tmp/hangs/truth.jsonl")" = "45 45" ]
check "the stream lacks none but those that this machine was too busy for" all_of hangs video
check "and all of it arrived" [ "$(frames_in_stream)" = "$(consumer hangs video count)" ]
check "what the file lacks is counted" [ "$(consumer hangs video_file left_out)" -ge 1 ]
check "and said, while it runs and at the end" \
    [ "$(said_times hangs 'do not keep up with the frames: video_file [0-9]+')" -ge 1 -a "$(said_times hangs 'hangs.ts lacks [0-9]+ frames')" = 1 ]
check "the node ends by itself, gives the file up, and says so ($code)" [ $code = 1 -a "$(said_times hangs 'hangs.ts: the system has taken nothing')" = 1 ]

hung=truth_lines
stalled truth truth.jsonl --latest --frames 20
check "the disk of truth.jsonl hangs: every frame is made" [ "$(frames_of truth)" = 20 ]
check "the ring lacks none" [ "$(consumer truth memory count)" = 20 ]
check "the stream and the latest pictures have what the truth lacks" eval 'all_of truth video && all_of truth latest'
check "lines are left out and counted" [ "$(consumer truth truth_lines left_out)" -ge 1 ]
check "and the node ends by itself ($code)" [ $code = 1 -a "$(said_times truth 'truth.jsonl: the system has taken nothing')" = 1 ]
finish
