/* render/air/air_limb.c: the sky of an eye between its horizontal and the Earth's edge, in rows by the lowest point of
 * the rays: evaluated few, drawn many in the logarithm, since air thins by height as an exponential. */
#include "render/air/air_private.h"

/* Above, the air sends less than a ten-thousandth of the brightest limb. */
static const double limb_top_m = 64e3;
/* Radiances far below the brightest are interpolated as they are: some are 0. */
static const double dim_share = 0.003;
static const double low_eye_m = 3000;

static double rise2(double height_m) { return height_m * (2 * earth_radius_m + height_m); }

/* From the lowest ray of a stack to its highest. */
typedef struct Range {
    double low_m2, high_m2;
} Range;

static Range range_of(double eye_m, int stack)
{
    return stack == 0 ? (Range){0, rise2(fmin(eye_m, air_top_m))}
                      : (Range){rise2(air_top_m), rise2(clamp(eye_m, air_top_m, limb_top_m))};
}

int air_limb_rows(double eye_m, int stack)
{
    /* from low down there is less than two degrees of it */
    if (stack == 0) return eye_m < low_eye_m ? 3 * air_limb_asks / 8 : air_limb_asks;
    return eye_m > air_top_m ? air_limb_asks : 0;
}

double air_limb_climb(double eye_m, int stack, double share)
{
    const Range  range = range_of(eye_m, stack);
    const double cosine = cos(0.5 * pi_rad * share),
                 at_m2 = range.low_m2 + (range.high_m2 - range.low_m2) * cosine * cosine;
    const double down_m2 = rise2(eye_m) - (share > 0 ? at_m2 : range.high_m2);
    return -sqrt(fmax(down_m2, 0)) / (earth_radius_m + eye_m);
}

LimbPlace air_limb_place(double eye_m, double climb)
{
    const double down_m = climb * (earth_radius_m + eye_m), at_m2 = rise2(eye_m) - down_m * down_m;
    const int    stack = eye_m > air_top_m && at_m2 > rise2(air_top_m);
    const Range  range = range_of(eye_m, stack);
    if (at_m2 > range.high_m2)
        return (LimbPlace){stack, 0, (at_m2 - range.high_m2) / fmax(rise2(eye_m) - range.high_m2, 1)};
    const double share = fmax(at_m2 - range.low_m2, 0) / fmax(range.high_m2 - range.low_m2, 1);
    return (LimbPlace){stack, acos_quick(sqrt(fmin(share, 1))) * (2 / pi_rad), 0};
}

static double curve_of(double *dim, double *ln, const double *value, int stride, int count)
{
    double most = 0;
    for (int i = 0; i < count; i++) most = fmax(most, value[i * stride]);
    *dim = dim_share * most;
    for (int i = 0; i < count; i++) ln[i] = most > 0 ? log(fmax(value[i * stride], 0) + *dim) : 0;
    return most;
}

/* A column of rows. */
static void draw_column(double out[air_limb_steps + 1], const double *value, int stride, int steps)
{
    double dim, ln[air_limb_asks + 1];
    if (!(curve_of(&dim, ln, value, stride, steps + 1) > 0)) {
        for (int i = 0; i <= 2 * steps; i++) out[i] = 0;
        return;
    }
    for (int i = 0; i < steps; i++) {
        const double a = i > 0 ? ln[i - 1] : 3 * (ln[0] - ln[1]) + ln[2],
                     d = i + 2 <= steps ? ln[i + 2] : 3 * (ln[i + 1] - ln[i]) + ln[i - 1];
        out[2 * i] = fmax(value[i * stride], 0);
        out[2 * i + 1] = fmax(exp((9 * (ln[i] + ln[i + 1]) - (a + d)) * (1.0 / 16)) - dim, 0);
    }
    out[2 * steps] = fmax(value[steps * stride], 0);
}

void air_limb_draw(AirLimb *out, int stack, const AskedLimb *asked, int steps)
{
    double column[air_sky_asked_azimuths + 1][air_limb_steps + 1], thermal[air_limb_steps + 1];
    out->steps[stack] = 2 * steps;
    if (steps == 0) return;
    draw_column(thermal, asked->thermal_w_m2_sr, 1, steps);
    for (int a = 0; a <= air_sky_asked_azimuths; a++)
        draw_column(column[a], &asked->scattered_w_m2_sr[0][a], air_sky_asked_azimuths + 1, steps);
    for (int i = 0; i <= out->steps[stack]; i++) {
        double in[air_sky_asked_azimuths + 1], row[air_sky_azimuths + 1];
        for (int a = 0; a <= air_sky_asked_azimuths; a++) in[a] = column[a][i];
        air_sky_azimuth_row(row, in);
        for (int a = 0; a <= air_sky_azimuths; a++) out->scattered_w_m2_sr[stack][i][a] = (float)fmax(row[a], 0);
        out->thermal_w_m2_sr[stack][i] = (float)thermal[i];
    }
}

double air_limb_there(const Air *air, int band, const LimbPlace *limb, const SkyPlace *place)
{
    const AirLimb *rows = &air->limb[band];
    const int      steps = rows->steps[limb->stack];
    const double   at = limb->share * steps;
    const int      i = at < steps ? (int)at : steps - 1;
    const float    t = (float)(at - i), *ring = &air->sky_eye[band].around_sun[place->angle];
    const float   *low = &rows->scattered_w_m2_sr[limb->stack][i][place->azimuth], *high = low + air_sky_azimuths + 1;
    const float   *warm = &rows->thermal_w_m2_sr[limb->stack][i], thermal = warm[0] + t * (warm[1] - warm[0]);
    const float    l = low[0] + place->azimuth_share * (low[1] - low[0]),
                h = high[0] + place->azimuth_share * (high[1] - high[0]);
    const double seen = (double)(thermal + (l + t * (h - l)) * (ring[0] + place->angle_share * (ring[1] - ring[0])));
    return limb->level > 0 ? seen + limb->level * (daylight_sky_there(&air->sky_eye[band], place) - seen) : seen;
}
