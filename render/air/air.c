/* render/air/air.c: the air of one eye: daylight, the sky from its height, and air paths along its view. The path
 * tables are in air_table.c. */

#include "render/air/air_private.h"

/* Azimuths from the sun, slopes and heights that a view can contain. */
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
            double       climb = d_enu[2];
            if (eye_m > air_top_m) { /* where the ray enters the air */
                const double entry_m = air_entry_m(eye_m, climb);
                if (!(entry_m < INFINITY)) continue;
                air_height_along(eye_m, climb, entry_m, &climb);
            }
            low = fmin(low, azimuth_rad), high = fmax(high, azimuth_rad);
            down = fmin(down, climb), up = fmax(up, climb);
        }
    if (down > up) return; /* no ray in the air */
    /* what the sample grid misses; and the drop of the round Earth below a long path: 0.02 over its 250 km */
    const double slope_margin = 0.1 * (up - down) + 1e-3;
    input->slope_low = fmax(down - slope_margin, -1), input->slope_high = fmin(up + slope_margin + 0.02, 1);
    input->height_high_m = eye_m > air_top_m ? air_top_m : eye_m + fmax(air_far_m * input->slope_high, 0);
    if (down < -0.8 || up > 0.8) return; /* a pole may be inside, where all azimuths meet */
    const double margin_rad = fmax(0.25 * (high - low), 0.02);
    input->azimuth_low_rad = fmax(low - margin_rad, 0), input->azimuth_high_rad = fmin(high + margin_rad, pi_rad);
}

/* ---- in three passes, each of tasks for a pool -------------------------------------------------- */

typedef struct AirJob {
    DaylightJob *light;
    TableJob    *table;
} AirJob;

static void ask_task(void *user, int worker, int task)
{
    AirJob   *job = user;
    const int table = air_table_asks(job->table);
    (void)worker;
    if (task < table) air_table_ask(job->table, task);
    else daylight_ask(job->light, task - table);
}

static void sky_task(void *user, int worker, int task)
{
    AirJob *job = user;
    (void)worker;
    daylight_draw(job->light, task);
}

/* What needs the sky's scale. */
static void draw_task(void *user, int worker, int task)
{
    AirJob   *job = user;
    const int planes = daylight_planes(job->light);
    (void)worker;
    if (task < planes) daylight_plane(job->light, task);
    else air_table_draw(job->table, task - planes);
}

/* Direct sunlight at the eye. */
static void sun_at_eye(Air *air, const Atmosphere *atmosphere, const Sun *sun, unsigned bands)
{
    const double low_rad = fmin(0.5 * pi_rad - sun->elevation_rad, 0.5 * pi_rad);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!((bands | 1 << AIR_PAN) >> b & 1)) continue;
        SunAir at_eye;
        atmosphere_sun(&at_eye, atmosphere, air->light.weather.visibility_m, (AirBand)b, air->eye_height_m, low_rad);
        air->sun_eye_w_m2[b] = at_eye.direct_normal_w_m2 * air->light.sun_above *
                               droplets_sun_passed(&air->light.droplets, (AirBand)b, air->eye_height_m);
    }
}

/* The horizontal's radiance all the way down. */
static void level_limb(AirLimb *out, const AirSky *sky)
{
    for (int stack = 0; stack < air_limb_stacks; stack++) {
        out->steps[stack] = 1;
        for (int i = 0; i <= 1; i++) {
            out->thermal_w_m2_sr[stack][i] = sky->thermal_w_m2_sr[0];
            memcpy(out->scattered_w_m2_sr[stack][i], sky->scattered_w_m2_sr[0],
                   sizeof out->scattered_w_m2_sr[stack][i]);
        }
    }
}

Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena)
{
    *out = (Air){.eye_height_m = fmax(eye->height_m, 0)};
    /* drops are added to an eye's path by path */
    const bool          on_ground = out->eye_height_m < air_ground_eye_m && !droplets_fall(weather);
    const DaylightInput in = {.source = source,
                              .weather = weather,
                              .sun = sun,
                              .bands = eye->bands,
                              .other = on_ground ? NULL : out->sky_eye,
                              .limb = on_ground ? NULL : out->limb,
                              .other_m = out->eye_height_m};
    AirJob              job;
    Status              status = daylight_begin(&job.light, &out->light, &in, arena);
    if (status != STATUS_OK) return status;
    if (eye->view) out->light.zero_z_m = daylight_height(&out->light, eye->view->p_enu) - eye->height_m;
    sun_at_eye(out, out->light.atmosphere, sun, eye->bands);
    TableInput input = {.bands = eye->bands};
    look_where(&input, eye->view, out->light.sun_d_enu, out->eye_height_m);
    status = air_table_begin(&job.table, out, &input, arena);
    if (status != STATUS_OK) return status;
    air_run(pool, air_table_asks(job.table) + daylight_asks(job.light), ask_task, &job);
    air_run(pool, daylight_draws(job.light), sky_task, &job);
    air_run(pool, daylight_planes(job.light) + air_table_draws(job.table), draw_task, &job);
    daylight_end(job.light);
    if (on_ground) memcpy(out->sky_eye, out->light.sky, sizeof out->sky_eye);
    for (int b = 0; b < AIR_BAND_COUNT && on_ground; b++) level_limb(&out->limb[b], &out->sky_eye[b]);
    if (on_ground) return STATUS_OK;
    air_above_fill(out);
    return air_edge_meet(out, &input, arena);
}

void air_even(Air *out, const double sun_d_enu[3], double sun_w_m2, const double sky_w_m2_sr[AIR_BAND_COUNT],
              double even_per_m, const PlanckTable *mwir, const PlanckTable *lwir)
{
    Daylight *light = &out->light;
    *out = (Air){.even_per_m = even_per_m,
                 .light = {.weather = weather_default(), .planck_mwir = mwir, .planck_lwir = lwir}};
    memcpy(light->sun_d_enu, sun_d_enu, sizeof light->sun_d_enu);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        light->sun_w_m2[b] = out->sun_eye_w_m2[b] = sun_w_m2;
        light->sky_w_m2[b] = pi_rad * sky_w_m2_sr[b];
        if (b >= AIR_MWIR) light->ground_w_m2_sr[b] = sky_w_m2_sr[b];
        for (int i = 0; i <= air_sky_ups; i++)
            light->sky[b].thermal_w_m2_sr[i] = out->sky_eye[b].thermal_w_m2_sr[i] = (float)sky_w_m2_sr[b];
        level_limb(&out->limb[b], &out->sky_eye[b]);
        for (int i = 0; i <= air_plane_ups; i++)
            for (int a = 0; a <= air_plane_azimuths; a++) light->plane_w_m2[b][i][a] = (float)light->sky_w_m2[b];
    }
    light->solar_direct_w_m2 = sun_w_m2;
    light->solar_diffuse_w_m2 = light->sky_w_m2[AIR_PAN];
}

/* ---- each path by itself, without tables ------------------------------------------------------- */

/* The results of air_paths.c without its tables: each path is computed from the atmosphere
 * separately.
 *
 * The reference for the tables, used for a few rays of a frame (render/frame/error_estimate.c). Ends and heights of
 * paths are as in air_paths.c. */

static double straight(double low, double high, double share) { return low + share * (high - low); }

/* Optical depth for the emission of a body of this temperature, interpolated between the day's emitters as the
 * atmosphere's own tables do. */
static double depth_of(const double depth[day_temps_max], double temp_k)
{
    int k = 0;
    while (k + 2 < air_temps && temp_k > emitter_temp_k[k + 1]) k++;
    const double share = log(temp_k / emitter_temp_k[k]) / log(emitter_temp_k[k + 1] / emitter_temp_k[k]);
    return straight(depth[k], depth[k + 1], clamp(share, 0, 1));
}

static double azimuth_from_sun_rad(const Air *air, const double d_enu[3])
{
    const double *s = air->light.sun_d_enu, level = hypot(d_enu[0], d_enu[1]) * hypot(s[0], s[1]);
    return level > 1e-12 ? acos(clamp((d_enu[0] * s[0] + d_enu[1] * s[1]) / level, -1, 1)) : 0;
}

static void sky_ray(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const double o_enu[3],
                    const double d_enu[3], int i)
{
    double       seen[1][AIR_BAND_COUNT], thermal[2];
    const double azimuth_rad = azimuth_from_sun_rad(air, d_enu), climb = clamp(air_climb(o_enu, d_enu), -1, 1);
    air_day_sky(seen, thermal, air->light.day, air->eye_height_m, acos(climb), &azimuth_rad, 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        double added = b == AIR_LWIR ? 0 : seen[0][b] * air->light.scattered_scale[b];
        if (b >= AIR_MWIR) added += thermal[b - AIR_MWIR] * air->light.thermal_scale[b - AIR_MWIR];
        out[b].transmittance[i] = out[b].sun_transmittance[i] = out[b].air_transmittance[i] = 0;
        out[b].added_w_m2_sr[i] = (float)added;
    }
}

static void solid_ray(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const double o_enu[3],
                      const double d_enu[3], double range_m, double temp_k, int i)
{
    double        seen[1][AIR_BAND_COUNT], sun[AIR_BAND_COUNT];
    const double  far_m = air_height_along(air->eye_height_m, air_climb(o_enu, d_enu), range_m, NULL);
    const double  azimuth_rad = azimuth_from_sun_rad(air, d_enu);
    const AirPath path = {.observer_m = air->eye_height_m, .target_m = fmax(far_m, 0), .range_m = range_m};
    DayPath       way;
    air_day_path(&way, air->light.day, &path);
    air_day_scattered(seen, sun, air->light.day, &path, &azimuth_rad, 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        const double scattered = b == AIR_LWIR ? 0 : seen[0][b] * air->light.scattered_scale[b];
        if (b < AIR_MWIR) {
            out[b].transmittance[i] = out[b].sun_transmittance[i] = out[b].air_transmittance[i] =
                (float)exp(-way.sun[b]);
            out[b].added_w_m2_sr[i] = (float)scattered;
            continue;
        }
        const double *depth = way.emitted[b - AIR_MWIR], own = exp(-depth[air_temps]);
        out[b].air_transmittance[i] = (float)own;
        out[b].sun_transmittance[i] =
            (float)(b == AIR_MWIR && air->light.scattered_scale[b] > 0 ? exp(-way.sun[b]) : own);
        out[b].transmittance[i] = temp_k > 0 ? (float)exp(-depth_of(depth, temp_k)) : out[b].sun_transmittance[i];
        out[b].added_w_m2_sr[i] =
            (float)(way.thermal_w_m2_sr[b - AIR_MWIR] * air->light.thermal_scale[b - AIR_MWIR] + scattered);
    }
}

void air_paths_directly(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits,
                        const Rays *rays, const float *temp_k, const AirPaths tables[AIR_BAND_COUNT])
{
    AirPaths *wanted[AIR_BAND_COUNT] = {NULL};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) out[b] = tables[b], wanted[b] = &out[b];
    if (!air->light.day || !air->table) return;
    for (int i = 0; i < hits->count; i++) {
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        double       range_m = INFINITY; /* to the ground beyond the terrain's edge, too */
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (bands >> b & 1) range_m = (double)tables[b].range_m[i];
        if (range_m < INFINITY) solid_ray(out, air, bands, o_enu, d_enu, range_m, temp_k ? (double)temp_k[i] : 0, i);
        else sky_ray(out, air, bands, o_enu, d_enu, i);
    }
    droplets_on_paths(wanted, air, hits, rays);
}
