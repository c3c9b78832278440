# What the tests of `pitviper fly` in the loop share: a short engagement, and small frames.
cat >"$tmp/short.yaml" <<'END'
duration_s: 12
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 8, route_m: [[0, 0], [60, 120], [80, 300]]}
  - {name: Tank, id: 22, type: 1.1.222.1.1.1.0, force: 2, speed_mps: 6, route_m: [[-40, 30], [20, 130], [40, 300]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [1300, 100], height_m: 90, heading_deg: 265}
shots:
  - {name: Missile, id: 41, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 21, time_s: 1, flies: ir_ag}
END
small=(--size 96x64 --bands lwir --rate 10 --planes none --set publish.memory_record=truth --no-png "${bare[@]}")
knows="python3 $(dirname "$0")/../tools/loop_recogniser.py 1:3001:21" # a recogniser that knows the truth
# loop NAME OPTIONS...: a flight whose table is in $tmp/NAME.csv; further options of its frames in $more
loop() {
    local name=$1; shift
    run fly "$tmp/short.yaml" --overwrite "$@" -- "${small[@]}" "${more[@]}"
    cp "$tmp/stdout" "$tmp/$name.csv"
    check "$name: ended with $code: $(tail -n 2 "$tmp/stderr")" [ "$code" = 0 ]
    tail -n 1 "$tmp/$name.csv"
}
more=()
cell() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == 2 { print $c }' "$tmp/$1.csv"; }
