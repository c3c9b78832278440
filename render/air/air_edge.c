/* render/air/air_edge.c: where a frame's tables meet: the sky below the horizontal and the ground beyond the terrain at
 * the Earth's edge; and of an eye above the tables' top what the air up there adds to its paths. */
#include "render/air/air_private.h"

static double share_above(double eye_m, double climb)
{
    const double r_m = earth_radius_m + eye_m, edge2_m2 = eye_m * (2 * earth_radius_m + eye_m);
    const double down_m = -r_m * climb, disc = fmax(down_m * down_m - edge2_m2, 0), least = eye_m / sqrt(edge2_m2);
    const double share = climb < 0 ? sqrt(edge2_m2) / (down_m + sqrt(disc)) : 1; /* of the way to the edge */
    return clamp((share - least) / (1 - least), 0, 1) * air_above_steps;
}

void air_above_fill(Air *air)
{
    const double eye_m = air->eye_height_m, edge_m = sqrt(eye_m * (2 * earth_radius_m + eye_m)), least = eye_m / edge_m;
    memset(air->above_w_m2_sr, 0, sizeof air->above_w_m2_sr);
    memset(air->below_w_m2_sr, 0, sizeof air->below_w_m2_sr);
    if (!(eye_m > air_top_m)) return;
    for (int i = 0; i <= air_above_steps; i++) {
        const double  share = fmin(least + (1 - least) * i / air_above_steps, 1 - 1e-9), range_m = share * edge_m;
        const double  up = -(edge_m * edge_m / range_m + range_m) / (2 * (earth_radius_m + eye_m));
        const double  entry_m = air_entry_m(eye_m, fmax(up, -1));
        const AirPath whole = {.observer_m = eye_m, .range_m = range_m},
                      tabled = {.observer_m = air_top_m, .range_m = range_m - entry_m};
        DayPath far, near;
        air_day_path(&far, air->light.day, &whole);
        air_day_path(&near, air->light.day, &tabled);
        for (int k = 0; k < 2; k++) {
            const double scale = air->light.thermal_scale[k];
            air->above_w_m2_sr[k][i] = (float)((far.thermal_w_m2_sr[k] - near.thermal_w_m2_sr[k]) * scale);
            air->below_w_m2_sr[k][i] = (float)(near.thermal_w_m2_sr[k] * scale);
        }
    }
}

double air_above_there(const Air *air, int thermal, double climb, double path_w_m2_sr)
{
    const double at = share_above(air->eye_height_m, climb);
    const int    i = at < air_above_steps ? (int)at : air_above_steps - 1;
    const float *w = &air->above_w_m2_sr[thermal][i], *of = &air->below_w_m2_sr[thermal][i];
    const double more = (double)w[0] + (at - i) * (double)(w[1] - w[0]);
    if (more >= 0) return more;
    /* what it stops of warm air near the ground: of a path that ends aloft, in proportion */
    const double whole = (double)of[0] + (at - i) * (double)(of[1] - of[0]);
    return more * fmin(path_w_m2_sr / whole, 1);
}

/* ---- the edge ------------------------------------------------------------------------------------------- */

/* The air before the edge: by the frame's tables of paths, by azimuth, and by the path itself. */
typedef struct Edge {
    Hits     hits;
    Rays     rays;
    AirPaths table[AIR_BAND_COUNT];
} Edge;

/* Share of the lowest quarter's rows that a difference at the edge has. */
static double share_at(int row, int steps)
{
    const double low = fmax(4.0 * row / steps - 3, 0);
    return low * low;
}

static void shift_rows(AirLimb *limb, const AirSky *sky, const double more_w_m2_sr[air_sky_azimuths + 1],
                       const SkyPlace place[air_sky_azimuths + 1])
{
    for (int a = 0; a <= air_sky_azimuths; a++) {
        const float *ring = &sky->around_sun[place[a].angle];
        const double around = (double)(ring[0] + place[a].angle_share * (ring[1] - ring[0]));
        for (int i = 3 * limb->steps[0] / 4; i <= limb->steps[0]; i++) {
            float       *row = limb->scattered_w_m2_sr[0][i];
            const double now = (double)row[a] + share_at(i, limb->steps[0]) * more_w_m2_sr[a] / around;
            row[a] = (float)fmax(now, -(double)limb->thermal_w_m2_sr[0][i] / around);
        }
    }
}

Status air_edge_meet(Air *air, const TableInput *in, Arena *arena)
{
    const double eye_m = air->eye_height_m, down = sqrt(air_edge2(eye_m)), flat = sqrt(1 - down * down);
    const double edge_m = sqrt(eye_m * (2 * earth_radius_m + eye_m)), slope = air_edge_slope(air);
    if (slope < in->slope_low || slope > in->slope_high) return STATUS_OK; /* the edge is not seen */
    Edge *edge = arena_alloc_raw(arena, 1, sizeof *edge);
    if (!edge) return STATUS_NO_MEMORY;
    const double *sun = air->light.sun_d_enu, level = hypot(sun[0], sun[1]);
    const double  east = level > 1e-10 ? sun[0] / level : 1, north = level > 1e-10 ? sun[1] / level : 0;
    double        azimuth_rad[air_sky_azimuths + 1], seen[air_sky_azimuths + 1][AIR_BAND_COUNT], depth[AIR_BAND_COUNT];
    SkyPlace      place[air_sky_azimuths + 1];
    edge->hits.count = edge->rays.count = air_sky_azimuths + 1;
    for (int a = 0; a <= air_sky_azimuths; a++) {
        /* beyond the view's azimuths the tables have none */
        azimuth_rad[a] = clamp(a * pi_rad / air_sky_azimuths, in->azimuth_low_rad, in->azimuth_high_rad);
        const double c = flat * cos(azimuth_rad[a]), s = flat * sin(azimuth_rad[a]);
        const double d_enu[3] = {c * east - s * north, c * north + s * east, -down};
        for (int k = 0; k < 3; k++) edge->rays.d_enu[k][a] = d_enu[k], edge->rays.o_enu[k][a] = 0;
        edge->hits.range_m[a] = edge_m;
        air_sky_place(&place[a], sun, d_enu, -down);
    }
    AirPaths *out[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) out[b] = in->bands >> b & 1 ? &edge->table[b] : NULL;
    air_paths_clear(out, air, &edge->hits, &edge->rays, NULL);
    const AirPath path = {.observer_m = eye_m, .range_m = edge_m};
    DayPath       way;
    air_day_path(&way, air->light.day, &path);
    air_day_scattered(seen, depth, air->light.day, &path, azimuth_rad, air_sky_azimuths + 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!out[b]) continue;
        double more_w_m2_sr[air_sky_azimuths + 1];
        for (int a = 0; a <= air_sky_azimuths; a++) {
            const double light = b == AIR_LWIR ? 0 : seen[a][b] * air->light.scattered_scale[b];
            const double heat =
                b < AIR_MWIR ? 0 : way.thermal_w_m2_sr[b - AIR_MWIR] * air->light.thermal_scale[b - AIR_MWIR];
            more_w_m2_sr[a] = (double)edge->table[b].added_w_m2_sr[a] - light - heat;
        }
        shift_rows(&air->limb[b], &air->sky_eye[b], more_w_m2_sr, place);
    }
    return STATUS_OK;
}
