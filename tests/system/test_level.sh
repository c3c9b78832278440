#!/usr/bin/env bash
# A display's automatic level, by default: from frame to frame as its time constant says, and no flicker where sky and
# ground change places; begins with the first frame made, and touches nothing but displays.
. "$(dirname "$0")/common.sh"

# the helicopters and people of that scenario
sed "/^  - name: Jet/,/^    turret: swing/d" etc/scenarios/aircraft.yaml >"$tmp/air.yaml"
exercise "$tmp/air.yaml" "$tmp/air.pcap"
span=(--rate 5 --from 1373.6 --to 1376.2 --bands lwir --pairs target --size 96x64 --set terrain.detail=off)

# levels OUT: a line a frame: number, time, black, white of its display
levels() {
    sed -nE 's/^\{"frame":([0-9]+),"time_s":([0-9.]+),.*"display":"frames\/lwir\/[0-9]*\.png","level":\[([0-9.e+-]+),([0-9.e+-]+)\].*"target":true,"noise":false.*/\1 \2 \3 \4/p' \
        "$1/pairs.jsonl"
}
# steps OUT: largest change of black or white between frames, over the first frame's span
steps() {
    levels "$1" | awk 'NR == 1 { s = $4 - $3 } NR > 1 { for (k = 3; k <= 4; k++) { d = $k - was[k]; if (d < 0) d = -d; if (d > w) w = d } }
        { was[3] = $3; was[4] = $4 } END { print (NR > 10 ? w / s : "nothing") }'
}
replay "$tmp/air.pcap" "$tmp/own" "${span[@]}" --set detector.agc_s=0
replay "$tmp/air.pcap" "$tmp/default" "${span[@]}"
check "14 frames" [ "$(levels "$tmp/default" | wc -l)" = 14 ]
check "each by itself: it jumps" is "$(steps "$tmp/own")" '>' 0.2
check "by default: by an eighth at most, as 0.2 s of 2 s and what was not followed before are" is "$(steps "$tmp/default")" '<' "$(steps "$tmp/own" | awk '{ print 0.125 * $1 }')"

# The closed form: to each frame's own level by 1 - exp(-0.2 s / 2 s), from the first one's.
worst=$(paste -d' ' <(levels "$tmp/own") <(levels "$tmp/default") | awk '
    $1 != $5 { print "frames differ"; exit }
    NR == 1 { low = $3; high = $4; was = $2 }
    { share = 1 - exp(-($2 - was) / 2); low += share * ($3 - low); high += share * ($4 - high); was = $2
      d = ($7 - low) / high; if (d < 0) d = -d; e = ($8 - high) / high; if (e < 0) e = -e
      if (d > w) w = d; if (e > w) w = e }
    END { print w + 0 }')
check "level: as its time constant says" is "$worst" '<' 1e-9
check "pictures: no plane is touched" same_hashes "$tmp/own" "$tmp/default"

# A part begins anew: its first display is by itself, its planes are those of the whole.
replay "$tmp/air.pcap" "$tmp/part" "${span[@]}" --only 125,127
check "--only: two frames" [ "$(levels "$tmp/part" | wc -l)" = 2 ]
check "--only: the first by itself" cmp -s "$tmp/part/frames/lwir/000125.png" "$tmp/own/frames/lwir/000125.png"
differ() { [ -s "$1" ] && [ -s "$2" ] && ! cmp -s "$1" "$2"; }
sha() { grep "\"frame\":127," "$1/truth.jsonl" | grep -o '"frame_sha256":"[0-9a-f]*"'; }
check "--only: planes as in the whole" [ "$(sha "$tmp/part")" = "$(sha "$tmp/default")" ]
check "--only: and there they are" [ -n "$(sha "$tmp/part")" ]
# Plateau equalisation: other displays of the same planes, with the same time constant; one frame by itself, alike.
replay "$tmp/air.pcap" "$tmp/plateau" "${span[@]}" --only 125,127 --set detector.level=plateau
check "plateau: planes as in the whole" [ "$(sha "$tmp/plateau")" = "$(sha "$tmp/default")" ]
check "plateau: other grey levels" differ "$tmp/plateau/frames/lwir/000125.png" "$tmp/part/frames/lwir/000125.png"
replay "$tmp/air.pcap" "$tmp/plateau_own" "${span[@]}" --only 125,127 --set detector.level=plateau --set detector.agc_s=0 --threads 1
check "plateau: the first by itself" cmp -s "$tmp/plateau/frames/lwir/000125.png" "$tmp/plateau_own/frames/lwir/000125.png"
check "plateau: the next follows it" differ "$tmp/plateau/frames/lwir/000127.png" "$tmp/plateau_own/frames/lwir/000127.png"
replay "$tmp/air.pcap" "$tmp/again" "${span[@]}" --only 125,127 --threads 1
check "the same frames, the same displays" cmp -s "$tmp/part/frames/lwir/000127.png" "$tmp/again/frames/lwir/000127.png"
finish
