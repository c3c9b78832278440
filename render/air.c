/* render/air.c: what one place, one sun and one visibility make of the tables of render/atmosphere.c: the sun's light,
 * the sky by direction and what it gives to a plane. The paths are air_table.c's.
 *
 * The tables know the sun above the horizon only. Below 5 degrees the sky keeps the shape it has there and loses
 * brightness as twilight does. Its radiance is scaled so that it adds up, exactly, to the diffuse irradiance that the
 * tables give for a level plane; the scale is within 15 % of one (tests/render/test_air.c), and is what interpolating
 * the bright ring about the sun costs. */
#include "render/air_private.h"

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
    const double x = fabs(c);
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

double air_sky_table(const AirSky *sky, const double sun_d_enu[3], const double d_enu[3])
{
    int i, a;
    const double fi = split(&i, air_sky_ups * sqrt(clamp(d_enu[2], 0, 1)), air_sky_ups);
    const double fa = split(&a, air_sky_azimuths / pi_rad * acos_quick(cos_azimuth(d_enu, sun_d_enu)), air_sky_azimuths);
    const float *low = sky->radiance_w_m2_sr[i], *high = sky->radiance_w_m2_sr[i + 1];
    const double l = low[a] + fa * (low[a + 1] - low[a]), h = high[a] + fa * (high[a + 1] - high[a]);
    return l + fi * (h - l);
}

double air_sky(const Air *air, AirBand band, const double d_enu[3])
{
    return air_sky_table(&air->sky[band], air->sun_d_enu, d_enu);
}

double air_sky_on_plane(const Air *air, AirBand band, const double n_enu[3])
{
    int i, a;
    const double fi = split(&i, 0.5 * air_plane_ups * (1 + n_enu[2]), air_plane_ups);
    const double fa =
        split(&a, air_plane_azimuths / pi_rad * acos_quick(cos_azimuth(n_enu, air->sun_d_enu)), air_plane_azimuths);
    const float *low = air->plane_w_m2[band][i], *high = air->plane_w_m2[band][i + 1];
    const double l = low[a] + fa * (low[a + 1] - low[a]), h = high[a] + fa * (high[a + 1] - high[a]);
    return l + fi * (h - l);
}

/* Irradiance on a level plane of a table that is bilinear in u = sqrt(d_up) and azimuth: d_up d_solid_angle =
 * 2 u^3 du d_azimuth, and the integral of u^3 times a straight line is exact. */
static double on_level_plane(const AirSky *sky)
{
    double sum = 0;
    for (int i = 0; i < air_sky_ups; i++) {
        double low = 0, high = 0;
        for (int a = 0; a <= air_sky_azimuths; a++) {
            const double w = a == 0 || a == air_sky_azimuths ? 0.5 : 1;
            low += w * sky->radiance_w_m2_sr[i][a], high += w * sky->radiance_w_m2_sr[i + 1][a];
        }
        const double u0 = (double)i / air_sky_ups, u1 = (i + 1.0) / air_sky_ups;
        const double m3 = (u1 * u1 * u1 * u1 - u0 * u0 * u0 * u0) / 4;
        const double m4 = (u1 * u1 * u1 * u1 * u1 - u0 * u0 * u0 * u0 * u0) / 5;
        const double upper = (m4 - u0 * m3) / (u1 - u0); /* of the weight, to the upper node */
        sum += low * (m3 - upper) + high * upper;
    }
    return sum * 2 * 2 * pi_rad / air_sky_azimuths;
}

/* The sky's directions as a set of lamps, for planes that are not level: the cells of a grid, the same for all
 * bands. 24 heights of equal steps in u, 48 azimuths over the circle. */
enum { lamp_ups = 24, lamp_azimuths = 48, lamps = lamp_ups * lamp_azimuths };

static void light_planes(Air *air, unsigned bands)
{
    static const double step_rad = 2 * 3.14159265358979323846 / lamp_azimuths;
    float d[3][lamps], weight[lamps], radiance[lamps], east[lamp_azimuths], north[lamp_azimuths];
    const double level = hypot(air->sun_d_enu[0], air->sun_d_enu[1]);
    const double sun_east = level > 1e-10 ? air->sun_d_enu[0] / level : 1;
    const double sun_north = level > 1e-10 ? air->sun_d_enu[1] / level : 0;
    for (int a = 0; a < lamp_azimuths; a++) {
        const double c = cos((a + 0.5) * step_rad), s = sin((a + 0.5) * step_rad);
        east[a] = (float)(c * sun_east - s * sun_north), north[a] = (float)(c * sun_north + s * sun_east);
    }
    for (int i = 0; i < lamp_ups; i++)
        for (int a = 0; a < lamp_azimuths; a++) {
            const int k = i * lamp_azimuths + a;
            const double u0 = (double)i / lamp_ups, u1 = (i + 1.0) / lamp_ups;
            const double up = 0.5 * (u0 * u0 + u1 * u1), flat = sqrt(1 - up * up);
            d[0][k] = (float)(flat * east[a]), d[1][k] = (float)(flat * north[a]), d[2][k] = (float)up;
            weight[k] = (float)((u1 * u1 - u0 * u0) * step_rad); /* solid angle */
        }

    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        for (int k = 0; k < lamps; k++) {
            const double d_enu[3] = {d[0][k], d[1][k], d[2][k]};
            radiance[k] = weight[k] * (float)air_sky_table(&air->sky[b], air->sun_d_enu, d_enu);
        }
        double scale = 1; /* so that the level plane, the first one done, has what the sky adds up to */
        for (int i = air_plane_ups; i >= 0; i--) {
            const double up = 2.0 * i / air_plane_ups - 1, flat = sqrt(fmax(1 - up * up, 0));
            for (int p = 0; p <= air_plane_azimuths; p++) {
                const double turn = p * pi_rad / air_plane_azimuths, c = flat * cos(turn), s = flat * sin(turn);
                const float n0 = (float)(c * sun_east - s * sun_north), n1 = (float)(c * sun_north + s * sun_east);
                const float n2 = (float)up;
                float part[8] = {0}; /* fixed order of sums, eight at a time */
                for (int k = 0; k < lamps; k += 8)
                    for (int j = 0; j < 8; j++) {
                        const float cosine = n0 * d[0][k + j] + n1 * d[1][k + j] + n2 * d[2][k + j];
                        part[j] += radiance[k + j] * (cosine > 0 ? cosine : 0);
                    }
                double sum = 0;
                for (int j = 0; j < 8; j++) sum += (double)part[j];
                if (i == air_plane_ups && p == 0) scale = sum > 0 ? air->sky_w_m2[b] / sum : 1;
                air->plane_w_m2[b][i][p] = (float)(sum * scale);
            }
        }
    }
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* The sky is asked for at every second height and azimuth, and drawn between them by cubics. */
enum { sky_stride = 2, asked_ups = air_sky_ups / sky_stride, asked_azimuths = air_sky_azimuths / sky_stride };

typedef struct AskedSky {
    double scattered_w_m2_sr[asked_ups + 1][asked_azimuths + 1], thermal_w_m2_sr[asked_ups + 1];
} AskedSky;

typedef struct SkyJob {
    Air              *air;
    const Atmosphere *atmosphere;
    unsigned          bands;
    bool              eye_on_ground;
    double            day_zenith_rad, thermal_scale[2], scattered_scale, diffuse_w_m2[AIR_BAND_COUNT];
    AskedSky          asked[AIR_BAND_COUNT][2]; /* from the ground, from the eye */
} SkyJob;

/* One height of one band's sky, from the ground or the eye. */
static void ask_sky(void *user, int worker, int task)
{
    (void)worker;
    SkyJob *job = user;
    const int i = task % (asked_ups + 1), from_eye = task / (asked_ups + 1) % 2, b = task / (asked_ups + 1) / 2;
    if (!(job->bands >> b & 1) || (from_eye && job->eye_on_ground)) return;
    const double u = (double)i / asked_ups, zenith_rad = acos(u * u);
    const int azimuths = b == AIR_LWIR || i == asked_ups ? 0 : asked_azimuths; /* even about; the zenith has none */
    for (int a = 0; a <= azimuths; a++) {
        SkyAir sky;
        atmosphere_sky(&sky, job->atmosphere, job->air->weather.visibility_m, (AirBand)b,
                       from_eye ? job->air->eye_height_m : 0, zenith_rad, job->day_zenith_rad,
                       a * pi_rad / asked_azimuths);
        job->asked[b][from_eye].scattered_w_m2_sr[i][a] = b == AIR_LWIR ? 0 : sky.scattered_w_m2_sr * job->scattered_scale;
        job->asked[b][from_eye].thermal_w_m2_sr[i] = b >= AIR_MWIR ? sky.thermal_w_m2_sr * job->thermal_scale[b - AIR_MWIR] : 0;
    }
    for (int a = azimuths + 1; a <= asked_azimuths; a++)
        job->asked[b][from_eye].scattered_w_m2_sr[i][a] = job->asked[b][from_eye].scattered_w_m2_sr[i][0];
}

static double at_clamped(const double *value, int count, int i)
{
    return value[i < 0 ? 0 : i >= count ? count - 1 : i];
}

/* Scattered and thermal light in full resolution; mirrored at both ends of azimuth, as the sky is. */
static void draw_sky(AirSky *scattered, double thermal[air_sky_ups + 1], const AskedSky *asked)
{
    double along[asked_ups + 1][air_sky_azimuths + 1];
    for (int i = 0; i <= asked_ups; i++)
        for (int a = 0; a <= air_sky_azimuths; a++) {
            const double *v = asked->scattered_w_m2_sr[i];
            const int low = a / sky_stride < asked_azimuths ? a / sky_stride : asked_azimuths - 1;
            const int below = low > 0 ? low - 1 : 1, above = low + 2 <= asked_azimuths ? low + 2 : asked_azimuths - 1;
            along[i][a] = cubic_between(v[below], v[low], v[low + 1], v[above], (double)(a - low * sky_stride) / sky_stride);
        }
    for (int i = 0; i <= air_sky_ups; i++) {
        const int low = i / sky_stride < asked_ups ? i / sky_stride : asked_ups - 1;
        const int below = low > 0 ? low - 1 : 0, above = low + 2 <= asked_ups ? low + 2 : asked_ups;
        const double t = (double)(i - low * sky_stride) / sky_stride;
        for (int a = 0; a <= air_sky_azimuths; a++)
            scattered->radiance_w_m2_sr[i][a] = (float)fmax(
                cubic_between(along[below][a], along[low][a], along[low + 1][a], along[above][a], t), 0);
        const double *v = asked->thermal_w_m2_sr;
        thermal[i] = cubic_between(at_clamped(v, asked_ups + 1, low - 1), v[low], v[low + 1],
                                   at_clamped(v, asked_ups + 1, low + 2), t);
    }
}

/* One band: from the ground and from the eye, scaled to add up. */
static void fill_sky(SkyJob *job, AirBand band)
{
    Air *air = job->air;
    AirSky scattered[2];
    double thermal[2][air_sky_ups + 1];
    for (int k = 0; k < 2; k++) draw_sky(&scattered[k], thermal[k], &job->asked[band][k && !job->eye_on_ground]);
    const double adds_up_to = on_level_plane(&scattered[0]);
    const double scale = adds_up_to > 0 ? job->diffuse_w_m2[band] / adds_up_to : 0;
    for (int i = 0; i <= air_sky_ups; i++)
        for (int a = 0; a <= air_sky_azimuths; a++) {
            air->sky[band].radiance_w_m2_sr[i][a] = (float)(scale * scattered[0].radiance_w_m2_sr[i][a] + thermal[0][i]);
            air->sky_eye[band].radiance_w_m2_sr[i][a] =
                (float)(scale * scattered[1].radiance_w_m2_sr[i][a] + thermal[1][i]);
        }
    air->sky_scale[band] = scale;
    air->sky_w_m2[band] = on_level_plane(&air->sky[band]);
}

/* For temperatures: all wavelengths. */
static void heat_balance(Air *air, const Atmosphere *atmosphere, double model_temp_k)
{
    /* 0.44 of the daylight that reaches the ground lies in 0.4-0.7 um (the photosynthetic share: 0.43 .. 0.46 under
     * clear skies); against Haurwitz's clear-sky formula that is right to 10 %. */
    static const double visible_share = 0.44, sigma_w_m2_k4 = 5.670374419184429e-8;
    air->solar_direct_w_m2  = air->sun_w_m2[AIR_PAN] / visible_share;
    air->solar_diffuse_w_m2 = air->sky_w_m2[AIR_PAN] / visible_share;

    /* What a black horizontal plane at air temperature loses to a clear sky. */
    const double t_k = air->weather.air_temp_k, ratio = t_k / model_temp_k;
    const double down_w_m2 = atmosphere_longwave_down(atmosphere, air->weather.visibility_m) * pow(ratio, 4);
    air->longwave_loss_w_m2 = fmax(sigma_w_m2_k4 * pow(t_k, 4) - down_w_m2, 0);

    /* Ground seen from below by what leans over it: grass, 18 K above the air at 1000 W/m2 (etc/ground_heat.csv) */
    const double ground_temp_k =
        t_k + 0.018 * (air->solar_direct_w_m2 * fmax(air->sun_d_enu[2], 0) + air->solar_diffuse_w_m2);
    air->ground_w_m2_sr[AIR_MWIR] = planck_table_radiance(air->planck_mwir, ground_temp_k);
    air->ground_w_m2_sr[AIR_LWIR] = planck_table_radiance(air->planck_lwir, ground_temp_k);
}

/* Azimuths from the sun's that a view can show: its border is where they end, unless it holds a pole of the sky. */
static void view_azimuths(double *low_rad, double *high_rad, const View *view, const double sun_d_enu[3])
{
    *low_rad = 0, *high_rad = pi_rad;
    if (!view) return;
    double low = pi_rad, high = 0;
    enum { along = 8 };
    for (int k = 0; k <= along; k++)
        for (int m = 0; m <= along; m++) {
            double d_enu[3];
            view_ray(d_enu, view, (double)k / along * view->width, (double)m / along * view->height);
            if (fabs(d_enu[2]) > 0.8) return;
            const double azimuth = acos_quick(cos_azimuth(d_enu, sun_d_enu));
            low = fmin(low, azimuth), high = fmax(high, azimuth);
        }
    /* between two points of the raster a view of 120 degrees turns by less than this, also about a pole 37 degrees off */
    const double margin_rad = fmax(0.5 * (high - low), 0.05);
    *low_rad = fmax(low - margin_rad, 0), *high_rad = fmin(high + margin_rad, pi_rad);
}

Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena)
{
    const Atmosphere *atmosphere = source->atmosphere;
    const double model_temp_k = atmosphere_temp_k(atmosphere, 0);
    *out = (Air){.weather = *weather, .planck_mwir = source->planck_mwir, .planck_lwir = source->planck_lwir,
                 .eye_height_m = clamp(eye->height_m, 0, air_top_m)};
    memcpy(out->sun_d_enu, sun->d_enu, sizeof out->sun_d_enu);
    if (isnan(out->weather.air_temp_k)) out->weather.air_temp_k = model_temp_k;

    SkyJob *job = arena_alloc(arena, 1, sizeof *job);
    if (!job) return STATUS_NO_MEMORY;
    /* ten metres of air under the eye are nothing to the sky above it */
    *job = (SkyJob){.air = out, .atmosphere = atmosphere, .bands = eye->bands, .eye_on_ground = out->eye_height_m < 10};
    const PlanckTable *planck[2] = {source->planck_mwir, source->planck_lwir};
    for (int k = 0; k < 2; k++)
        job->thermal_scale[k] = planck_table_radiance(planck[k], out->weather.air_temp_k) /
                                planck_table_radiance(planck[k], model_temp_k);
    const double zenith_rad = 0.5 * pi_rad - sun->elevation_rad, per_au2 = 1 / (sun->distance_au * sun->distance_au);
    job->day_zenith_rad  = fmin(zenith_rad, 85 * rad_per_deg);
    job->scattered_scale = per_au2 * twilight(sun->elevation_rad);

    const double above = per_au2 * disc_above(sun->elevation_rad), low_rad = fmin(zenith_rad, 0.5 * pi_rad);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!((eye->bands | 1 << AIR_PAN) >> b & 1)) continue;
        SunAir from_ground, from_eye, day;
        atmosphere_sun(&from_ground, atmosphere, weather->visibility_m, (AirBand)b, 0, low_rad);
        atmosphere_sun(&from_eye, atmosphere, weather->visibility_m, (AirBand)b, out->eye_height_m, low_rad);
        atmosphere_sun(&day, atmosphere, weather->visibility_m, (AirBand)b, 0, job->day_zenith_rad);
        out->sun_w_m2[b]     = from_ground.direct_normal_w_m2 * above;
        out->sun_eye_w_m2[b] = from_eye.direct_normal_w_m2 * above;
        job->diffuse_w_m2[b] = day.diffuse_horizontal_w_m2 * job->scattered_scale;
    }
    /* sunlight for temperatures, also where nobody looks at it */
    out->sky_w_m2[AIR_PAN] = job->diffuse_w_m2[AIR_PAN];
    const int tasks = AIR_BAND_COUNT * 2 * (asked_ups + 1);
    if (pool) pool_run(pool, tasks, ask_sky, job);
    else
        for (int i = 0; i < tasks; i++) ask_sky(job, 0, i);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (eye->bands >> b & 1) fill_sky(job, (AirBand)b);
    light_planes(out, eye->bands);
    heat_balance(out, atmosphere, model_temp_k);

    TableInput input = {.atmosphere = atmosphere, .sun_zenith_rad = job->day_zenith_rad, .bands = eye->bands,
                        .thermal_scale = {job->thermal_scale[0], job->thermal_scale[1]},
                        .scattered_scale = job->scattered_scale};
    view_azimuths(&input.azimuth_low_rad, &input.azimuth_high_rad, eye->view, out->sun_d_enu);
    return air_tables_fill(out, &input, pool, arena);
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
            for (int a = 0; a <= air_sky_azimuths; a++)
                out->sky[b].radiance_w_m2_sr[i][a] = out->sky_eye[b].radiance_w_m2_sr[i][a] = (float)sky_w_m2_sr[b];
        for (int i = 0; i <= air_plane_ups; i++)
            for (int a = 0; a <= air_plane_azimuths; a++)
                out->plane_w_m2[b][i][a] = (float)(out->sky_w_m2[b] * i / air_plane_ups);
    }
    out->solar_direct_w_m2  = sun_w_m2;
    out->solar_diffuse_w_m2 = out->sky_w_m2[AIR_PAN];
}
