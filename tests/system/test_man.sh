#!/usr/bin/env bash
# The manual page: every command, every option and every setting are on it, and roff has nothing to say against it.
. "$(dirname "$0")/common.sh"
judges groff

# what the program says is asked for once, by etc/make_man and here
cat >"$tmp/once" <<'END'
#!/bin/sh
file=$PITVIPER_SAID/$(echo "$*" | tr ' /' '__')
[ -e "$file" ] || "$PITVIPER_PROGRAM" "$@" >"$file" || { code=$?; rm -f "$file"; exit $code; }
cat "$file"
END
chmod +x "$tmp/once"
mkdir "$tmp/said_once"
export PITVIPER_PROGRAM=$pitviper PITVIPER_SAID=$tmp/said_once
pitviper=$tmp/once
etc/make_man "$pitviper" >"$tmp/pitviper.1" || fail "etc/make_man"
for command in $("$pitviper" --help | sed -nE 's/^  ([a-z]+) +.*/\1/p'); do
    check "$command has its section" grep -qx "\.SH PITVIPER ${command^^}" "$tmp/pitviper.1"
    for option in $("$pitviper" "$command" --help | grep -oE '^ +--[a-z-]+'); do
        check "$command $option" grep -qF -e "${option//-/\\-}" "$tmp/pitviper.1"
    done
done
for option in $("$pitviper" regress bisect --help | grep -oE '^ +--[a-z-]+'); do
    check "regress bisect $option" grep -qF -e "${option//-/\\-}" "$tmp/pitviper.1"
done
for topic in $("$pitviper" help | sed -n '/^products /p'); do
    check "the topic $topic" grep -qx "\.SS ${topic//-/\\\\-}" "$tmp/pitviper.1"
done
check "a field of a product" grep -qF 'targets[].los_rate_dps' "$tmp/pitviper.1"
check "a setting" grep -q 'hfov_deg: 6' "$tmp/pitviper.1"
groff -man -ww -z "$tmp/pitviper.1" >"$tmp/said" 2>&1
check "groff has no complaint" test ! -s "$tmp/said"
groff -man -Tutf8 "$tmp/pitviper.1" >"$tmp/page" 2>/dev/null
check "nothing is lost on the way" grep -q -- '--causal' "$tmp/page"
finish
