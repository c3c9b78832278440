/* render/air/air.c: what one place, one sun and one visibility make of the tables of render/air/atmosphere.c: the sun's light,
 * the sky by direction and what it gives to a plane. The paths are air_table.c's.
 *
 * The tables know the sun above the horizon only. Below 5 degrees the sky keeps the shape it has there and loses
 * brightness as twilight does. */
#include "render/air/air_private.h"

#include "render/light/surface_balance.h"

/* Twilight: daylight below an elevation of 5 degrees, over its value there. Straight lines in its logarithm
 * through rounded values for a clear, moonless sky: 0.17 at the horizon, 8e-4 at the end of civil, 2e-6 of
 * nautical, 3e-7 (airglow and stars) of astronomical twilight. Right within a factor of two. */
static double twilight(double elevation_rad)
{
    static const double at_deg[] = {-18, -12, -6, 0, 5}, decades[] = {-6.5, -5.7, -3.1, -0.77, 0};
    const double e_deg = elevation_rad / rad_per_deg;
    if (e_deg <= at_deg[0]) return pow(10, decades[0]);
    for (int i = 1; i < 5; i++)
        if (e_deg <= at_deg[i]) {
            const double f = (e_deg - at_deg[i - 1]) / (at_deg[i] - at_deg[i - 1]);
            return pow(10, decades[i - 1] + f * (decades[i] - decades[i - 1]));
        }
    return 1;
}

static const double sun_radius_rad = 0.2665 * 0.017453292519943295769; /* mean over the year */

/* Share of the sun's disc above the horizon. */
static double disc_above(double elevation_rad)
{
    return clamp((elevation_rad + sun_radius_rad) / (2 * sun_radius_rad), 0, 1);
}

double air_sun_disc(const Air *air, const double d_enu[3])
{
    /* by the chord, since the cosine of so small an angle has lost half its digits */
    double chord[3];
    v3_sub(chord, d_enu, air->sun_d_enu);
    const double disc = 2 * sin(0.5 * sun_radius_rad), disc2 = disc * disc;
    return v3_dot(chord, chord) < disc2 ? 1 / (pi_rad * disc2) : 0; /* pi chord^2: exact on the sphere */
}

/* ---- the sky as a table -------------------------------------------------------------------- */

/* Cosine of the angle between two directions' azimuths, by their level parts; 1 where one has none. */
static double cos_azimuth(const double a_enu[3], const double b_enu[3])
{
    const double n2 = (a_enu[0] * a_enu[0] + a_enu[1] * a_enu[1]) * (b_enu[0] * b_enu[0] + b_enu[1] * b_enu[1]);
    return n2 > 1e-20 ? clamp((a_enu[0] * b_enu[0] + a_enu[1] * b_enu[1]) / sqrt(n2), -1, 1) : 1;
}

/* The arc cosine, within 7e-5 rad: Abramowitz & Stegun 4.4.45. Steps of the tables are 0.26 rad. */
static double acos_quick(double c)
{
    const double x = fmin(fabs(c), 1);
    const double a = sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
    return c < 0 ? pi_rad - a : a;
}

/* Where x of 0 .. steps falls: *at its lower node, returns the share of the upper one. */
static inline double split(int *at, double x, int steps)
{
    const int i = x > 0 ? (int)x : 0;
    *at = i < steps ? i : steps - 1;
    return clamp(x - *at, 0, 1);
}

/* blur_rad: nothing about the sun shows finer than this. */
static void place_in_sky(SkyPlace *out, const double sun_d_enu[3], const double d_enu[3], double blur_rad)
{
    out->up_share = (float)split(&out->up, air_sky_ups * sqrt(clamp(d_enu[2], 0, 1)), air_sky_ups);
    out->azimuth_share = (float)split(
        &out->azimuth, air_sky_azimuths / pi_rad * acos_quick(cos_azimuth(d_enu, sun_d_enu)), air_sky_azimuths);
    /* by the chord, since the cosine of a small angle has lost half its digits; chord = 2 sin(angle / 2) */
    double chord[3];
    v3_sub(chord, d_enu, sun_d_enu);
    const double c2 = fmin(0.25 * v3_dot(chord, chord), 1), angle = c2 < 0.01 ? 2 * sqrt(c2) : acos_quick(1 - 2 * c2);
    const double blurred = fmin(fmax(angle, blur_rad), pi_rad);
    out->angle_share = (float)split(&out->angle, air_sky_angles * sqrt(blurred / pi_rad), air_sky_angles);
}

void air_sky_place(SkyPlace *out, const Air *air, const double d_enu[3])
{
    place_in_sky(out, air->sun_d_enu, d_enu, 0);
}

double air_sky(const Air *air, AirBand band, const double d_enu[3])
{
    SkyPlace place;
    air_sky_place(&place, air, d_enu);
    return air_sky_there(&air->sky[band], &place);
}

double air_sky_light(const Air *air, AirBand band, const double d_enu[3])
{
    SkyPlace place;
    air_sky_place(&place, air, d_enu);
    return air_sky_there(&air->sky_light[band], &place);
}

void air_plane_place(PlanePlace *out, const Air *air, const double n_enu[3])
{
    const double up = clamp(n_enu[2], -1, 1), x = 0.5 * air_plane_ups * sqrt(1 - fabs(up));
    out->open = (float)(0.5 * (1 + up));
    out->up_share = (float)split(&out->up, up < 0 ? x : air_plane_ups - x, air_plane_ups);
    const double azimuth_rad = acos_quick(cos_azimuth(n_enu, air->sun_d_enu));
    out->azimuth_share = (float)split(&out->azimuth, air_plane_azimuths / pi_rad * azimuth_rad, air_plane_azimuths);
}

void air_facing(Facing *out, const Air *air, const Materials *materials, const Hits *hits, const Rays *rays,
                const uint16_t *material)
{
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const double n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        air_plane_place(&out->plane[i], air, n_enu);
        if (!(materials->material[material[i]].gloss > 0)) continue;
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        double mirror_enu[3];
        v3_add_scaled(mirror_enu, d_enu, 2 * fmax(-v3_dot(n_enu, d_enu), 0), n_enu);
        /* facets that lean by the roughness turn the ray by twice that: grass does not mirror the ring about the sun */
        place_in_sky(&out->mirror[i], air->sun_d_enu, mirror_enu, 2 * materials->material[material[i]].roughness);
    }
}

double air_sky_on_plane(const Air *air, AirBand band, const double n_enu[3])
{
    PlanePlace place;
    air_plane_place(&place, air, n_enu);
    return air_plane_there(air, band, &place);
}

/* The sky as a set of lamps, to add it up by: a grid over the hemisphere, 24 heights of equal steps in the root of d_up
 * and 48 azimuths; and rings about the sun, dense at its middle, which take over from the grid there by a weight that
 * goes smoothly from one to nothing. */
enum {
    lamp_ups = 24,
    lamp_azimuths = 48,
    lamp_rings = 20,
    lamp_spokes = 24,
    lamps = lamp_ups * lamp_azimuths + lamp_rings * lamp_spokes
};
static const double rings_rad = 0.7, rings_only_rad = 0.2;

typedef struct Lamps {
    float    d[3][lamps], solid_angle[lamps];
    SkyPlace place[lamps];
} Lamps;

/* Share of the rings at an angle from the sun. */
static double rings_share(double angle_rad)
{
    const double t = clamp((rings_rad - angle_rad) / (rings_rad - rings_only_rad), 0, 1);
    return t * t * (3 - 2 * t);
}

static void set_lamp(Lamps *out, int k, const double sun_d_enu[3], const double d_enu[3], double solid_angle)
{
    for (int c = 0; c < 3; c++) out->d[c][k] = (float)d_enu[c];
    out->solid_angle[k] = d_enu[2] > 0 ? (float)solid_angle : 0;
    if (d_enu[2] > 0) place_in_sky(&out->place[k], sun_d_enu, d_enu, 0);
}

/* A height of the grid; below, a ring about the sun. */
static void place_grid(Lamps *out, int i, const double sun_d_enu[3])
{
    static const double step_rad = 2 * 3.14159265358979323846 / lamp_azimuths;
    const double u0 = (double)i / lamp_ups, u1 = (i + 1.0) / lamp_ups;
    const double up = 0.5 * (u0 * u0 + u1 * u1), flat = sqrt(1 - up * up);
    for (int a = 0; a < lamp_azimuths; a++) {
        const double d[3] = {flat * sin((a + 0.5) * step_rad), flat * cos((a + 0.5) * step_rad), up};
        const double angle = acos(clamp(v3_dot(d, sun_d_enu), -1, 1));
        set_lamp(out, i * lamp_azimuths + a, sun_d_enu, d, (u1 * u1 - u0 * u0) * step_rad * (1 - rings_share(angle)));
    }
}

static void place_ring(Lamps *out, int r, const double sun_d_enu[3])
{
    double east[3] = {0}, other[3];
    east[fabs(sun_d_enu[0]) < 0.6 ? 0 : 1] = 1;
    v3_add_scaled(east, east, -v3_dot(east, sun_d_enu), sun_d_enu);
    v3_normalize(east, east);
    v3_cross(other, sun_d_enu, east);
    const double a0 = rings_rad * r * r / (lamp_rings * lamp_rings);
    const double a1 = rings_rad * (r + 1) * (r + 1) / (lamp_rings * lamp_rings), angle = 0.5 * (a0 + a1);
    const double solid_angle = (cos(a0) - cos(a1)) * 2 * pi_rad / lamp_spokes * rings_share(angle);
    const double along = cos(angle), across = sin(angle);
    for (int p = 0; p < lamp_spokes; p++) {
        const double turn = (p + 0.5) * 2 * pi_rad / lamp_spokes, c = across * cos(turn), s = across * sin(turn);
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = along * sun_d_enu[k] + c * east[k] + s * other[k];
        set_lamp(out, lamp_ups * lamp_azimuths + r * lamp_spokes + p, sun_d_enu, d, solid_angle);
    }
}

/* Irradiance of each lamp facing it. */
static void light_lamps(float w_m2[lamps], const Lamps *lamp, const AirSky *sky)
{
    for (int k = 0; k < lamps; k++)
        w_m2[k] = lamp->solid_angle[k] > 0 ? lamp->solid_angle[k] * (float)air_sky_there(sky, &lamp->place[k]) : 0;
}

/* What they give to a plane: a fixed order of sums, eight at a time. */
static double on_plane(const float w_m2[lamps], const Lamps *lamp, const double n_enu[3])
{
    const float n0 = (float)n_enu[0], n1 = (float)n_enu[1], n2 = (float)n_enu[2];
    float part[8] = {0};
    for (int k = 0; k < lamps; k += 8)
        for (int j = 0; j < 8; j++) {
            const float cosine = n0 * lamp->d[0][k + j] + n1 * lamp->d[1][k + j] + n2 * lamp->d[2][k + j];
            part[j] += w_m2[k + j] * (cosine > 0 ? cosine : 0);
        }
    double sum = 0;
    for (int j = 0; j < 8; j++) sum += (double)part[j];
    return sum;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* The sky is asked for at every second height and azimuth, over its brightness around the sun, and drawn between them
 * by cubics. */
enum { sky_stride = 2, asked_ups = air_sky_ups / sky_stride, asked_azimuths = air_sky_azimuths / sky_stride };

typedef struct AskedSky {
    double scattered_w_m2_sr[asked_ups + 1][asked_azimuths + 1], thermal_w_m2_sr[asked_ups + 1];
} AskedSky;

/* Asked of the day for all bands at once: how bright the sky is by angle from the sun, and by height and azimuth. */
typedef struct SkyAnswers {
    double around[air_sky_angles + 1][AIR_BAND_COUNT];
    double scattered[asked_ups + 1][asked_azimuths + 1][AIR_BAND_COUNT], thermal[asked_ups + 1][2];
} SkyAnswers;

typedef struct SkyJob {
    Air *air;
    const AirDay *day;
    TableJob *table;
    unsigned bands;
    bool eye_on_ground;
    double day_zenith_rad, thermal_scale[2], scattered_scale, diffuse_w_m2[AIR_BAND_COUNT];
    double azimuth_rad[asked_azimuths + 1];
    SkyAnswers answer[2]; /* from the ground, from the eye */
    Lamps lamp;
    float w_m2[AIR_BAND_COUNT][lamps];
} SkyJob;

static double height_of(const SkyJob *job, int from_eye) { return from_eye ? job->air->eye_height_m : 0; }

/* How bright the sky is by angle from the sun: from it up over the zenith and down to the horizon behind, and beyond
 * that as there. */
static void ask_around_sun(SkyJob *job, int from_eye, int k)
{
    const double angle_rad = pi_rad * k * k / (air_sky_angles * air_sky_angles);
    const double zenith_rad = fmax(job->day_zenith_rad - angle_rad, -0.5 * pi_rad),
                 azimuth_rad = zenith_rad < 0 ? pi_rad : 0;
    double thermal[2];
    air_day_sky(&job->answer[from_eye].around[k], thermal, job->day, height_of(job, from_eye), fabs(zenith_rad),
                &azimuth_rad, 1);
}

/* One height of the sky. */
static void ask_sky(SkyJob *job, int from_eye, int i)
{
    const double u = (double)i / asked_ups;
    const int azimuths = i == asked_ups ? 1 : asked_azimuths + 1; /* the zenith has none */
    SkyAnswers *answer = &job->answer[from_eye];
    air_day_sky(answer->scattered[i], answer->thermal[i], job->day, height_of(job, from_eye), acos(u * u),
                job->azimuth_rad, azimuths);
    for (int a = azimuths; a <= asked_azimuths; a++)
        memcpy(answer->scattered[i][a], answer->scattered[i][0], sizeof answer->scattered[i][a]);
}

static void fill_around_sun(AirSky *sky, const SkyAnswers *answer, int b)
{
    for (int k = 0; k <= air_sky_angles; k++)
        sky->around_sun[k] = b != AIR_LWIR && answer->around[k][b] > 0 ? (float)answer->around[k][b] : 1;
    sky->around_sun[air_sky_angles + 1] = sky->around_sun[air_sky_angles];
}

/* The sky over its ring: what is even enough to be drawn between few places. */
static void without_ring(AskedSky *asked, const SkyJob *job, const AirSky *sky, const SkyAnswers *answer, int b)
{
    const double sun[3] = {sin(job->day_zenith_rad), 0, cos(job->day_zenith_rad)};
    for (int i = 0; i <= asked_ups; i++) {
        const double u = (double)i / asked_ups, up = u * u, flat = sqrt(1 - up * up);
        for (int a = 0; a <= asked_azimuths; a++) {
            const int azimuth = i == asked_ups ? 0 : a;
            const double d[3] = {flat * cos(job->azimuth_rad[azimuth]), flat * sin(job->azimuth_rad[azimuth]), up};
            SkyPlace place;
            place_in_sky(&place, sun, d, 0);
            const float *ring = &sky->around_sun[place.angle];
            const double around = (double)(ring[0] + place.angle_share * (ring[1] - ring[0]));
            asked->scattered_w_m2_sr[i][a] =
                b == AIR_LWIR ? 0 : answer->scattered[i][a][b] * job->scattered_scale / around;
        }
        asked->thermal_w_m2_sr[i] =
            b >= AIR_MWIR ? answer->thermal[i][b - AIR_MWIR] * job->thermal_scale[b - AIR_MWIR] : 0;
    }
}

/* In full resolution; mirrored at both ends of azimuth, as the sky is. */
static void draw_sky(AirSky *sky, const AskedSky *asked)
{
    double along[asked_ups + 1][air_sky_azimuths + 1];
    for (int i = 0; i <= asked_ups; i++)
        for (int a = 0; a <= air_sky_azimuths; a++) {
            const double *v = asked->scattered_w_m2_sr[i];
            const int low = a / sky_stride < asked_azimuths ? a / sky_stride : asked_azimuths - 1;
            const int below = low > 0 ? low - 1 : 1, above = low + 2 <= asked_azimuths ? low + 2 : asked_azimuths - 1;
            along[i][a] =
                cubic_between(v[below], v[low], v[low + 1], v[above], (double)(a - low * sky_stride) / sky_stride);
        }
    const double *v = asked->thermal_w_m2_sr;
    for (int i = 0; i <= air_sky_ups; i++) {
        const int low = i / sky_stride < asked_ups ? i / sky_stride : asked_ups - 1;
        const int below = low > 0 ? low - 1 : 0, above = low + 2 <= asked_ups ? low + 2 : asked_ups;
        const double t = (double)(i - low * sky_stride) / sky_stride;
        for (int a = 0; a <= air_sky_azimuths; a++)
            sky->scattered_w_m2_sr[i][a] =
                (float)fmax(cubic_between(along[below][a], along[low][a], along[low + 1][a], along[above][a], t), 0);
        sky->thermal_w_m2_sr[i] = (float)cubic_between(v[below], v[low], v[low + 1], v[above], t);
    }
}

/* One band: drawn, and scaled to add up as light. */
static void fill_sky(SkyJob *job, int band)
{
    Air *air = job->air;
    if (!(job->bands >> band & 1)) return;
    AirSky *sky = &air->sky[band], *sky_light = &air->sky_light[band], *sky_eye = &air->sky_eye[band];
    static const double up_enu[3] = {0, 0, 1};
    AskedSky asked;
    fill_around_sun(sky, &job->answer[0], band);
    without_ring(&asked, job, sky, &job->answer[0], band);
    draw_sky(sky, &asked);
    if (job->eye_on_ground) {
        *sky_eye = *sky;
    } else {
        fill_around_sun(sky_eye, &job->answer[1], band);
        without_ring(&asked, job, sky_eye, &job->answer[1], band);
        draw_sky(sky_eye, &asked);
    }
    AirSky scattered = *sky;
    memset(scattered.thermal_w_m2_sr, 0, sizeof scattered.thermal_w_m2_sr);
    light_lamps(job->w_m2[band], &job->lamp, &scattered);
    const double adds_up_to = on_plane(job->w_m2[band], &job->lamp, up_enu);
    const double scale = adds_up_to > 0 ? job->diffuse_w_m2[band] / adds_up_to : 0;
    *sky_light = *sky;
    for (int k = 0; k < air_sky_angles + 2; k++) sky_light->around_sun[k] *= (float)scale;
    light_lamps(job->w_m2[band], &job->lamp, sky_light);
    air->sky_scale[band] = scale;
}

/* What the lamps give to planes of one height, in every band. */
static void light_planes(SkyJob *job, int i)
{
    Air *air = job->air;
    const double level = hypot(air->sun_d_enu[0], air->sun_d_enu[1]);
    const double sun_east = level > 1e-10 ? air->sun_d_enu[0] / level : 1;
    const double sun_north = level > 1e-10 ? air->sun_d_enu[1] / level : 0;
    /* a plane that faces down sees nothing: what one sees that leans by a little less, over its share */
    const double x = fmax((i < air_plane_ups / 2 ? i : air_plane_ups - i) * 2.0 / air_plane_ups, i == 0 ? 0.02 : 0);
    const double up = i < air_plane_ups / 2 ? x * x - 1 : 1 - x * x, open = 0.5 * (1 + up), flat = sqrt(1 - up * up);
    for (int p = 0; p <= air_plane_azimuths; p++) {
        const double turn = p * pi_rad / air_plane_azimuths, c = flat * cos(turn), s = flat * sin(turn);
        const double n_enu[3] = {c * sun_east - s * sun_north, c * sun_north + s * sun_east, up};
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (job->bands >> b & 1)
                air->plane_w_m2[b][i][p] = (float)(on_plane(job->w_m2[b], &job->lamp, n_enu) / open);
    }
}

/* ---- in three passes, each of tasks for a pool ------------------------------------------------ */

enum {
    asks_of_sky = 2 * (asked_ups + 1),
    asks_around_sun = 2 * (air_sky_angles + 1),
    lamp_tasks = lamp_ups + lamp_rings
};

static void ask_task(void *user, int worker, int task)
{
    SkyJob   *job = user;
    const int table = air_table_asks(job->table);
    (void)worker;
    if (task < table) {
        air_table_ask(job->table, task);
        return;
    }
    task -= table;
    if (task < asks_of_sky + asks_around_sun) {
        const int from_eye = task % 2, k = task / 2;
        if (from_eye && job->eye_on_ground) return;
        if (k <= asked_ups) ask_sky(job, from_eye, k);
        else ask_around_sun(job, from_eye, k - (asked_ups + 1));
        return;
    }
    task -= asks_of_sky + asks_around_sun;
    if (task < lamp_ups) place_grid(&job->lamp, task, job->air->sun_d_enu);
    else place_ring(&job->lamp, task - lamp_ups, job->air->sun_d_enu);
}

static void draw_task(void *user, int worker, int task)
{
    SkyJob *job = user;
    (void)worker;
    if (task < AIR_BAND_COUNT) fill_sky(job, task);
    else air_table_draw(job->table, task - AIR_BAND_COUNT);
}

static void plane_task(void *user, int worker, int task)
{
    (void)worker;
    light_planes(user, task);
}

/* The pool's, or in order where there is none. */
static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool)
        pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

/* For temperatures: all wavelengths. */
static void heat_balance(Air *air, const Atmosphere *atmosphere, double model_temp_k, double diffuse_pan_w_m2)
{
    /* 0.44 of the daylight that reaches the ground lies in 0.4-0.7 um (the photosynthetic share: 0.43 .. 0.46 under
     * clear skies); against Haurwitz's clear-sky formula that is right to 10 %. */
    static const double visible_share = 0.44, sigma_w_m2_k4 = 5.670374419184429e-8;
    air->solar_direct_w_m2 = air->sun_w_m2[AIR_PAN] / visible_share;
    air->solar_diffuse_w_m2 = diffuse_pan_w_m2 / visible_share;

    /* What a black horizontal plane at air temperature loses to a clear sky. */
    const double t_k = air->weather.air_temp_k, ratio = t_k / model_temp_k;
    const double down_w_m2 = atmosphere_longwave_down(atmosphere, air->weather.visibility_m) * pow(ratio, 4);
    air->longwave_loss_w_m2 = fmax(sigma_w_m2_k4 * pow(t_k, 4) - down_w_m2, 0);

    /* Ground seen from below by what leans over it: grass, 18 K above the air at 1000 W/m2 (etc/ground_heat.csv) */
    const double share = ground_heat_share(air->weather.wind_mps, emission_w_m2_k(1, t_k));
    const double ground_temp_k =
        t_k + share * 0.018 * (air->solar_direct_w_m2 * fmax(air->sun_d_enu[2], 0) + air->solar_diffuse_w_m2);
    air->ground_w_m2_sr[AIR_MWIR] = planck_table_radiance(air->planck_mwir, ground_temp_k);
    air->ground_w_m2_sr[AIR_LWIR] = planck_table_radiance(air->planck_lwir, ground_temp_k);
}

/* Azimuths from the sun's, slopes and heights that a view can show. */
static void look_where(TableInput *input, const View *view, const double sun_d_enu[3], double eye_m)
{
    input->azimuth_low_rad = 0, input->azimuth_high_rad = pi_rad;
    input->slope_low = -1, input->slope_high = 1;
    input->height_high_m = air_top_m;
    if (!view) return;
    double low = pi_rad, high = 0, down = 1, up = -1;
    enum { along = 8 };
    for (int k = 0; k <= along; k++)
        for (int m = 0; m <= along; m++) {
            double d_enu[3];
            view_ray(d_enu, view, (double)k / along * view->width, (double)m / along * view->height);
            const double azimuth_rad = acos_quick(cos_azimuth(d_enu, sun_d_enu));
            low = fmin(low, azimuth_rad), high = fmax(high, azimuth_rad);
            down = fmin(down, d_enu[2]), up = fmax(up, d_enu[2]);
        }
    /* what the raster misses; and the round Earth falls away from under a long path: by 0.02 over its 250 km */
    const double slope_margin = 0.1 * (up - down) + 1e-3;
    input->slope_low = fmax(down - slope_margin, -1), input->slope_high = fmin(up + slope_margin + 0.02, 1);
    input->height_high_m = eye_m + fmax(air_far_m * input->slope_high, 0);
    if (down < -0.8 || up > 0.8) return; /* a pole may be in it, where all azimuths meet */
    const double margin_rad = fmax(0.25 * (high - low), 0.02);
    input->azimuth_low_rad = fmax(low - margin_rad, 0), input->azimuth_high_rad = fmin(high + margin_rad, pi_rad);
}

Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena)
{
    const Atmosphere *atmosphere = source->atmosphere;
    const double model_temp_k = atmosphere_temp_k(atmosphere, 0);
    *out = (Air){.weather = *weather,
                 .planck_mwir = source->planck_mwir,
                 .planck_lwir = source->planck_lwir,
                 .eye_height_m = clamp(eye->height_m, 0, air_top_m)};
    memcpy(out->sun_d_enu, sun->d_enu, sizeof out->sun_d_enu);
    if (isnan(out->weather.air_temp_k)) out->weather.air_temp_k = model_temp_k;

    if (eye->view) out->zero_z_m = air_height(out, eye->view->p_enu) - eye->height_m;
    for (int i = 0; i < air_warmer_nodes; i++)
        out->warmer_k[i] = (float)(atmosphere_temp_k(atmosphere, i * air_warmer_step_m) - model_temp_k);

    SkyJob *job = arena_alloc(arena, 1, sizeof *job);
    if (!job) return STATUS_NO_MEMORY;
    /* ten metres of air under the eye are nothing to the sky above it */
    job->air = out;
    job->bands = eye->bands;
    job->eye_on_ground = out->eye_height_m < 10;
    for (int a = 0; a <= asked_azimuths; a++) job->azimuth_rad[a] = a * pi_rad / asked_azimuths;
    const PlanckTable *planck[2] = {source->planck_mwir, source->planck_lwir};
    for (int k = 0; k < 2; k++)
        job->thermal_scale[k] =
            planck_table_radiance(planck[k], out->weather.air_temp_k) / planck_table_radiance(planck[k], model_temp_k);
    const double zenith_rad = 0.5 * pi_rad - sun->elevation_rad, per_au2 = 1 / (sun->distance_au * sun->distance_au);
    job->day_zenith_rad = fmin(zenith_rad, 85 * rad_per_deg);
    job->scattered_scale = per_au2 * twilight(sun->elevation_rad);

    const double above = per_au2 * disc_above(sun->elevation_rad), low_rad = fmin(zenith_rad, 0.5 * pi_rad);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!((eye->bands | 1 << AIR_PAN) >> b & 1)) continue;
        SunAir from_ground, from_eye, day;
        atmosphere_sun(&from_ground, atmosphere, weather->visibility_m, (AirBand)b, 0, low_rad);
        atmosphere_sun(&from_eye, atmosphere, weather->visibility_m, (AirBand)b, out->eye_height_m, low_rad);
        atmosphere_sun(&day, atmosphere, weather->visibility_m, (AirBand)b, 0, job->day_zenith_rad);
        out->sun_w_m2[b] = from_ground.direct_normal_w_m2 * above;
        out->sun_eye_w_m2[b] = from_eye.direct_normal_w_m2 * above;
        job->diffuse_w_m2[b] = day.diffuse_horizontal_w_m2 * job->scattered_scale;
    }
    /* sunlight for temperatures, also where nobody looks at it */
    out->sky_w_m2[AIR_PAN] = job->diffuse_w_m2[AIR_PAN];
    double temp_k[air_temps + 1];
    memcpy(temp_k, emitter_temp_k, sizeof emitter_temp_k);
    temp_k[air_temps] = out->weather.air_temp_k;
    Status status = air_day_at(&job->day, atmosphere, weather->visibility_m, job->day_zenith_rad, eye->bands, temp_k,
                               air_temps + 1, arena);
    out->day = job->day;
    memcpy(out->day_thermal_scale, job->thermal_scale, sizeof out->day_thermal_scale);
    out->day_scattered_scale = job->scattered_scale;
    TableInput input = {.day = job->day,
                        .bands = eye->bands,
                        .thermal_scale = {job->thermal_scale[0], job->thermal_scale[1]},
                        .scattered_scale = job->scattered_scale};
    look_where(&input, eye->view, out->sun_d_enu, out->eye_height_m);
    if (status == STATUS_OK) status = air_table_begin(&job->table, out, &input, arena);
    if (status != STATUS_OK) return status;
    run(pool, air_table_asks(job->table) + asks_of_sky + asks_around_sun + lamp_tasks, ask_task, job);
    run(pool, AIR_BAND_COUNT + air_table_draws(job->table), draw_task, job);
    run(pool, air_plane_ups + 1, plane_task, job);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (eye->bands >> b & 1) out->sky_w_m2[b] = out->plane_w_m2[b][air_plane_ups][0];
    /* the tables' own: the sum over our sky is there only when somebody asks for pan */
    heat_balance(out, atmosphere, model_temp_k, job->diffuse_w_m2[AIR_PAN]);
    return STATUS_OK;
}

void air_even(Air *out, const double sun_d_enu[3], double sun_w_m2, const double sky_w_m2_sr[AIR_BAND_COUNT],
              double even_per_m, const PlanckTable *mwir, const PlanckTable *lwir)
{
    *out = (Air){.weather = weather_default(), .planck_mwir = mwir, .planck_lwir = lwir, .even_per_m = even_per_m};
    memcpy(out->sun_d_enu, sun_d_enu, sizeof out->sun_d_enu);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        out->sun_w_m2[b] = out->sun_eye_w_m2[b] = sun_w_m2;
        out->sky_w_m2[b] = pi_rad * sky_w_m2_sr[b];
        if (b >= AIR_MWIR) out->ground_w_m2_sr[b] = sky_w_m2_sr[b];
        for (int i = 0; i <= air_sky_ups; i++)
            out->sky[b].thermal_w_m2_sr[i] = out->sky_light[b].thermal_w_m2_sr[i] = out->sky_eye[b].thermal_w_m2_sr[i] =
                (float)sky_w_m2_sr[b];
        for (int i = 0; i <= air_plane_ups; i++)
            for (int a = 0; a <= air_plane_azimuths; a++)
                out->plane_w_m2[b][i][a] = (float)out->sky_w_m2[b];
    }
    out->solar_direct_w_m2 = sun_w_m2;
    out->solar_diffuse_w_m2 = out->sky_w_m2[AIR_PAN];
}
