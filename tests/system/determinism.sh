# What the comparisons of tracers and builds share; source it after common.sh.
cases=(tank antimeridian impact) # turning parts; the Earth's edge; smoke, dust and flame
# shown NAME CASE PROGRAM options: coarse vehicles and ground, and of the frames two, late ones
shown() {
    local name=$1 case=$2 program=$3; shift 3
    regress_case "$case"
    "$program" replay "$tmp/$case.pcap" --out "$tmp/$name" --overwrite --size 96x64 --threads 1 --no-png "${bare[@]}" "${case_options[@]}" \
        "${coarse[@]}" --only 5,7 "$@" \
        >"$tmp/stdout" 2>"$tmp/stderr" || { fail "$name: $program does not replay $case"; tail -n 5 "$tmp/stderr"; }
}

# same_as_avx2 ISA: every case, to the bit
same_as_avx2() {
    local isa=$1 case
    for case in "${cases[@]}"; do
        [ -d "$tmp/$case" ] || shown "$case" "$case" "$pitviper" --set sensor.preset=staring_lwir
        check "$case: some frames" [ "$(frames "$tmp/$case")" = 2 ]
        shown other "$case" "$pitviper" --set sensor.preset=staring_lwir --isa "$isa"
        check "$case, $isa: it is that" grep -q "\"isa\": *\"$isa\"" "$tmp/other/run.json"
        check "$case, $isa: same bits as avx2" same_hashes "$tmp/$case" "$tmp/other"
        check "$case, $isa: same planes in the files" same_planes "$tmp/$case" "$tmp/other"
        check "$case, $isa: same counts of the sensor" diff -rq "$tmp/$case/raw" "$tmp/other/raw"
        check "$case, $isa: same truth" cmp "$tmp/$case/truth.jsonl" "$tmp/other/truth.jsonl"
    done
}
