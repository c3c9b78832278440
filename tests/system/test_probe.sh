# pitviper probe: every probe says what it needs, refuses what it cannot use, and answers what is known on paper.
. "$(dirname "$0")/common.sh"

# probe NAME [ARGUMENT ...] < rows: the rows and their results in $tmp/stdout
probe() { # not behind a pipe: $code would be lost
    "$pitviper" probe "$@" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
}
# cell ROW COLUMN: of the last result; row 1 is the first behind the header. No quoted commas, please.
cell() {
    awk -F, -v row="$1" -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == row + 1 { print $c }' \
        "$tmp/stdout"
}
# near WHAT GOT WANT TOLERANCE
near() { check "$1: $2, want $3 +- $4" awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN { d = a - b; exit !(a != "" && d <= t && -d <= t) }'; }

run probe --help
check "help is on standard output" test "$code" = 0 -a -s "$tmp/stdout" -a ! -s "$tmp/stderr"
names=$(awk '/^  [a-z]/ { print $1 }' "$tmp/stdout")
for name in planck deadreckon; do check "help names $name" grep -qw "$name" <<<"$names"; done
run probe
check "no name is a wrong command" test $code = 2
run probe nonsense
check "an unknown probe is a wrong command" test $code = 2
check "and it is named" grep -q "no such probe: nonsense" "$tmp/stderr"

# each probe, whatever room it is of: no rows, a foreign header, binary
for name in $names; do
    probe "$name" </dev/null
    check "$name: nothing on standard input is an error" test $code -ge 1
    probe "$name" < <(printf 'these,are,not,its,columns\n1,2,3,4,5\n')
    check "$name: a foreign header is an error" test $code -ge 1
    check "$name: which says so" test -s "$tmp/stderr"
    probe "$name" < <(head -c 100000 /dev/urandom)
    check "$name: noise is an error, no crash" test $code -ge 1 -a $code -lt 124
done

# Planck: the reference's 25 digits, rounded
probe planck < <(printf 'lo_um,hi_um,temp_k,note\n8,12,300,a\n3.4,4.8,300,b\n8,12,1,c\n8,12,-1,d\n12,8,300,e\n8,12,1.68,f\n')
near "8-12 um at 300 K" "$(cell 1 radiance_w_m2_sr)" 38.50042393334787 1e-12
near "its derivative" "$(cell 1 dldt)" 0.62970434672218919 1e-14
near "3.4-4.8 um at 300 K" "$(cell 2 radiance_w_m2_sr)" 1.3460717111444343 1e-13
check "at 1 K nothing is left" test "$(cell 3 radiance_w_m2_sr)" = 0
check "what a frame flushes to 0 is 0 here" test "$(cell 6 radiance_w_m2_sr)" = 0
check "a temperature below 0 has no answer" test -z "$(cell 4 radiance_w_m2_sr)" -a -n "$(cell 4 error)"
check "nor has a band upside down" test -n "$(cell 5 error)"
check "foreign columns pass" test "$(cell 5 note)" = e

# dead reckoning: a straight line, a constant turn about the vertical of the body (psi of 1 rad at 0.1 rad/s), body axes
{
    echo algorithm,x_m,y_m,z_m,psi_rad,theta_rad,phi_rad,vx_mps,vy_mps,vz_mps,ax_mps2,wz_rps,dt_s
    echo 2,6378137,0,0,1,0.5,-0.25,10,20,-30,99,1,2.5
    echo 3,6378137,0,0,1,0,0,10,0,0,,0.1,5
    echo 5,6378137,0,0,0,0,0,10,0,0,4,,3
    echo 6,6378137,0,0,1.5707963267948966,0,0,10,0,0,,,3
    echo 10,0,0,0,0,0,0,0,0,0,,,1
} >"$tmp/rows"
probe deadreckon <"$tmp/rows"
near "FPW x" "$(cell 1 dr_x_m)" 6378162 1e-8
near "FPW z" "$(cell 1 dr_z_m)" -75 1e-12
near "FPW attitude is held" "$(cell 1 dr_psi_rad)" 1 1e-15
near "RPW psi" "$(cell 2 dr_psi_rad)" 1.5 1e-14
near "RPW x" "$(cell 2 dr_x_m)" 6378187 1e-8
near "FVW x" "$(cell 3 dr_x_m)" 6378185 1e-8
near "FPB goes where it points" "$(cell 4 dr_y_m)" 30 1e-8
check "there is no algorithm 10" test -n "$(cell 5 error)"

# four-bar targets: the example's row noise hides horizontal bars, and f is told by the field of view (250 urad a pixel)
probe mrtd etc/sensors/example_flir2.sheet < <(printf 'f_cyc_px\n0.1\n0.3\n')
near "mrtd: cycles a milliradian" "$(cell 1 f_cyc_mrad)" 0.4 0.001
check "mrtd grows with frequency" awk -v a="$(cell 1 mrtd_v_bars_k)" -v b="$(cell 2 mrtd_v_bars_k)" 'BEGIN { exit !(a > 0 && b > 2 * a) }'
check "row noise hides horizontal bars" awk -v a="$(cell 1 mrtd_v_bars_k)" -v b="$(cell 1 mrtd_h_bars_k)" 'BEGIN { exit !(b > 2 * a) }'
probe mrtd < <(printf 'preset,f_cyc_px\nhubble,0.1\ntv,0.1\n')
check "mrtd: an unknown sensor is named in its row" grep -q 'preset is not a sensor' "$tmp/stdout"
check "mrtd: a camera of daylight sees no warmth" grep -q 'is not thermal' "$tmp/stdout"

# a day of the ground: sand is warmed by the sun and grass less, shade takes it; and a picture of it
probe heat-ground clear 45 0 < <(printf 'unix_s,surface,shade\n1782043200,sand,0\n1782043200,grass,0\n1782043200,sand,1\n1782043200,lava,0\n')
check "sand is warmer than grass, grass than shaded sand, that than the air" \
    awk -v a="$(cell 1 temp_k)" -v b="$(cell 2 temp_k)" -v c="$(cell 3 temp_k)" -v d="$(cell 3 air_temp_k)" 'BEGIN { exit !(a > b + 5 && b > c && c > d && d > 280) }'
check "an unknown surface is named in its row" grep -q 'lava,0,,,,,,,,,surface is no row' "$tmp/stdout"
PITVIPER=$pitviper etc/plot_heat --at 45 0 --slope 20 --aspect 180 2026-06-21 "$tmp/day.svg" sand burnt 2>"$tmp/stderr"
check "plot_heat draws" test $? = 0 -a -s "$tmp/day.svg"
for text in '>air<' '>sand<' '>burnt<' '2026-06-21 at 45 N 0 E' 'slope of 20 deg'; do
    check "the picture says $text" grep -q -- "$text" "$tmp/day.svg"
done
check "with a line for each" test "$(grep -c '<polyline' "$tmp/day.svg")" = 3
PITVIPER=$pitviper etc/plot_heat 2026-06-21 "$tmp/none.svg" lava 2>"$tmp/stderr"
check "an unknown surface is no picture" test $? = 1 -a ! -e "$tmp/none.svg"
check "and said" grep -q 'lava: surface is no row' "$tmp/stderr"

# radio waves: P.676-13's 0.4081 dB/km of 94 GHz at 15 C and 7.5 g/m3, rain and fog over it, and an echo by hand
probe propagation < <(
    echo frequency_ghz,from_m,to_m,range_m,humidity,rain_mm_h,visibility_m,fog_top_m,cloud_g_m3
    echo 94,0,0,1000,0.585,,,,
    echo 94,0,0,1000,0.585,25,,,
    echo 94,0,0,1000,0.585,,50,,
    echo 94,0,400,1000,0.585,,50,200,
    echo 250,0,0,1000,0.585,,50,,
    echo 94,0,0,1000,0.585,,,,0.5
    echo 94,0,2000,1000,,,,,
)
near "94 GHz, clear, dB/km" "$(cell 1 gas_db)" 0.408 0.004
near "25 mm/h" "$(cell 2 rain_db)" 12.10 0.005
near "two ways, all" "$(cell 2 two_way_db)" 25.0 0.1
near "fog of 50 m everywhere" "$(cell 3 cloud_db)" "$(cell 3 cloud_db_km)" 0.01
near "below 200 m: half" "$(cell 4 cloud_db)" "$(awk -v a="$(cell 3 cloud_db)" 'BEGIN { print a / 2 }')" 0.02
check "no P.840 beyond 200 GHz" test -z "$(cell 5 gas_db)" -a -n "$(cell 5 error)"
check "a cloud has heights" test -n "$(cell 6 error)"
check "a path is as long as it is high" test -n "$(cell 7 error)"
probe propagation nonsense < <(printf 'frequency_ghz,from_m,to_m,range_m\n94,0,0,1000\n')
check "an unknown model is an error" test $code -ge 1
probe radar-equation < <(printf 'power_w,gain_db,frequency_ghz,rcs_dbsm,range_m,bandwidth_hz,noise_figure_db,loss_db\n10,40,94,10,3000,1e8,6,0\n10,40,94,10,3000,1e8,6,3\n10,40,94,10,0,1e8,6,3\n')
near "10 dBsm at 3 km, dBW" "$(cell 1 received_dbw)" -121.98728 0.0001
near "noise" "$(cell 1 noise_dbw)" -117.97519 0.0001
near "3 dB of loss" "$(cell 2 snr_db)" -7.0121 0.0001
check "no range, no echo" test -n "$(cell 3 error)"
# radar clutter: grass at 16 GHz is -15 dB + 5 log10(1.6) of sin(30 deg), by etc/radar/clutter.csv; and 4000 resolution cells of
# soil, a kilometre of them, whose intensity has the mean and the second moment, 2 (1 + 1 / nu), of a K distribution
probe clutter < <(printf 'surface,frequency_ghz,grazing_deg,wind_mps\ngrass,16,30,0\nforest_broadleaf,35,30,8\nlava,35,30,0\ngrass,20,30,0\ngrass,16,0,0\n')
near "sigma0 of grass" "$(cell 1 sigma0_vv_db)" -16.99 0.06
near "without wind all is still" "$(cell 1 still)" 1 0
near "trees in 8 m/s: 1/beta" "$(cell 2 spread_mps)" 0.17474 0.0001
near "and its rms Doppler" "$(cell 2 width_hz)" 57.70 0.1
near "a metre of leaves at 35 GHz" "$(cell 2 foliage_db)" 1.235 0.006
for row in 3 4 5; do check "clutter: row $row says why not" test -n "$(cell $row error)" -a -z "$(cell $row sigma0_vv_db)"; done
probe clutter-cell < <(echo surface,frequency_ghz,grazing_deg,x_m,y_m,t_s
    awk 'BEGIN { for (i = 0; i < 4000; i++) print "bare_soil,94,20," 8 * (i % 80) "," 8 * int(i / 80) ",0"; print "bare_soil,94,20,0,0,1e6" }')
check "clutter-cell: moments of K with nu = 12" awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "relative") c = i }
    NR > 1 && NR <= 4001 { n++; m += $c; q += $c * $c }
    END { m /= n; q /= n; exit !(n == 4000 && m > 0.93 && m < 1.07 && q / m / m > 1.9 && q / m / m < 2.45) }' "$tmp/stdout"
check "clutter-cell: no wind, no change" test "$(cell 1 vv_re)" = "$(cell 4001 vv_re)" -a -n "$(cell 1 vv_re)"

# a missile's flight: in vacuum and without gravity a straight line, to the end of its life or as asked; what it refuses
head=missile,lat_deg,lon_deg,height_m,azimuth_deg,elevation_deg,speed_mps
probe flight < <(echo $head,target_e_m,target_n_m,target_u_m,until_s,earth,air,step_s
    echo bomb_laser,0,0,1000,90,0,100,,,,10,0,0,
    echo bomb_laser,0,0,1000,90,0,100,900,0,-7,12,0,0,0.0005
    echo nothing,0,0,1000,90,0,100,,,,10,0,0,
    echo bomb_laser,0,0,1000,90,0,100,5,,,10,0,0,
    echo bomb_laser,0,0,1000,90,0,100,,,,10,0,0,0.0001
    echo bomb_laser,91,0,1000,90,0,100,,,,10,0,0,)
near "flight: a straight line" "$(cell 1 y_m)" 1000 1e-6
near "flight: along the tangent" "$(cell 1 x_m)" 6379137 1e-6
check "flight: until asked" test "$(cell 1 end)" = until -a "$(cell 1 end_s)" = 10
near "flight: passes by" "$(cell 2 miss_m)" 7 1e-9
near "flight: at 9 s" "$(cell 2 miss_s)" 9 1e-9
near "flight: above it" "$(cell 2 miss_u_m)" 7 1e-9
for row in 3 4 5 6; do check "flight: row $row says why not" test -n "$(cell $row error)" -a -z "$(cell $row end_s)"; done
probe flight /nowhere.csv < <(echo $head)
check "flight: a table that is not there" test $code -ge 1

finish
