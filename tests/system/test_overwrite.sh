#!/usr/bin/env bash
# --overwrite: a mistake is told before the world is set up, and nothing goes; one process a folder; no link is followed where
# files are written; unknown endings; products of bands that a new run has not go too.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/small_demo.sh"

# ---- an earlier run, and files of the user's own beside its products
shown "$tmp/a"
touch "$tmp/a/mine.txt" "$tmp/a/frames/lwir/mine.png"
before=$(cd "$tmp/a" && find . -type f | sort | xargs sha256sum)
# ---- a mistake with --overwrite: told before the world is set up, and nothing goes
now() { (cd "$tmp/a" && find . -type f | sort | xargs sha256sum); }
for mistake in "--bands optcal" "--set sensor.preset=hubble" "--video x.xyz" "--from 5000" "--only 9999" "--save-frame 9999" "--host 9:9:9" \
               "--video $tmp/no/such/x.mp4" "--speed 1 --set publish.dis=sensor --address 1.2.3.400"; do
    # shellcheck disable=SC2086
    shown "$tmp/a" --overwrite $mistake
    check "$mistake: refused" [ $code != 0 ]
    check "$mistake: nothing goes" [ "$before" = "$(now)" ]
    check "$mistake: before the ground is made" not said '^(ground|host):'
    case $mistake in --bands*|--set*|*xyz|--from*) ;; *) continue ;; esac
    # shellcheck disable=SC2086
    shown "$tmp/a" $mistake
    check "$mistake: told, and not that something exists" not complained exists
done
check "nothing of that name is made" [ ! -e x.xyz ]
# a host that may still appear, and does not: known only in the end
shown "$tmp/a" --overwrite --causal --host 9:9:9 --only 3
check "a host that never appears: refused, and nothing goes" [ "$code $before" = "1 $(now)" ]
shown "$tmp/demo.pcap/out"
check "no place for it: said" complained 'cannot write in .*demo.pcap/out: Not a directory.*--out'
check "no place for it: before the ground is made" not said '^ground:'
printf 'axes: {seed: [1, 2]}\n' >"$tmp/seeds.yaml"
shown "$tmp/sweep" --only 9999 --sweep "$tmp/seeds.yaml"
check "a sweep: nothing is made" [ $code = 1 -a ! -e "$tmp/sweep" ]

# ---- two processes, one folder
if command -v flock >/dev/null; then
    for command in "replay $tmp/demo.pcap" "run --for 1"; do
        # shellcheck disable=SC2086
        flock "$tmp/a" "$pitviper" $command --out "$tmp/a" --overwrite >"$tmp/stdout" 2>"$tmp/stderr"
        check "$command: a folder that another writes into: refused" [ $? = 1 ]
        check "$command: said" complained "another process is writing into $tmp/a; wait"
        check "$command: nothing goes" [ "$before" = "$(now)" ]
    done
    cp "$tmp/demo.pcap" "$tmp/busy.pcap"
    flock "$tmp/busy.pcap" "$pitviper" exercise demo --overwrite -o "$tmp/busy.pcap" >"$tmp/stdout" 2>"$tmp/stderr"
    check "a recording that another writes: refused" [ $? = 1 ]
    check "a recording that another writes: as it was" cmp -s "$tmp/demo.pcap" "$tmp/busy.pcap"
fi

# ---- links where files are written
mkdir -p "$tmp/else" && echo precious >"$tmp/else/000001.png" && echo precious >"$tmp/precious"
for name in frames frames/lwir pairs truth.jsonl lwir.klv; do
    rm -rf "$tmp/l" && mkdir -p "$tmp/l/$(dirname "$name")"
    case $name in *.*) ln -s "$tmp/precious" "$tmp/l/$name" ;; *) ln -s "$tmp/else" "$tmp/l/$name" ;; esac
    shown "$tmp/l" --only 1 --overwrite
    check "OUT/$name is a link: refused" [ $code = 1 ]
    check "OUT/$name is a link: said" complained "cannot write $tmp/l/$name.*symbolic link"
    check "OUT/$name is a link: not followed" [ "$(cat "$tmp/precious" "$tmp"/else/*)" = precious$'\n'precious ]
done
ln -s "$tmp/precious" "$tmp/l.pcap"; ln -s "$tmp/precious" "$tmp/l.mp4"; ln -s "$tmp/precious" "$tmp/l.png"
for words in "record --for 1 -o $tmp/l.pcap" "exercise demo -o $tmp/l.pcap" "run --for 1 --out $tmp/lr --record $tmp/l.pcap" \
             "replay $tmp/demo.pcap --out $tmp/lr --video $tmp/l.mp4" "model show tank --out $tmp/l.png" \
             "bench speed --csv $tmp/l.pcap" "regress tests/regress --junit $tmp/l.pcap"; do
    # shellcheck disable=SC2086
    "$pitviper" $words $([[ $words = model* || $words = bench* || $words = regress* ]] || echo --overwrite) >"$tmp/stdout" 2>"$tmp/stderr"
    check "${words%% *}: a link is not followed" [ $? != 0 -a "$(cat "$tmp/precious")" = precious ]
    check "${words%% *}: said" complained 'symbolic link'
done

# ---- endings
for words in "record --for 1 -o $tmp/x.xyz" "exercise demo -o $tmp/x.xyz" "run --for 1 --record $tmp/x.xyz" "heat tank -o $tmp/x.png" \
             "rcs sphere:1 -o $tmp/x.svg" "model show tank --out $tmp/x.jpg"; do
    # shellcheck disable=SC2086
    "$pitviper" $words >"$tmp/stdout" 2>"$tmp/stderr"
    check "$words: refused" [ $? != 0 ]
    check "$words: what may be" complained '\.pcapng or \.pcap|names a folder|ends with \.png'
done
check "unknown endings: nothing is made" [ -z "$(ls "$tmp"/x.* 2>/dev/null)" ]

# ---- --overwrite: another band's products go too, of a channel that this run has not
shown "$tmp/swir" --only 1 --bands swir --latest --set publish.klv_files=true
check "swir" [ $code = 0 -a -s "$tmp/swir/frames/swir/000001.png" -a -s "$tmp/swir/swir.klv" ]
mkdir "$tmp/swir/frames/notes" && touch "$tmp/swir/frames/notes/000001.png.txt"
shown "$tmp/swir" --only 1 --overwrite
check "--overwrite: no product of another band" [ -z "$(find "$tmp/swir" -name '*swir?*')$(find "$tmp/swir/" -mindepth 1 -name swir)" ]
check "--overwrite: what is not of a run stays, of another band too" [ -e "$tmp/swir/frames/notes/000001.png.txt" ]

finish
