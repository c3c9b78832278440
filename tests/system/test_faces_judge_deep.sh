#!/usr/bin/env bash
# The unlit sides of a box against Mitsuba 3, as test_faces_judge.sh: suns from 20 to 70 degrees, both models of the air, clear
# and hazy, dark and bright ground, with gloss and without. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/faces.sh"

for sun in 20 45 70; do
    for paint in glossy matt; do
        faces nir us1976 23 $sun 0.4 grass_green $paint
        faces swir midlat_summer 5 $sun 0 concrete $paint
        faces nir midlat_summer 23 $sun 0.4 soil_plowed_dark $paint
        faces swir us1976 5 $sun 0 snow_coarse $paint
    done
done
finish
