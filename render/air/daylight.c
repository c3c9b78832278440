/* render/air/daylight.c: skylight by direction, from the tables of render/air/atmosphere.c, independent of any eye.
 * Totals: daylight_sums.c. */
#include "render/air/air_private.h"
#include "render/air/atmosphere_private.h"

/* ---- the sky as a table -------------------------------------------------------------------- */

double cos_azimuth(const double a_enu[3], const double b_enu[3])
{
    const double n2 = (a_enu[0] * a_enu[0] + a_enu[1] * a_enu[1]) * (b_enu[0] * b_enu[0] + b_enu[1] * b_enu[1]);
    return n2 > 1e-20 ? clamp((a_enu[0] * b_enu[0] + a_enu[1] * b_enu[1]) / sqrt(n2), -1, 1) : 1;
}

double acos_quick(double c)
{
    const double x = fabs(c) < 1 ? fabs(c) : 1; /* fmin compiles to a call */
    const double a = sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
    return c < 0 ? pi_rad - a : a;
}

/* Position of x in 0 .. steps: *at its lower node, returns the share of the upper one. */
static inline double split(int *at, double x, int steps)
{
    const int i = x > 0 ? (int)x : 0;
    *at = i < steps ? i : steps - 1;
    return clamp(x - *at, 0, 1);
}

/* up: sine of the height. blur_rad: the sky about the sun is blurred to this angle. */
static void place_at(SkyPlace *out, const double sun_d_enu[3], const double d_enu[3], double up, double blur_rad)
{
    out->up_share = (float)split(&out->up, air_sky_ups * sqrt(clamp(up, 0, 1)), air_sky_ups);
    out->azimuth_share = (float)split(
        &out->azimuth, air_sky_azimuths / pi_rad * acos_quick(cos_azimuth(d_enu, sun_d_enu)), air_sky_azimuths);
    /* by the chord, since the cosine of a small angle has lost half its digits; chord = 2 sin(angle / 2) */
    double chord[3];
    v3_sub(chord, d_enu, sun_d_enu);
    const double square = 0.25 * v3_dot(chord, chord), c2 = square < 1 ? square : 1;
    const double angle = c2 < 0.01 ? 2 * sqrt(c2) : acos_quick(1 - 2 * c2), wide = angle > blur_rad ? angle : blur_rad;
    out->angle_share = (float)split(&out->angle, air_sky_angles * sqrt(fmin(wide, pi_rad) / pi_rad), air_sky_angles);
}

static void place_in_sky(SkyPlace *out, const double sun_d_enu[3], const double d_enu[3], double blur_rad)
{
    place_at(out, sun_d_enu, d_enu, d_enu[2], blur_rad);
}

void air_sky_place(SkyPlace *out, const double sun_d_enu[3], const double d_enu[3], double climb)
{
    place_at(out, sun_d_enu, d_enu, climb, 0);
}

void daylight_sky_place(SkyPlace *out, const Daylight *light, const double d_enu[3])
{
    place_in_sky(out, light->sun_d_enu, d_enu, 0);
}

double daylight_sky(const Daylight *light, AirBand band, const double d_enu[3])
{
    SkyPlace place;
    daylight_sky_place(&place, light, d_enu);
    return daylight_sky_there(&light->sky[band], &place);
}

void daylight_plane_place(PlanePlace *out, const Daylight *light, const double n_enu[3])
{
    const double up = clamp(n_enu[2], -1, 1), x = 0.5 * air_plane_ups * sqrt(1 - fabs(up));
    out->open = (float)(0.5 * (1 + up));
    out->up_share = (float)split(&out->up, up < 0 ? x : air_plane_ups - x, air_plane_ups);
    const double azimuth_rad = acos_quick(cos_azimuth(n_enu, light->sun_d_enu));
    out->azimuth_share = (float)split(&out->azimuth, air_plane_azimuths / pi_rad * azimuth_rad, air_plane_azimuths);
}

void daylight_facing(Facing *out, const Daylight *light, const Materials *materials, const Hits *hits, const Rays *rays,
                     const uint16_t *material)
{
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const double n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        daylight_plane_place(&out->plane[i], light, n_enu);
        if (!(materials->material[material[i]].gloss > 0)) continue;
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        double       mirror_enu[3];
        v3_add_scaled(mirror_enu, d_enu, 2 * fmax(-v3_dot(n_enu, d_enu), 0), n_enu);
        /* facets tilted by the roughness deflect the ray by twice that: grass does not mirror the ring about the sun */
        place_in_sky(&out->mirror[i], light->sun_d_enu, mirror_enu, 2 * materials->material[material[i]].roughness);
    }
}

double daylight_on_plane(const Daylight *light, AirBand band, const double n_enu[3])
{
    PlanePlace place;
    daylight_plane_place(&place, light, n_enu);
    return daylight_plane_there(light, band, &place);
}

/* The sky as a set of directional lights, for sums over it: a grid over the hemisphere, 24 heights of equal steps in
 * the root of d_up and 48 azimuths; and rings about the sun, dense at its centre, which replace the grid there by a
 * weight that falls smoothly from one to zero. */
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
    const double        u0 = (double)i / lamp_ups, u1 = (i + 1.0) / lamp_ups;
    const double        up = 0.5 * (u0 * u0 + u1 * u1), flat = sqrt(1 - up * up);
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
        double       d[3];
        for (int k = 0; k < 3; k++) d[k] = along * sun_d_enu[k] + c * east[k] + s * other[k];
        set_lamp(out, lamp_ups * lamp_azimuths + r * lamp_spokes + p, sun_d_enu, d, solid_angle);
    }
}

/* Irradiance of each light on a plane facing it. */
static void light_lamps(float w_m2[lamps], const Lamps *lamp, const AirSky *sky)
{
    for (int k = 0; k < lamps; k++)
        w_m2[k] = lamp->solid_angle[k] > 0 ? lamp->solid_angle[k] * (float)daylight_sky_there(sky, &lamp->place[k]) : 0;
}

/* Their irradiance on a plane: a fixed order of sums, eight at a time. */
static double on_plane(const float w_m2[lamps], const Lamps *lamp, const double n_enu[3])
{
    const float n0 = (float)n_enu[0], n1 = (float)n_enu[1], n2 = (float)n_enu[2];
    float       part[8] = {0};
    for (int k = 0; k < lamps; k += 8)
        for (int j = 0; j < 8; j++) {
            const float cosine = n0 * lamp->d[0][k + j] + n1 * lamp->d[1][k + j] + n2 * lamp->d[2][k + j];
            part[j] += w_m2[k + j] * (cosine > 0 ? cosine : 0);
        }
    double sum = 0;
    for (int j = 0; j < 8; j++) sum += (double)part[j];
    return sum;
}

/* ---- the complete sky --------------------------------------------------------------------- */

/* The sky is evaluated at every second height and azimuth, over its brightness around the sun, with cubic
 * interpolation between them. */
enum {
    sky_stride = 2,
    asked_ups = air_sky_ups / sky_stride,
    asked_rows = air_limb_asks > asked_ups ? air_limb_asks : asked_ups
};

typedef struct AskedSky {
    double scattered_w_m2_sr[asked_ups + 1][air_sky_asked_azimuths + 1], thermal_w_m2_sr[asked_ups + 1];
} AskedSky;

/* Evaluations of the day for all bands at once: by height, or depth below the horizontal, and azimuth. */
typedef struct SkyRows {
    double scattered[asked_rows + 1][air_sky_asked_azimuths + 1][AIR_BAND_COUNT], thermal[asked_rows + 1][2];
} SkyRows;
/* And by angle from the sun. */
typedef struct SkyAnswers {
    double  around[air_sky_angles + 1][AIR_BAND_COUNT];
    SkyRows sky;
} SkyAnswers;

struct DaylightJob {
    Daylight     *light;
    AirSky       *other;                  /* [AIR_BAND_COUNT], the sky from other_m up; NULL: of the ground alone */
    AirLimb      *limb;                   /* and below */
    int           limbs[air_limb_stacks]; /* rows of it that are evaluated, less one */
    double        other_m;
    const AirDay *day;
    unsigned      bands;
    double        diffuse_w_m2[AIR_BAND_COUNT];
    double        azimuth_rad[air_sky_asked_azimuths + 1];
    SkyAnswers    answer[2];              /* from the ground, from other_m */
    SkyRows       below[air_limb_stacks]; /* of limb */
    Lamps         lamp;
    float         w_m2[AIR_BAND_COUNT][lamps];
};

static double ring_rad(int k) { return pi_rad * k * k / (air_sky_angles * air_sky_angles); }

static double height_of(const DaylightJob *job, int other) { return other ? job->other_m : 0; }

/* Sky radiance of the ground by angle from the sun: from it up over the zenith and down to the horizon behind, and
 * constant beyond. */
static void ask_around_sun(DaylightJob *job, int k)
{
    const double zenith_rad = fmax(job->light->day_zenith_rad - ring_rad(k), -0.5 * pi_rad),
                 azimuth_rad = zenith_rad < 0 ? pi_rad : 0;
    double thermal[2];
    air_day_sky(&job->answer[0].around[k], thermal, job->day, 0, fabs(zenith_rad), &azimuth_rad, 1);
    droplets_in_sky(&job->answer[0].around[k], thermal, job->light, job->bands, fabs(zenith_rad), &azimuth_rad, 1);
}

/* The same from the other height, whose sky grows by tens from the zenith to the horizontal: at the sun's own height as
 * far as that goes, in one evaluation, beyond it past the zenith to farthest_rad from there, and constant: air of
 * nearly one length. */
static void ask_around_other(DaylightJob *job, int k)
{
    static const double farthest_rad = 35 * 3.14159265358979323846 / 180;
    const double        sun_rad = job->light->day_zenith_rad, most_rad = fmax(farthest_rad, sun_rad), back_rad = pi_rad;
    const double        behind_rad = ring_rad(k) - sun_rad;
    double(*around)[AIR_BAND_COUNT] = job->answer[1].around, thermal[2], azimuth_rad[air_sky_angles];
    int level = 0;
    for (; level < air_sky_angles && sin(0.5 * ring_rad(level)) < sin(sun_rad); level++)
        azimuth_rad[level] = 2 * asin(sin(0.5 * ring_rad(level)) / sin(sun_rad));
    if (k == 0 && level > 0) air_day_sky(around, thermal, job->day, job->other_m, sun_rad, azimuth_rad, level);
    if (k < level || (k > level && ring_rad(k - 1) - sun_rad >= most_rad)) return; /* another has it */
    air_day_sky(around + k, thermal, job->day, job->other_m, fmin(behind_rad, most_rad), &back_rad, 1);
    for (int i = k + 1; i <= air_sky_angles && behind_rad >= most_rad; i++)
        memcpy(around[i], around[k], sizeof around[i]);
}

/* One height of the sky. */
static void ask_sky(DaylightJob *job, int other, int i)
{
    const double u = (double)i / asked_ups;
    const int    azimuths = i == asked_ups ? 1 : air_sky_asked_azimuths + 1; /* the zenith has none */
    SkyRows     *sky = &job->answer[other].sky;
    air_day_sky(sky->scattered[i], sky->thermal[i], job->day, height_of(job, other), acos(u * u), job->azimuth_rad,
                azimuths);
    if (!other)
        droplets_in_sky(sky->scattered[i], sky->thermal[i], job->light, job->bands, acos(u * u), job->azimuth_rad,
                        azimuths);
    for (int a = azimuths; a <= air_sky_asked_azimuths; a++)
        memcpy(sky->scattered[i][a], sky->scattered[i][0], sizeof sky->scattered[i][a]);
}

static void ask_limb(DaylightJob *job, int stack, int i)
{
    const double climb = air_limb_climb(job->other_m, stack, (double)i / job->limbs[stack]);
    SkyRows     *below = &job->below[stack];
    air_day_sky(below->scattered[i], below->thermal[i], job->day, job->other_m, acos(climb), job->azimuth_rad,
                air_sky_asked_azimuths + 1);
}

static void fill_around_sun(AirSky *sky, const SkyAnswers *answer, int b)
{
    for (int k = 0; k <= air_sky_angles; k++)
        sky->around_sun[k] = b != AIR_LWIR && answer->around[k][b] > 0 ? (float)answer->around[k][b] : 1;
    sky->around_sun[air_sky_angles + 1] = sky->around_sun[air_sky_angles];
}

/* One direction over its ring: smooth enough for interpolation between few points. */
static double without_ring(const DaylightJob *job, const AirSky *sky, int b, double scattered_w_m2_sr,
                           const double d[3])
{
    const double sun[3] = {sin(job->light->day_zenith_rad), 0, cos(job->light->day_zenith_rad)};
    SkyPlace     place;
    place_in_sky(&place, sun, d, 0);
    const float *ring = &sky->around_sun[place.angle];
    const double around = (double)(ring[0] + place.angle_share * (ring[1] - ring[0]));
    return scattered_w_m2_sr * job->light->scattered_scale[b] * job->light->cloud_sky / around;
}

static double under_clouds(const Daylight *light, int b, double clear_w_m2_sr)
{
    const PlanckTable *planck = b == AIR_MWIR ? light->planck_mwir : light->planck_lwir;
    const double       clear = clear_w_m2_sr * light->thermal_scale[b - AIR_MWIR];
    const double cloud = light->cloud_thermal > 0 ? planck_table_radiance(planck, light->weather.air_temp_k) : clear;
    return clear + light->cloud_thermal * (cloud - clear);
}

/* A row, of which this is the sine of its height; returns its thermal radiance. */
static double ask_row(double scattered_w_m2_sr[air_sky_asked_azimuths + 1], const DaylightJob *job, const AirSky *sky,
                      const SkyRows *rows, int b, int i, double up)
{
    const double flat = sqrt(1 - up * up);
    for (int a = 0; a <= air_sky_asked_azimuths; a++) {
        const double azimuth_rad = job->azimuth_rad[up < 1 ? a : 0],
                     d[3] = {flat * cos(azimuth_rad), flat * sin(azimuth_rad), up};
        scattered_w_m2_sr[a] = b == AIR_LWIR ? 0 : without_ring(job, sky, b, rows->scattered[i][a][b], d);
    }
    return b < AIR_MWIR ? 0 : under_clouds(job->light, b, rows->thermal[i][b - AIR_MWIR]);
}

static void asked_above(AskedSky *asked, const DaylightJob *job, const AirSky *sky, const SkyRows *rows, int b)
{
    for (int i = 0; i <= asked_ups; i++) {
        const double u = (double)i / asked_ups;
        asked->thermal_w_m2_sr[i] = ask_row(asked->scattered_w_m2_sr[i], job, sky, rows, b, i, u * u);
    }
}

/* In full resolution; mirrored at both ends of azimuth, as the sky is. */
void air_sky_azimuth_row(double out[air_sky_azimuths + 1], const double in[air_sky_asked_azimuths + 1])
{
    for (int a = 0; a <= air_sky_azimuths; a++) {
        const int low = a / sky_stride < air_sky_asked_azimuths ? a / sky_stride : air_sky_asked_azimuths - 1;
        const int below = low > 0 ? low - 1 : 1,
                  above = low + 2 <= air_sky_asked_azimuths ? low + 2 : air_sky_asked_azimuths - 1;
        out[a] = cubic_between(in[below], in[low], in[low + 1], in[above], (double)(a - low * sky_stride) / sky_stride);
    }
}

static void draw_sky(AirSky *sky, const AskedSky *asked)
{
    double along[asked_ups + 1][air_sky_azimuths + 1];
    for (int i = 0; i <= asked_ups; i++) air_sky_azimuth_row(along[i], asked->scattered_w_m2_sr[i]);
    const double *v = asked->thermal_w_m2_sr;
    for (int i = 0; i <= air_sky_ups; i++) {
        const int    low = i / sky_stride < asked_ups ? i / sky_stride : asked_ups - 1;
        const int    below = low > 0 ? low - 1 : 0, above = low + 2 <= asked_ups ? low + 2 : asked_ups;
        const double t = (double)(i - low * sky_stride) / sky_stride;
        for (int a = 0; a <= air_sky_azimuths; a++)
            sky->scattered_w_m2_sr[i][a] =
                (float)fmax(cubic_between(along[below][a], along[low][a], along[low + 1][a], along[above][a], t), 0);
        sky->thermal_w_m2_sr[i] = (float)fmax(cubic_between(v[below], v[low], v[low + 1], v[above], t), 0);
    }
}

/* The sky from the other height: from its horizontal up, and down. */
static void fill_other(DaylightJob *job, int band)
{
    AirSky  *sky = &job->other[band];
    AskedSky asked;
    fill_around_sun(sky, &job->answer[1], band);
    asked_above(&asked, job, sky, &job->answer[1].sky, band);
    draw_sky(sky, &asked);
    for (int stack = 0; stack < air_limb_stacks; stack++) {
        const int steps = job->limbs[stack];
        AskedLimb limb;
        for (int i = 0; i <= steps && steps > 0; i++) {
            const double climb = air_limb_climb(job->other_m, stack, (double)i / steps);
            limb.thermal_w_m2_sr[i] = ask_row(limb.scattered_w_m2_sr[i], job, sky, &job->below[stack], band, i, climb);
        }
        air_limb_draw(&job->limb[band], stack, &limb, steps);
    }
}

/* What lies below the horizontal is over the same ring. */
static void scale_sky(AirSky *sky, double scale)
{
    for (int k = 0; k < air_sky_angles + 2; k++) sky->around_sun[k] *= (float)scale;
}

/* One band: interpolated, and scaled to the total irradiance. */
static void fill_sky(DaylightJob *job, int band)
{
    Daylight *light = job->light;
    if (!(job->bands >> band & 1)) return;
    AirSky             *sky = &light->sky[band];
    static const double up_enu[3] = {0, 0, 1};
    AskedSky            asked;
    fill_around_sun(sky, &job->answer[0], band);
    asked_above(&asked, job, sky, &job->answer[0].sky, band);
    draw_sky(sky, &asked);
    if (job->other) fill_other(job, band);
    AirSky scattered = *sky;
    memset(scattered.thermal_w_m2_sr, 0, sizeof scattered.thermal_w_m2_sr);
    light_lamps(job->w_m2[band], &job->lamp, &scattered);
    const double adds_up_to = on_plane(job->w_m2[band], &job->lamp, up_enu);
    const double scale = adds_up_to > 0 ? job->diffuse_w_m2[band] / adds_up_to : 1;
    scale_sky(sky, scale);
    if (job->other) scale_sky(&job->other[band], scale);
    light_lamps(job->w_m2[band], &job->lamp, sky);
    light->sky_scale[band] = scale;
    light->scattered_scale[band] *= scale;
}

/* Irradiance of planes of one tilt by the lights, in every band. */
static void light_planes(DaylightJob *job, int i)
{
    Daylight    *light = job->light;
    const double level = hypot(light->sun_d_enu[0], light->sun_d_enu[1]);
    const double sun_east = level > 1e-10 ? light->sun_d_enu[0] / level : 1;
    const double sun_north = level > 1e-10 ? light->sun_d_enu[1] / level : 0;
    /* a plane that faces down receives nothing: the value of one of slightly less tilt, over its share */
    const double x = fmax((i < air_plane_ups / 2 ? i : air_plane_ups - i) * 2.0 / air_plane_ups, i == 0 ? 0.02 : 0);
    const double up = i < air_plane_ups / 2 ? x * x - 1 : 1 - x * x, open = 0.5 * (1 + up), flat = sqrt(1 - up * up);
    for (int p = 0; p <= air_plane_azimuths; p++) {
        const double turn = p * pi_rad / air_plane_azimuths, c = flat * cos(turn), s = flat * sin(turn);
        const double n_enu[3] = {c * sun_east - s * sun_north, c * sun_north + s * sun_east, up};
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (job->bands >> b & 1)
                light->plane_w_m2[b][i][p] = (float)(on_plane(job->w_m2[b], &job->lamp, n_enu) / open);
    }
}

/* ---- tasks for a pool --------------------------------------------------------------------------- */

enum {
    asks_of_sky = 2 * (asked_ups + 1),
    asks_around_sun = 2 * (air_sky_angles + 1),
    lamp_tasks = lamp_ups + lamp_rings
};

static int asks_of_limb(const DaylightJob *job)
{
    return job->other ? job->limbs[0] + 1 + (job->limbs[1] > 0 ? job->limbs[1] + 1 : 0) : 0;
}

int daylight_asks(const DaylightJob *job)
{
    return job->bands ? asks_of_limb(job) + asks_of_sky + asks_around_sun + lamp_tasks : 0;
}

void daylight_ask(DaylightJob *job, int task)
{
    if (task < asks_of_limb(job)) {
        const bool upper = task > job->limbs[0];
        ask_limb(job, upper, upper ? task - job->limbs[0] - 1 : task);
        return;
    }
    task -= asks_of_limb(job);
    if (task < asks_of_sky + asks_around_sun) {
        const int other = task % 2, k = task / 2;
        if (other && !job->other) return;
        if (k <= asked_ups) ask_sky(job, other, k);
        else if (other) ask_around_other(job, k - (asked_ups + 1));
        else ask_around_sun(job, k - (asked_ups + 1));
        return;
    }
    task -= asks_of_sky + asks_around_sun;
    if (task < lamp_ups) place_grid(&job->lamp, task, job->light->sun_d_enu);
    else place_ring(&job->lamp, task - lamp_ups, job->light->sun_d_enu);
}

int daylight_draws(const DaylightJob *job) { return job->bands ? AIR_BAND_COUNT : 0; }

void daylight_draw(DaylightJob *job, int band) { fill_sky(job, band); }

int daylight_planes(const DaylightJob *job) { return job->bands ? air_plane_ups + 1 : 0; }

void daylight_plane(DaylightJob *job, int height) { light_planes(job, height); }

void daylight_end(DaylightJob *job)
{
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (job->bands >> b & 1) job->light->sky_w_m2[b] = job->light->plane_w_m2[b][air_plane_ups][0];
}

/* ---- the complete tables ------------------------------------------------------------------------ */

Status daylight_begin(DaylightJob **out, Daylight *light, const DaylightInput *in, Arena *arena)
{
    DaylightJob *job = arena_alloc(arena, 1, sizeof *job);
    if (!job) return STATUS_NO_MEMORY;
    *light = (Daylight){0};
    for (int b = 0; b < AIR_BAND_COUNT; b++) light->sky_scale[b] = 1;
    job->light = light, job->bands = in->bands, job->other = in->other, job->limb = in->limb;
    job->other_m = in->other_m;
    for (int stack = 0; stack < air_limb_stacks; stack++) job->limbs[stack] = air_limb_rows(in->other_m, stack);
    AirSource source = *in->source;
    Status    status = daylight_air(&source.atmosphere, in->source->atmosphere, in->weather, in->bands, arena);
    if (status != STATUS_OK) return status;
    daylight_sums(light, &source, in->weather, in->sun, in->bands, job->diffuse_w_m2);
    for (int a = 0; a <= air_sky_asked_azimuths; a++) job->azimuth_rad[a] = a * pi_rad / air_sky_asked_azimuths;
    double temp_k[air_temps + 1];
    memcpy(temp_k, emitter_temp_k, sizeof emitter_temp_k);
    temp_k[air_temps] = light->weather.air_temp_k;
    status = air_day_at(&light->day, source.atmosphere, light->weather.visibility_m, light->day_zenith_rad, in->bands,
                        temp_k, air_temps + 1, arena);
    job->day = light->day, light->atmosphere = source.atmosphere;
    if (status == STATUS_OK && light->droplets.layers > 0) droplets_beside(&light->droplets, light->day);
    *out = job;
    return status;
}
