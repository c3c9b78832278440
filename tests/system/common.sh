# What the system tests share. Source it with the build folder as first argument of the script:
#     . "$(dirname "$0")/common.sh"
# Gives $build, $pitviper, an empty folder $tmp that goes away at the end, and the checks
# below. A failed check says so and is counted; finish gives the verdict, so that one run shows all failures.
set -u
# shellcheck disable=SC2034
export LC_ALL=C
# python3 has the modules of tests/judges.txt, once `etc/setup --tests` has run
PATH=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/build/judges/bin:$PATH
build=${1:?usage: bash $0 BUILD_FOLDER}
pitviper=$build/pitviper
[ -x "$pitviper" ] || { echo "skipped: no $pitviper"; exit 77; }
tmp=$(mktemp -d) || exit 1
export XDG_CACHE_HOME=$tmp/cache # nothing of the user's, and empty
# also what it has in the background ends with a script
clean_up() { kill -KILL $(jobs -p) 2>/dev/null; chmod -R u+w "$tmp" 2>/dev/null; rm -rf "$tmp"; }
trap clean_up EXIT

checks=0
failures=0
fail() { failures=$((failures + 1)); echo "FAILED: $*"; }
check() { # check WHAT CONDITION...: runs the condition
    local what=$1; shift
    checks=$((checks + 1))
    "$@" || fail "$what"
}
finish() {
    echo "$checks checks, $failures failed"
    [ "$failures" -eq 0 ] && [ "$checks" -gt 0 ]
    exit
}

# What a script needs is asked for before its first check. Without it the whole script is skipped (exit 77), never a part of it:
# a part that needs more than the rest is a script of its own.
skip() {
    echo "skipped: $*"
    [ $failures -eq 0 ] || finish
    exit 77
}
# needs WHAT CONDITION...: of this machine or this build, which no package changes
needs() {
    local what=$1; shift
    "$@" >/dev/null 2>&1 || skip "no $what"
}
# needs_data FILE: of $PITVIPER_DATA, which a public machine has not; the folder is $data
needs_data() {
    data=${PITVIPER_DATA:-../shared/data}
    needs "reference data $data/$1 (set PITVIPER_DATA)" test -r "$data/$1"
}
# judges NAME...: independent programs, and Python modules as python3.NAME; `etc/setup --tests` installs all. With CI=true it is
# a failure that one is missing
judges() {
    local name missing=()
    for name; do
        case $name in
            python3.*) python3 -c "import importlib.util as u, sys; sys.exit(not u.find_spec('${name#*.}'))" 2>/dev/null ;;
            gst.*) gst-inspect-1.0 "${name#*.}" >/dev/null 2>&1 ;;
            *) command -v "$name" >/dev/null ;;
        esac || missing+=("$name")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    [ "${CI:-}" != true ] || { fail "no ${missing[*]}: etc/setup --tests installs it"; finish; }
    skip "no ${missing[*]} (etc/setup --tests)"
}
# has_video: this program was built with FFmpeg's libraries
has_video() {
    echo 'publish: {stream: "udp://127.0.0.1:5004"}' >"$tmp/video.yaml"
    "$pitviper" check "$tmp/video.yaml"
}

# has_projector: this program was built with SDL2
has_projector() {
    echo 'projector: {band: lwir}' >"$tmp/projector.yaml"
    "$pitviper" check "$tmp/projector.yaml"
}

# Most tests are of other things than plants, buildings and heat, which cost seconds a run: bare ground, warmed up in few steps,
# unless their options say otherwise. Tests of heat or of radiances have $full in place of $bare.
full=(--set terrain.woods=off --set terrain.buildings=off --set terrain.clutter=0)
quickly=(--set heat.facets=3 --set heat.step_s=1800 --set heat.shadow_m=64 --set heat.vehicle_step_s=600)
bare=("${full[@]}" "${quickly[@]}")
built=(--set terrain.woods=off "${quickly[@]}") # in place of $bare: with the buildings and clutter of the settings
# run ARGUMENTS: pitviper, with standard output, standard error and exit code in $tmp/stdout, $tmp/stderr, $code
run() {
    case ${1:-} in replay|run) set -- "$1" "${bare[@]}" "${@:2}" ;; esac
    "$pitviper" "$@" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
    [ $code -lt 124 ] || { fail "pitviper $* ended with $code"; tail -n 20 "$tmp/stderr"; }
}
# replay LOG OUT options: a quick small one unless options say otherwise; in place of what was there
replay() { local log=$1 out=$2; shift 2; run replay "$log" --out "$out" --size 96x64 --rate 1 --threads 2 --overwrite "$@"; }

# exercise NAME LOG options: a recorded one; KEY=VALUE stands for --set KEY=VALUE
exercise() {
    local name=$1 log=$2 option options=(); shift 2
    for option; do case $option in -*|/*) ;; *=*) options+=(--set) ;; esac; options+=("$option"); done
    "$pitviper" exercise "$name" --overwrite -o "$log" "${options[@]}" >/dev/null || fail "exercise $name ${options[*]}"
}

frames() { find "$1/frames/${2:-truth}" -name '*.exr' 2>/dev/null | wc -l; }
# run_json OUT: on one line, without blanks
run_json() { tr -d ' \n' <"$1/run.json"; }
host_of() { run_json "$1" | grep -oE '"hosts":\["[0-9:]+"' | grep -oE '[0-9]+:[0-9]+:[0-9]+'; }
hashes() { run_json "$1" | grep -o '"frame_sha256":\[[^]]*\]'; }
# json_numbers FILE KEY: every value of that key, one a line
json_numbers() { grep -oE "\"$2\": *-?[0-9.eE+-]+" "$1" | sed 's/.*: *//'; }
said() { grep -qiE -e "$1" "$tmp/stderr" "$tmp/stdout"; }
complained() { grep -qiE -e "$1" "$tmp/stderr"; }
# is A OP B, for numbers that are not integers; false when either is missing
is() { awk -v a="${1:-nan}" -v b="${3:-nan}" "BEGIN { exit !(a + 0 == a && b + 0 == b && a + 0 $2 b + 0) }"; }
same_hashes() { [ -n "$(hashes "$1")" ] && [ "$(hashes "$1")" = "$(hashes "$2")" ]; }
not() { ! "$@"; }
xml() { python3 -c 'import sys, xml.dom.minidom as d; d.parse(sys.argv[1])' "$1"; }
# until_true CONDITION...: looks until it is true, however long that takes on a busy machine; false after $patience seconds,
# which only a hang reaches
patience=200
until_true() {
    local end=$((SECONDS + patience))
    until "$@"; do
        [ $SECONDS -lt $end ] || return 1
        sleep 0.05
    done
}
lines_in() { cat "$1" 2>/dev/null | wc -l; }
has_lines() { [ "$(lines_in "$1")" -ge "$2" ]; } # has_lines FILE COUNT
quiet() { "$@" >/dev/null 2>&1; }
# same_planes A B: of the bands that both have, to the bit. What differs is printed.
same_planes() {
    local said
    said=$("$build/tests/picture_difference" "$1" "$2" 2>&1) || { echo "$said"; return 1; }
    ! grep -v ' changed 0 ' <<<"$said"
}
# regress_case NAME: its log in $tmp/NAME.pcap, and the options it is seen with in the array case_options
# shellcheck disable=SC2034
regress_case() {
    local folder=tests/regress/$1
    case_options=(--config "$tmp/$1.yaml")
    sed -n '/^config: |$/,/^[^ ]/s/^  //p' "$folder/case.yaml" >"$tmp/$1.yaml"
    [ -s "$tmp/$1.yaml" ] || fail "$folder/case.yaml: no 'config: |'"
    [ -f "$tmp/$1.pcap" ] || exercise "$folder/scenario.yaml" "$tmp/$1.pcap"
}

# box_obj NAME X0 X1 Y0 Y1 Z0 Z1 [MATERIAL]: a box as an OBJ file
box_obj() {
    local name=$1 x0=$2 x1=$3 y0=$4 y1=$5 z0=$6 z1=$7 z
    echo "o $name"
    for z in $z0 $z1; do printf 'v %s\n' "$x0 $y0 $z" "$x1 $y0 $z" "$x1 $y1 $z" "$x0 $y1 $z"; done
    [ $# -lt 8 ] || echo "usemtl $8"
    printf 'f %s\n' '1 4 3 2' '5 6 7 8' '1 2 6 5' '2 3 7 6' '3 4 8 7' '4 1 5 8'
}

# For tests that look at no shape closely: vehicles of fewer facets, ground of fewer posts; half of a replay's start.
# shellcheck disable=SC2034
coarse=(--set models.sag_m=0.02 --set terrain.spacing_m=30)
# And at no radiance or ground either; bare=("${quick[@]}") gives it to every run.
# shellcheck disable=SC2034
quick=("${bare[@]}" "${coarse[@]}" --set terrain.detail=off --set heat.step_s=3600 --set heat.shadow_m=0)
