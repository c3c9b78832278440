#!/usr/bin/env bash
# A full disk: a live node writes into a file system of its own, which is too small. Every frame that is due is made; what is lost
# is counted and said once. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "file system of one's own for this user to mount" own_disk

mkdir "$tmp/disk"
free_port
unshare -rm bash -c "mount -t tmpfs -o size=16k none '$tmp/disk' && \"\$@\"" bash "$pitviper" run "${bare[@]}" --out "$tmp/disk/out" \
    --address 127.0.0.1 --port $port --size 48x36 --rate 5 --frames 5 --for 900 --bands lwir --threads 1 \
    --set exercise.listen_s=0.5 --set quality.budget=off >"$tmp/full.out" 2>&1 &
node[full]=$!
sender demo --set duration_s=900 --send 127.0.0.1:$port
ended full
end_sender
check "a full disk: exit code 1" [ $code = 1 ]
check "every frame is made" grep -q 'frames made 5,' "$tmp/full.out"
check "said once of images, once of truth" is "$(said_times full 'going on without')" '<=' 2
check "and counted" grep -qE 'frames without their files: .* [1-9][0-9]* could not be written' "$tmp/full.out"
finish
