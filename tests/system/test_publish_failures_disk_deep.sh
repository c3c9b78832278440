#!/usr/bin/env bash
# As test_publish_failures_disk.sh: a disk that is full from the start, and has room again after some seconds. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "file system of one's own for this user to mount" own_disk

free_port
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
finish
