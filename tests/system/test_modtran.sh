#!/usr/bin/env bash
# A model's folder of MODTRAN's tape7: of an air whose band figures are known in closed form, through `probe atmosphere`;
# LOWTRAN7's own tape7 against tables made without it; and what is said of files that are spoilt. labels: physics
. "$(dirname "$0")/common.sh"
judges python3.numpy
export PYTHONDONTWRITEBYTECODE=1
judge=tests/system/modtran_judge.py
mkdir "$tmp/spoilt"
python3 $judge write "$tmp"
convert() {
    python3 etc/atmosphere/make/modtran.py us1976 "$@" --temperature "$tmp/temperature.csv" >"$tmp/stdout" 2>"$tmp/stderr"
}
check "it is made" convert "$tmp/own" "$tmp"/{clear,hazy,sky}.tp7
check "what is whose is said" grep -qF 'of us1976: scattered light and phase functions; all of b, g, r, nir, mwir' "$tmp/stdout"
compare() { # compare: tau and radiance to 4 km, then of all
    cut -d, -f1-7 "$tmp/want.csv" >"$tmp/paths.csv"
    "$pitviper" probe atmosphere <"$tmp/paths.csv" >"$tmp/got.csv"
    python3 $judge compare "$tmp"
}
mapfile -t got < <(compare)
read -r near tau light <<<"${got[0]}"
check "$near paths to 4 km: transmittance within $tau" is "$tau" '<' 0.0001
check "and their radiance within $light" is "$light" '<' 0.0002
read -r all tau light <<<"${got[1]}"
check "all $all, to 40 km and three heights: within $tau" is "$tau" '<' 0.001
check "and their radiance within $light" is "$light" '<' 0.001
check "all are there" [ "$near $all" = "14 27" ]

# the sky from the ground: 2 km of its air upwards, over the cosine where that slants
printf 'model,visibility_km,band,observer_m,zenith_deg\n' >"$tmp/sky.csv"
for z in 0 60 80; do echo "$tmp/own,23,lwir,0,$z"; done >>"$tmp/sky.csv"
"$pitviper" probe sky <"$tmp/sky.csv" >"$tmp/got.csv"
sky=$(python3 $judge sky "$tmp")
check "its radiance within $sky" is "$sky" '<' 0.0002

# LOWTRAN7's tape7, four digits (radiance three), against the tables' five, which were made of its numbers
read -r depth light sun wrong area geometry < <(python3 $judge real)
check "LOWTRAN7's tape7: depths within $depth" is "$depth" '<' 0.0002
check "its radiance within $light" is "$light" '<' 0.001
check "its sun within $sun" is "$sun" '<' 0.0001
check "its cards" [ "$geometry" = True ]
check "of transmittance and depth the one of more digits is taken" is "$wrong" == 0
check "a response's triangle has its area within $area" is "$area" '<' 0.0001

python3 $judge spoil "$tmp" >"$tmp/spoilt.txt"
grep -v '^ok$' "$tmp/spoilt.txt"
check "18 ways to spoil a file are refused with their place" [ "$(grep -c '^ok$' "$tmp/spoilt.txt")" = 18 ]
check "a folder that is there" not convert "$tmp/own" "$tmp"/{clear,hazy,sky}.tp7
check "stays, and that is said" grep -q 'own exists; OUT is a new folder$' "$tmp/stderr"

# the same by a list: the cards then say nothing
{ echo file,run,visibility_km,observer_m,target_m,range_m,zenith_deg
  n=0; for h in 0 4000; do for z in 0 60 80; do n=$((n + 1)); echo "sky.tp7,$n,23,$h,,,$z"; done; done; } >"$tmp/runs.csv"
sed -i 's/^   \(0\|4\)\.00000 100\.00000 .*/   9.00000   9.00000   9.00000   9.00000   0.00000/' "$tmp/sky.tp7"
check "by a list" convert "$tmp/listed" "$tmp"/{clear,hazy,sky}.tp7 --runs "$tmp/runs.csv"
check "the folder is the same" diff -r "$tmp/own" "$tmp/listed"
sed -i 's/^sky.tp7,6/sky.tp7,7/' "$tmp/runs.csv"
check "a run that is not there" not convert "$tmp/other" "$tmp"/{clear,hazy,sky}.tp7 --runs "$tmp/runs.csv"
check "and its words" grep -q 'there is no run 7 of sky.tp7' "$tmp/stderr"

# a set of airs by weather: 300 K and 60 % are 15.2 g/m3 (Tetens), nearer to 13 g/m3 at 296 K than to 2 at 300 and 19 at 310
set=$tmp/set
mkdir "$set"
for air in dry own wet; do mv "$tmp/own" "$set/$air"; cp -r "$set/$air" "$tmp/own"; done
printf 'folder,air_temp_k,vapour_g_m3\ndry,300,2\nown,296,13\nwet,310,19\n' >"$set/weathers.csv"
exercise demo "$tmp/exercise.pcap"
picture() { run replay "$tmp/exercise.pcap" --bands lwir --size 64x48 --only 0 --no-png --threads 1 "${coarse[@]}" "$@"; }
picture --set weather.atmosphere="$set" --set weather.air_temp_k=300 --out "$tmp/o"
check "set: it runs" [ $code = 0 ]
check "set: the nearest" grep -qE "^air: .*/set/own is that of .*/set nearest to the weather" "$tmp/stdout"
check "set: what is still between them" grep -qE '^air: .*/set/own is of 15 C at the ground, the weather of 27 C; trans' "$tmp/stdout"
check "set: its files are recorded" grep -q '"atmosphere/.*/set"' "$tmp/o/run.json"
picture --set weather.atmosphere="$set/own" --set weather.air_temp_k=300 --out "$tmp/p"
check "set: the picture of that one" same_hashes "$tmp/o" "$tmp/p"
printf 'time_utc,air_temp_c\n2000-01-01T00:00:00Z,-10\n2099-01-01T00:00:00Z,-10\n' >"$tmp/frost.csv"
picture --set weather.atmosphere="$set/own" --set weather.day="$tmp/frost.csv" --out "$tmp/r"
check "what a weather file has is said too" grep -qE '^air: .*/set/own is of 15 C at the ground, the weather of -10 C; trans' "$tmp/stdout"
picture --set weather.atmosphere="$set" --out "$tmp/q"
check "set: no weather to choose by" complained 'set is a set of airs, .*: set weather.air_temp_k'
echo 'weather: {atmosphere: set, air_temp_k: 300}' | sed "s|set,|$set,|" >"$tmp/set.yaml"
run check "$tmp/set.yaml"
check "set: check" [ $code = 0 ]
sed -i 's/^own/..\/own/' "$set/weathers.csv"
run check "$tmp/set.yaml"
check "set: a folder elsewhere" complained "weathers.csv:3: column folder: '../own' is not the name of a folder beside this file"
finish
