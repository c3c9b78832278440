#!/usr/bin/env bash
# A program with one thing wrong is caught by `pitviper regress`, by the cases of tests/regress, and the channel that the
# wrong thing is about is named first: each of tests/mutants, and a copy of etc/ with one reflectance off. The records are
# made here, of three of the cases in small pictures, with coarse vehicles and ground that start quickly; against the
# approved records, each mutant by the case that is about it: test_mutants_deep.sh. That the program itself passes these
# cases, to the bit: test_regress_suite.sh. labels: two
. "$(dirname "$0")/common.sh"
mutants=$build/tests/mutants
if [ ! -d "$mutants" ]; then
    echo "skipped: no mutants in this build (they are left out under sanitizers)"
    exit 77
fi

# one reflectance: green of olive paint, a tenth more
cp -r etc "$tmp/etc"
awk -F, -v OFS=, '$1 == "paint_olive" { $3 = $3 * 1.1; found++ } { print } END { exit found != 1 }' etc/materials.csv >"$tmp/etc/materials.csv" ||
    fail "etc/materials.csv: paint_olive does not stand there once"

approved=${PITVIPER_MUTANTS_APPROVED:-no}
# mutant/case/how its line begins/which channels may fail after that one
mutants_table() {
    local instead=()
    [ "$approved" = yes ] || instead=(-e s,/antimeridian/,/tank/, -e s,/pole/,/tank/, -e s,/helicopter/,/dis7/,)
    sed -e '' "${instead[@]}" <<'TABLE'
material/dis7/optical: optical\.G: /target signals|error budget
sun/tank/sun: sun\.azimuth_deg /temperature|optical|mwir|lwir|target signals|error budget
sun_light/tank/optical: optical\./temperature|mwir|lwir|target signals|error budget
dead_reckoning/dis7/pose: host\./.*
dead_reckoning_body/tank/pose: host\./.*
delay/dis7/motion: targets\[[0-9:]+\]\.age_s /.*
delay_tick/dis7/motion: targets\[[0-9:]+\]\.age_s /.*
joint/antimeridian/entity: /.*
emissivity/pole/mwir: /lwir|target signals|error budget
lobe/helicopter/radar: /radar profile|target signals|error budget
bundle/bundles/counters: /.*
TABLE
}
check "each mutant is in the table" [ "$(printf '%s\n' "$mutants"/pitviper_mutant_* | sed 's/.*_mutant_//' | sort)" = "$(mutants_table | sed '/^material/d; s,/.*,,' | sort)" ]

# the cases: copies with a quick start and a record of the program's own
folders=tests/regress
if [ "$approved" = no ]; then
    folders=$tmp/cases
    # the first and the last frame
    quickly='s/^scenario: .*/log: log.pcap/; /detail: off/d; s/width_px: .*/width_px: 48/; s/height_px: .*/height_px: 32/
        s/^\(frames: .[0-9]*,\).*,/\1/
        s/^    woods: off/&\n    detail: off\n    spacing_m: 30\n  models: {sag_m: 0.02}/
        s/^causal/  heat: {facets: 3, step_s: 1800, shadow_m: 64, vehicle_step_s: 600}\n&/'
    mkdir "$folders"
    for name in $(mutants_table | cut -d/ -f2 | sort -u); do
        mkdir "$folders/$name"
        exercise "tests/regress/$name/scenario.yaml" "$folders/$name/log.pcap"
        sed "$quickly" "tests/regress/$name/case.yaml" >"$folders/$name/case.yaml"
    done
    run regress --update "$folders"/*/ --why 'for mutants' --threads 1
    check "records" [ $code = 0 ] || cat "$tmp/stdout" "$tmp/stderr"
fi

# regressed NAME PROGRAM CASE ...: in the background, as many at a time as there are processors
regressed() {
    local name=$1 program=$2; shift 2
    while [ "$(jobs -pr | wc -l)" -ge "$(nproc)" ]; do wait -n; done
    {
        "$program" regress "${@/#/$folders/}" --junit "$tmp/$name.xml" --work "$tmp/$name" --jobs 1 --threads 1 \
            >"$tmp/$name.out" 2>&1
        echo $? >"$tmp/$name.code"
    } &
}
while IFS=/ read -r name case _; do
    if [ "$name" = material ]; then PITVIPER_ETC=$tmp/etc regressed "$name" "$pitviper" "$case"
    else regressed "$name" "$mutants/pitviper_mutant_$name" "$case"; fi
done < <(mutants_table)
wait

while IFS=/ read -r name case said after; do
    line=$(sed -n "s/^$case  *FAILED: //p" "$tmp/$name.out")
    printf '%-20s %-13s %s\n' "$name" "$case" "${line:-passes}"
    check "$name: ends with 1" [ "$(cat "$tmp/$name.code")" = 1 ]
    check "$name: names $said" grep -qE "^$said" <<<"$line"
    sed -n '/<failure/,/^by hand/s/^\([a-z ]*\): .*/\1/p' "$tmp/$name.xml" >"$tmp/channels"
    check "$name: the channels that fail are known" [ -s "$tmp/channels" ]
    check "$name: none but $after after it" not grep -vxE "${said%%:*}|$after" "$tmp/channels"
done < <(mutants_table)

# a mutation whose text is gone, or stands there twice, is no mutation and no build
mutate() { # FROM TO
    printf 'set(source a.c)\nset(from [=[%s]=])\nset(to [=[%s]=])\n' "$1" "$2" >"$tmp/spoil.cmake"
    cmake -DMUTANT="$tmp/spoil.cmake" -DROOT="$tmp" -DOUT="$tmp/spoilt.c" -P tests/mutants/mutate.cmake >/dev/null 2>"$tmp/stderr"
}
refused() { ! mutate "$@" && grep -q "$3" "$tmp/stderr"; }
printf 'int a[] = {1; 2};\nint b = 2; /* $%s \\ */\n' '{x}' >"$tmp/a.c"
check "a mutation" mutate '{1; 2}' '{1; 3}'
check "changes that and nothing else" [ "$(diff "$tmp/a.c" "$tmp/spoilt.c")" = "$(printf '1c1\n< int a[] = {1; 2};\n---\n> int a[] = {1; 3};')" ]
check "text that is gone" refused '{1; 7}' x 'no longer holds'
check "text that stands there twice" refused int x 'more than once'
check "no change" refused 'b = 2' 'b = 2' '`to` is `from`'
finish
