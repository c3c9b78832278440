/* render/air/atmosphere_day_legs.c: any path of a day, of its legs; any direction of the sky, also below the
 * horizontal. */
#include "render/air/atmosphere_private.h"

static AirLegs legs_of(const AirDay *day, const AirPath *path)
{
    AirPath p = *path;
    p.observer_m = fmax(p.observer_m, 0), p.target_m = fmax(p.target_m, 0);
    p.range_m = fmax(p.range_m, fabs(p.target_m - p.observer_m));
    return air_legs(&p, day->top_m);
}

/* Sunlight in pan is that of its parts. */
static void pan_of(double sun[AIR_BAND_COUNT], const AirDay *day)
{
    const double *top = day->atmosphere->sun_top_w_m2;
    double        transmittance = 0;
    for (AirBand part = AIR_B; part <= AIR_R; part++) transmittance += top[part] / top[AIR_PAN] * exp(-sun[part]);
    sun[AIR_PAN] = -log(transmittance);
}

static void add_pan(double w_m2_sr[AIR_BAND_COUNT])
{
    w_m2_sr[AIR_PAN] = 0;
    for (AirBand part = AIR_B; part <= AIR_R; part++) w_m2_sr[AIR_PAN] += w_m2_sr[part];
}

/* Adds the leg behind. */
static void add_leg(DayPath *to, const DayPath *behind, const AirDay *day, double tangent_m)
{
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        if (!wants(day->parts, b)) continue;
        to->sun[b] = air_legs_depth(b, tangent_m, to->sun[b], behind->sun[b]);
        if (!air_band_is_thermal(b)) continue;
        const int k = b - AIR_MWIR;
        to->thermal_w_m2_sr[k] +=
            behind->thermal_w_m2_sr[k] * air_legs_passed(b, tangent_m, to->own[k], behind->own[k]);
        to->own[k] = air_legs_depth(b, tangent_m, to->own[k], behind->own[k]);
        for (int t = 0; t < day->temps; t++)
            to->emitted[k][t] = air_legs_depth(b, tangent_m, to->emitted[k][t], behind->emitted[k][t]);
    }
}

/* On the way down from an eye: the air above the tables' top, and the model's factor. */
static void finish_down(double thermal_w_m2_sr[2], const AirDay *day, double eye_m, double up, double range_m)
{
    double factor[2];
    if (!(up < 0) || !(day->parts & (1 << AIR_MWIR | 1 << AIR_LWIR))) return;
    air_limb_factors(factor, day->atmosphere, &day->blend, eye_m, up, range_m);
    for (int k = 0; k < 2; k++) {
        const AirBand band = (AirBand)(AIR_MWIR + k);
        if (wants(day->parts, band))
            thermal_w_m2_sr[k] += air_above_top(day->atmosphere, &day->blend, band, eye_m, up, day->top_m);
        thermal_w_m2_sr[k] *= factor[k];
    }
}

/* The path without a cut, for the share that it has. */
static void mix_path(DayPath *out, const DayPath *whole, double cut)
{
    for (int b = 0; b < AIR_BAND_COUNT; b++) out->sun[b] = mixed(whole->sun[b], out->sun[b], cut);
    for (int k = 0; k < 2; k++) {
        out->own[k] = mixed(whole->own[k], out->own[k], cut);
        out->thermal_w_m2_sr[k] = mixed(whole->thermal_w_m2_sr[k], out->thermal_w_m2_sr[k], cut);
        for (int t = 0; t < day_temps_max; t++)
            out->emitted[k][t] = mixed(whole->emitted[k][t], out->emitted[k][t], cut);
    }
}

void air_day_path(DayPath *out, const AirDay *day, const AirPath *path)
{
    const AirLegs legs = legs_of(day, path);
    *out = (DayPath){0};
    if (legs.count > 0) day_leg_path(out, day, ~0u, &legs.leg[0]);
    if (legs.count > 1) {
        DayPath other;
        day_leg_path(&other, day, ~0u, &legs.leg[1]);
        add_leg(out, &other, day, legs.leg[0].target_m);
        if (legs.cut < 1) day_leg_path(&other, day, ~0u, &legs.whole), mix_path(out, &other, legs.cut);
    }
    if (legs.count > 0)
        finish_down(out->thermal_w_m2_sr, day, fmax(path->observer_m, 0), air_ray_up(path), path->range_m);
    if (wants(day->bands, AIR_PAN)) pan_of(out->sun, day);
}

/* Adds what comes from behind a path of these depths. */
static void add_behind(double (*w_m2_sr)[AIR_BAND_COUNT], double (*behind)[AIR_BAND_COUNT], const AirDay *day,
                       const double depth[AIR_BAND_COUNT], int azimuths)
{
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        if (!wants(day->parts, b)) continue;
        const double passed = exp(-depth[b]);
        for (int a = 0; a < azimuths; a++) w_m2_sr[a][b] += passed * behind[a][b];
    }
}

static void leg_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                          const AirPath *leg, const double *azimuth_rad, int azimuths)
{
    AirPath   piece[air_pieces_max];
    const int pieces = air_leg_pieces(piece, leg);
    day_leg_scattered(w_m2_sr, sun, day, &piece[pieces - 1], azimuth_rad, azimuths);
    for (int i = pieces - 2; i >= 0; i--) {
        double near[path_max_suns][AIR_BAND_COUNT], near_sun[AIR_BAND_COUNT];
        day_leg_scattered(near, near_sun, day, &piece[i], azimuth_rad, azimuths);
        add_behind(near, w_m2_sr, day, near_sun, azimuths);
        memcpy(w_m2_sr, near, (size_t)azimuths * sizeof *w_m2_sr);
    }
    if (pieces == 1) return;
    const double share = air_pieces_share(leg);
    if (!(share < 1)) { /* its depth is not the sum of theirs */
        DayPath path;
        day_leg_path(&path, day, ~0u, leg);
        memcpy(sun, path.sun, sizeof path.sun);
        return;
    }
    double whole[path_max_suns][AIR_BAND_COUNT];
    day_leg_scattered(whole, sun, day, leg, azimuth_rad, azimuths);
    for (int a = 0; a < azimuths; a++)
        for (int b = 0; b < AIR_BAND_COUNT; b++) w_m2_sr[a][b] = mixed(whole[a][b], w_m2_sr[a][b], share);
}

void air_day_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                       const AirPath *path, const double *azimuth_rad, int azimuths)
{
    const AirLegs legs = legs_of(day, path);
    memset(w_m2_sr, 0, (size_t)azimuths * sizeof *w_m2_sr);
    memset(sun, 0, AIR_BAND_COUNT * sizeof *sun);
    if (legs.count > 0) leg_scattered(w_m2_sr, sun, day, &legs.leg[0], azimuth_rad, azimuths);
    if (legs.count > 1) {
        double behind[path_max_suns][AIR_BAND_COUNT], behind_sun[AIR_BAND_COUNT];
        leg_scattered(behind, behind_sun, day, &legs.leg[1], azimuth_rad, azimuths);
        add_behind(w_m2_sr, behind, day, sun, azimuths);
        for (AirBand b = 0; b < AIR_BAND_COUNT; b++)
            if (wants(day->parts, b)) sun[b] = air_legs_depth(b, legs.leg[0].target_m, sun[b], behind_sun[b]);
        if (legs.cut < 1) {
            leg_scattered(behind, behind_sun, day, &legs.whole, azimuth_rad, azimuths);
            for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
                sun[b] = mixed(behind_sun[b], sun[b], legs.cut);
                for (int a = 0; a < azimuths; a++) w_m2_sr[a][b] = mixed(behind[a][b], w_m2_sr[a][b], legs.cut);
            }
        }
    }
    if (!wants(day->bands, AIR_PAN)) return;
    pan_of(sun, day);
    for (int a = 0; a < azimuths; a++) add_pan(w_m2_sr[a]);
}

/* Below the horizontal: the air to the lowest point, and the level sky behind it. */
static void sky_below(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day,
                      double observer_m, double up, const double *azimuth_rad, int azimuths)
{
    const AirPath path = air_path_down(observer_m, up);
    const AirLegs legs = legs_of(day, &path);
    const double  tangent_m = path.target_m;
    day_sky_above(w_m2_sr, thermal_w_m2_sr, day, tangent_m, 0.5 * pi_rad, azimuth_rad, azimuths);
    if (legs.count == 0) {
        finish_down(thermal_w_m2_sr, day, observer_m, up, INFINITY);
        return;
    }
    double  before[path_max_suns][AIR_BAND_COUNT], sun[AIR_BAND_COUNT];
    DayPath way;
    day_leg_path(&way, day, ~0u, &legs.leg[0]);
    for (int k = 0; k < 2; k++)
        thermal_w_m2_sr[k] = way.thermal_w_m2_sr[k] +
                             thermal_w_m2_sr[k] * air_legs_sky_passed((AirBand)(AIR_MWIR + k), tangent_m, way.own[k]);
    finish_down(thermal_w_m2_sr, day, observer_m, up, INFINITY);
    leg_scattered(before, sun, day, &legs.leg[0], azimuth_rad, azimuths);
    add_behind(before, w_m2_sr, day, sun, azimuths);
    memcpy(w_m2_sr, before, (size_t)azimuths * sizeof *w_m2_sr);
}

void air_day_sky(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day, double observer_m,
                 double zenith_rad, const double *azimuth_rad, int azimuths)
{
    const double up = cos(zenith_rad), eye_m = fmax(observer_m, 0);
    if (up < 0 && eye_m > 0) sky_below(w_m2_sr, thermal_w_m2_sr, day, eye_m, up, azimuth_rad, azimuths);
    else day_sky_above(w_m2_sr, thermal_w_m2_sr, day, eye_m, zenith_rad, azimuth_rad, azimuths);
    for (int a = 0; a < azimuths && wants(day->bands, AIR_PAN); a++) add_pan(w_m2_sr[a]);
}
