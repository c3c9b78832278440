/* sensor/settings/aim_offset.h: the setting sensor.aim_offset: where in the picture the aim is meant to appear. */
#ifndef SENSOR_SETTINGS_AIM_OFFSET_H
#define SENSOR_SETTINGS_AIM_OFFSET_H

#include "pitviper.h"

/* Shares of the picture's width and height to the right of its centre and below it. */
typedef struct AimOffset {
    bool   drawn;   /* by the seed, evenly within +- share */
    bool   degrees; /* at is in degrees, of azimuth to the right and of elevation down */
    double at[2];   /* drawn: half of the shares of width and height that are drawn over */
} AimOffset;

/* none; drawn (over four fifths of the width and of the height); drawn W,H: over these shares, 0 .. 1; X,Y: shares from
 * the centre, -0.5 .. 0.5; X,Y deg: degrees, -60 .. 60. False: none of these. */
bool aim_offset_parse(AimOffset *out, const char *text);

#endif
