#!/usr/bin/env bash
# A program with one thing wrong is noticed, and by the planes that the wrong thing is about: each of tests/mutants, and
# a copy of etc/ with one reflectance off, on the exercise of tests/regress that shows it.
. "$(dirname "$0")/common.sh"
tools=$build/tests
if [ ! -d "$tools/mutants" ]; then
    echo "skipped: no mutants in this build (they are left out under sanitizers)"
    exit 77
fi

# compare A B: one line a plane, as tests/tools/picture_difference.c says; exit code 2: other frames
compare() { "$tools/picture_difference" "$1" "$2"; }

# replayed PROGRAM CASE OUT: the case's exercise, as its first lines say it is seen
replayed() {
    regress_case "$2"
    "$1" replay "$tmp/$2.pcap" --out "$3" --size 96x64 --threads 2 --no-png "${case_options[@]}" >"$tmp/stdout" 2>"$tmp/stderr" || {
        fail "$1 does not replay $2"
        cat "$tmp/stderr"
    }
}

# column OUTPUT PLANES NAME: the largest of a column over planes that match
column() { awk -v planes="^($2)\$" -v name="$3" '$2 ~ planes { for (i = 3; i < NF; i++) if ($i == name && $(i + 1) > most) most = $(i + 1) }
    END { print most + 0 }' "$1"; }

geometry='truth\.(entity|part|material|range_m|n.)'
# caught MUTANT PROGRAM CASE LEAST PLANES SAME: at least LEAST pixels of one of PLANES differ clearly, none of SAME by a bit
caught() {
    local mutant=$1 program=$2 case=$3 least=$4 planes=$5 same=$6 found
    checks=$((checks + 1))
    [ -d "$tmp/$case" ] || replayed "$pitviper" "$case" "$tmp/$case"
    replayed "$program" "$case" "$tmp/$case-$mutant"
    check "$mutant: other hashes" not same_hashes "$tmp/$case" "$tmp/$case-$mutant"
    compare "$tmp/$case" "$tmp/$case-$mutant" >"$tmp/planes" || { fail "$mutant: cannot be compared"; return; }
    found=$(column "$tmp/planes" "$planes" clear)
    printf '%-20s %-13s clear: %s\n' "$mutant" "$case" \
        "$(awk '{ for (i = 3; i < NF; i++) if ($i == "clear" && $(i + 1) > 0) printf "%s %d  ", $2, $(i + 1) }' "$tmp/planes")"
    check "$mutant: $found pixels differ clearly in $planes; at least $least" [ "$found" -ge "$least" ]
    [ -z "$same" ] || check "$mutant: not a bit of $same" [ "$(column "$tmp/planes" "$same" changed)" = 0 ]
    rm -rf "${tmp:?}/$case-$mutant"
}
mutant() { caught "$1" "$tools/mutants/pitviper_mutant_$1" "${@:2}"; }

# Half of what was counted when this was written, so that another scene of the same kind still passes.
mutant sun                 tank         120 'optical\..'           "$geometry|radar.Y"
mutant dead_reckoning      impact       150 'truth\.entity'        ''
mutant dead_reckoning_body tank           8 'truth\.entity'        ''
mutant delay               dis7        1600 'truth\.entity'        ''
mutant delay_tick          dis7          28 'truth\.entity'        ''
mutant joint               antimeridian 110 'truth\.entity'        ''
mutant emissivity          pole       20000 '[ml]wir\.Y'           "truth.*|optical.*|radar.Y"
mutant lobe                helicopter    95 'radar\.Y'             "truth.*|optical.*|.wir.Y"

# a plane that no mutant but one may touch is only worth something if the unspoilt program never does
replayed "$pitviper" tank "$tmp/again"
check "the program itself: the same bits again" same_hashes "$tmp/tank" "$tmp/again"
compare "$tmp/tank" "$tmp/again" >"$tmp/planes"
check "and no plane that differs" [ "$(column "$tmp/planes" '.*' changed)" = 0 ]

# what follows the first PDU of a datagram is lost: vehicles are missing
replayed "$pitviper" bundles "$tmp/bundles"
replayed "$tools/mutants/pitviper_mutant_bundle" bundles "$tmp/bundles-lost"
check "bundle: other hashes" not same_hashes "$tmp/bundles" "$tmp/bundles-lost"
seen() { json_numbers "$1/truth.jsonl" pixels | wc -l; }
printf '%-20s %-13s targets: %d of %d\n' bundle bundles "$(seen "$tmp/bundles-lost")" "$(seen "$tmp/bundles")"
check "bundle: fewer targets" [ "$(seen "$tmp/bundles-lost")" -lt "$(seen "$tmp/bundles")" ]

# one reflectance: green of olive paint, a tenth more
cp -r etc "$tmp/etc"
awk -F, -v OFS=, '$1 == "paint_olive" { $3 = $3 * 1.1; found++ } { print } END { exit found != 1 }' etc/materials.csv >"$tmp/etc/materials.csv" ||
    fail "etc/materials.csv: paint_olive does not stand there once"
PITVIPER_ETC=$tmp/etc caught material "$pitviper" dis7 680 'optical\.G' "truth.*|optical.[RB]|.wir.Y|radar.Y"

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
