#!/usr/bin/env bash
# `pitviper terrain import` says what there is to do before it does it, and refuses what is too much: a TIFF of 10^6 x 10^6 pixels
# without a block, a VRT of 10^8 x 10^8. Gaps cost no time, memory or disk; every phase ends with a signal. labels: small
. "$(dirname "$0")/common.sh"

# 10^6 x 10^6 float pixels of 0.1 m in tiles of 512, none of which is there: 61 MB of zeroes that take no room
python3 - "$tmp/s1M.tif" <<'PY'
import struct, sys
side, tile = 10**6, 512
tiles = ((side + tile - 1) // tile) ** 2
tags = [(256, 4, [side]), (257, 4, [side]), (258, 3, [32]), (259, 3, [1]), (262, 3, [1]), (277, 3, [1]), (322, 3, [tile]), (323, 3, [tile]),
        (324, 16, None), (325, 4, None), (339, 3, [3]), (33550, 12, [.1, .1, 0.]), (33922, 12, [0., 0., 0., 500000., 5200000., 0.]),
        (34735, 3, [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633])]
form, size = {3: 'H', 4: 'I', 12: 'd', 16: 'Q'}, {3: 2, 4: 4, 12: 8, 16: 8}
at = 16 + 8 + 20 * len(tags) + 8
head, extra = struct.pack('<2sHHHQQ', b'II', 43, 8, 0, 16, len(tags)), b''
lists = (at + 1023) // 1024 * 1024
for tag, kind, values in tags:
    if values is None:
        head += struct.pack('<HHQQ', tag, kind, tiles, lists if tag == 324 else lists + 8 * tiles)
        continue
    octets = struct.pack(f'<{len(values)}{form[kind]}', *values)
    if len(octets) > 8:
        head += struct.pack('<HHQQ', tag, kind, len(values), at + len(extra))
        extra += octets
    else:
        head += struct.pack('<HHQ', tag, kind, len(values)) + octets.ljust(8, b'\0')
with open(sys.argv[1], 'wb') as file:
    file.write(head + struct.pack('<Q', 0) + extra)
    file.truncate(lists + 12 * tiles)
PY
sparse=(terrain import "$tmp/s1M.tif" -o "$tmp/s.store")
# limited ARGUMENTS: what would fill the disk fails, at 200 MB
limited() {
    (ulimit -f 200000; exec "$pitviper" "$@") >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
}

limited "${sparse[@]}" --most-gb 1
check "too much is refused: exit code" [ $code = 1 ]
check "it is said before" said '^to do: 107[0-9.]* M posts, .* 0\.0 M pixels to read; 2\.[67][0-9]* GB to write'
check "and why, and what to do" complained '2\.[67][0-9]* GB to write .*--size takes a part.*--most-gb allows more'
check "nothing is left of it" [ -z "$(ls "$tmp" | grep '^s\.store')" ]

# small, within 400 000 pixels a side: all of them are looked at, none is read
limited "${sparse[@]}" --size 0.1x0.1 --horizon 20
check "a part of it is imported: exit code" [ $code = 0 ]
check "no pixel was to be read" said ' 0\.0 M pixels to read'
check "in memory that has nothing of its size" eval '[ "$(stat -c %s "$tmp/s.store")" -lt 100000000 ]'
run terrain info "$tmp/s.store"
check "it is a store" [ $code = 0 ]

cat >"$tmp/vast.vrt" <<'VRT'
<VRTDataset rasterXSize="99999999" rasterYSize="99999999"><SRS>EPSG:32633</SRS><GeoTransform>400000,0.001,0,5250000,0,-0.001</GeoTransform>
<VRTRasterBand dataType="Float32" band="1"></VRTRasterBand></VRTDataset>
VRT
limited terrain import "$tmp/vast.vrt" -o "$tmp/v.store" --size 0.1x0.1 --spacing 1
check "a vast one is refused: exit code" [ $code = 1 ]
check "by what it takes to decode" complained 'GB to decode, more than'

# a signal ends every phase: reading, posts, writing; nothing is left, and no process
phase=0
written() { [ -e "$tmp/t.store.tmp" ] && [ "$(du -k "$tmp/t.store.tmp" | cut -f1)" -gt 2000 ]; }
for wait in 'said ^to.do' 'test -e '"$tmp/t.store.tmp" written; do
    phase=$((phase + 1))
    : >"$tmp/stdout" # of the run before
    "$pitviper" terrain import "$tmp/s1M.tif" -o "$tmp/t.store" --size 1x1 >"$tmp/stdout" 2>"$tmp/stderr" &
    pid=$!
    until_true $wait
    kill -TERM $pid
    wait $pid
    code=$?
    check "phase $phase: SIGTERM: exit code 143, not $code" [ $code = 143 ]
    check "phase $phase: said" complained 'stopped: .* is as it was'
    check "phase $phase: no half store" [ -z "$(ls "$tmp" | grep '^t\.store')" ]
done
# what was started for it ends with it, also when it is killed
: >"$tmp/stdout"
"$pitviper" terrain import "$tmp/s1M.tif" -o "$tmp/k.store" --size 1x1 --horizon 60 >"$tmp/stdout" 2>"$tmp/stderr" &
pid=$!
until_true said '^to do'
readers=$(pgrep -P $pid | while read -r starter; do echo "$starter"; pgrep -P "$starter"; done)
kill -KILL $pid
wait $pid 2>/dev/null
check "there were processes that read" [ "$(wc -w <<<"$readers")" -ge 2 ]
none_left() { for reader in $readers; do ! grep -q pitviper-raster "/proc/$reader/comm" 2>/dev/null || return 1; done; }
check "they end when the program is killed" until_true none_left
finish
