/* render/heat/scenery_walls.c: steps the constructions of scenery through an exercise, on the grid of time of the
 * ground's heat (scenery_heat.h). */
#include "render/heat/scenery_heat_private.h"

#include <stdlib.h>

/* ---- columns ----------------------------------------------------------------------------------- */

int scenery_facet(double share[2], int facets, const double n[3])
{
    const double sum = fabs(n[0]) + fabs(n[1]) + fmax(n[2], 0), over = sum > 0 ? 1 / sum : 0;
    const double x = 0.5 * ((n[0] + n[1]) * over + 1) * (facets - 1),
                 y = 0.5 * ((n[0] - n[1]) * over + 1) * (facets - 1);
    const int i = (int)clamp(x, 0, facets - 2), j = (int)clamp(y, 0, facets - 2);
    share[0] = x - i, share[1] = y - j;
    return j * facets + i;
}

void scenery_walls_use(bool *used, int facets, const double n[3])
{
    double    share[2];
    const int at = scenery_facet(share, facets, n);
    used[at] = used[at + 1] = used[at + facets] = used[at + facets + 1] = true;
}

static WallFace face_of(const SceneryWalls *w, int c)
{
    const int facets = w->config->heat.facets, all = facets * facets;
    WallFace  face = {.sun = c < all};
    if (c < all) {
        heat_facet_normal(face.n_enu, c % facets, c / facets, facets);
    } else {
        const double up = (double)(c - all) / (heat_ups - 1);
        face.n_enu[0] = sqrt(1 - up * up), face.n_enu[2] = up;
    }
    return face;
}

/* What stands for a room: inner faces to the north, east, south, west and up. */
enum { room_faces = 5 };
static void room_columns(int out[room_faces], int facets)
{
    const int last = facets - 1;
    out[0] = last, out[1] = last * facets + last, out[2] = last * facets, out[3] = 0, out[4] = facets * facets / 2;
}

/* Its innermost nodes there. */
static double inner_mean_k(const SceneryWalls *w, const SceneryWall *wall, const double *temp_k)
{
    const int nodes = wall->kind.column.nodes;
    int       at[room_faces];
    double    sum = 0;
    room_columns(at, w->config->heat.facets);
    for (int c = 0; c < w->columns; c++) {
        if (!wall->used[c]) continue;
        for (int k = 0; k < room_faces; k++) sum += at[k] == c ? temp_k[nodes - 1] : 0;
        temp_k += nodes;
    }
    return sum / room_faces;
}

static double solar_hour(const SceneryWalls *w, double unix_s)
{
    const double day = unix_s / day_s + w->config->east_rad / (2 * pi_rad);
    return 24 * (day - floor(day));
}

/* ---- a step ------------------------------------------------------------------------------------ */

typedef struct WallJob {
    SceneryWalls *walls;
    double        dt_s;
    WallPlace     before, after;
} WallJob;

static void step_wall(void *user, int worker, int task)
{
    const WallJob      *job = user;
    SceneryWalls       *w = job->walls;
    SceneryWall        *wall = &w->wall[task];
    double             *temp_k = w->now.temp_k + wall->first;
    const int           nodes = wall->kind.column.nodes;
    const HeatConfig   *c = &w->config->heat;
    const double        middle_s = (double)w->now.index * c->step_s + 0.5 * job->dt_s;
    const double        air_k = 0.5 * (job->before.weather->air.temp_k + job->after.weather->air.temp_k);
    const Construction *of = &wall->kind.of;
    const double        behind_k = wall_behind_k(of, solar_hour(w, middle_s), w->now.day_k, air_k, w->now.room_k[task]);
    (void)worker;
    ColumnState state = {.halved = 0};
    for (int k = 0; k < w->columns; k++) {
        const WallFace at = face_of(w, k);
        if (!wall->used[k]) continue;
        memcpy(state.temp_k, temp_k, (size_t)nodes * sizeof *temp_k);
        wall_step(&state, &wall->kind, wall->factors[job->dt_s > c->step_s], &job->before, &job->after, &at, behind_k,
                  c->grid.tolerance_k, job->dt_s);
        memcpy(temp_k, state.temp_k, (size_t)nodes * sizeof *temp_k);
        temp_k += nodes;
    }
    if (of->inside == BEHIND_UNHEATED)
        w->now.room_k[task] = wall_room_step(of, w->now.room_k[task],
                                             inner_mean_k(w, wall, w->now.temp_k + wall->first), air_k, job->dt_s);
}

static double about_mean_k(const GroundColumn about[about_columns])
{
    return 0.5 * (about[about_grass].state.temp_k[0] + about[about_paved].state.temp_k[0]);
}

static void step_about(SceneryWalls *w, GroundColumn about[about_columns], const GroundWeather *before,
                       const GroundWeather *after, double dt_s)
{
    const GroundExposure open = {{0, 0, 1}, 1, 1, 0}, hidden = {{0, 0, 1}, 0, 0, before->air.temp_k};
    for (int k = 0; k < about_columns; k++) {
        about[k].factors = w->factors[dt_s > w->config->heat.step_s][k];
        ground_column_step(&about[k], w->config->heat.grid.tolerance_k, before, after,
                           k == about_hidden ? &hidden : &open, dt_s);
    }
}

static int half_hour_of(double unix_s)
{
    return (int)((unix_s - floor(unix_s / day_s) * day_s) / slot_s) % heat_day_slots;
}

/* A step is worked at in parts: what walls share, then each wall. */
static void step_part(SceneryWalls *w, int part, double dt_s)
{
    const WallJob job = {
        w, dt_s, {&w->weather[0], w->about_k[0], w->ground_rho}, {&w->weather[1], w->about_k[1], w->ground_rho}};
    if (part > 0) {
        step_wall((void *)&job, 0, part - 1);
        return;
    }
    w->about_k[0] = about_mean_k(w->now.about);
    step_about(w, w->now.about, &w->weather[0], &w->weather[1], dt_s);
    w->about_k[1] = about_mean_k(w->now.about);
}

static void end_step(SceneryWalls *w, int steps)
{
    const double step_s = w->config->heat.step_s, dt_s = steps * step_s;
    w->now.day_k = wall_day_step(w->now.day_k, 0.5 * (w->weather[0].air.temp_k + w->weather[1].air.temp_k), dt_s);
    w->now.index += steps;
    for (double back_s = 0; back_s < dt_s; back_s += slot_s)
        w->now.direct_w_m2[half_hour_of((double)w->now.index * step_s - back_s)] = (float)w->weather[1].direct_w_m2;
    w->weather[0] = w->weather[1];
    w->ahead = 0;
}

static void work_ahead(SceneryWalls *w, int parts)
{
    const HeatConfig *c = &w->config->heat;
    for (int n = 0; n < parts && w->ahead < w->count + 1; n++, w->ahead++) {
        if (w->ahead == 0) c->weather(&w->weather[1], (double)(w->now.index + 1) * c->step_s, c->user);
        step_part(w, w->ahead, c->step_s);
    }
}

void scenery_walls_ahead(SceneryWalls *w) { work_ahead(w, 2); }

/* ---- tables ------------------------------------------------------------------------------------ */

/* Facets that no part faces stand for the used one nearest to them. */
static void find_nearest(const SceneryWalls *w, SceneryWall *wall)
{
    const int all = w->config->heat.facets * w->config->heat.facets;
    for (int c = 0; c < w->columns; c++) {
        double nearest = -2;
        wall->nearest[c] = c;
        if (wall->used[c]) continue;
        const WallFace want = face_of(w, c);
        for (int k = 0; k < all; k++) {
            if (!wall->used[k]) continue;
            const WallFace is = face_of(w, k);
            const double   along = v3_dot(want.n_enu, is.n_enu);
            if (along > nearest) nearest = along, wall->nearest[c] = k;
        }
    }
}

static void fill_wall(const SceneryWalls *w, WallsTable *out, int i)
{
    const SceneryWall *wall = &w->wall[i];
    const double       now_s = (double)w->now.index * w->config->heat.step_s;
    const double      *temp_k = w->now.temp_k + wall->first;
    float             *face_k = out->face_k + (size_t)i * (size_t)w->columns, *sun_k = out->sun_k[i];
    out->behind_k[i] = wall_behind_k(&wall->kind.of, solar_hour(w, now_s), w->now.day_k, out->air_k, w->now.room_k[i]);
    memset(sun_k, 0, sizeof out->sun_k[i]);
    for (int age = 0; age < heat_day_slots; age++) {
        const int half = half_hour_of(now_s - age * slot_s), slot = w->slot_of[half];
        if (slot >= 0) sun_k[slot] += wall->memory[age] * (float)wall->kind.absorptance * w->now.direct_w_m2[half];
    }
    for (int c = 0; c < w->columns; c++) {
        if (!wall->used[c]) continue;
        const WallFace face = face_of(w, c);
        double         sun = 0;
        for (int s = 0; s < w->slots && face.sun > 0; s++)
            sun += (double)sun_k[s] * scenery_walls_cosine(w, i, s, face.n_enu);
        face_k[c] = (float)(temp_k[0] - sun);
        temp_k += wall->kind.column.nodes;
    }
    for (int c = 0; c < w->columns; c++) face_k[c] = face_k[wall->nearest[c]];
}

static void fill_table(SceneryWalls *w, WallsTable *out)
{
    out->air_k = w->weather[0].air.temp_k;
    for (int k = 0; k < about_columns; k++) out->about_k[k] = w->now.about[k].state.temp_k[0];
    for (int i = 0; i < w->count; i++) fill_wall(w, out, i);
}

static void next_table(SceneryWalls *w)
{
    work_ahead(w, w->count + 1);
    end_step(w, 1);
    const WallsTable old = w->table[0];
    w->table[0] = w->table[1];
    w->table[1] = old;
    fill_table(w, &w->table[1]);
    w->shown = w->now.index;
}

/* ---- life -------------------------------------------------------------------------------------- */

static void copy_state(WallsState *out, const WallsState *from, const SceneryWalls *w)
{
    double *temp_k = out->temp_k;
    memcpy(temp_k, from->temp_k, w->temps * sizeof *temp_k);
    *out = *from;
    out->temp_k = temp_k;
}

static void back_to_begun(SceneryWalls *w)
{
    copy_state(&w->now, &w->begun, w);
    w->config->heat.weather(&w->weather[0], (double)w->now.index * w->config->heat.step_s, w->config->heat.user);
    w->ahead = 0;
    fill_table(w, &w->table[1]);
    next_table(w);
}

/* A day of level ground from the mean of the air: the mean of its surface is what the ground below has. ground_k: of
 * the ground about at each time of that day. */
static void start_about(SceneryWalls *w, double *ground_k, int count, double air_k)
{
    const HeatConfig    *c = &w->config->heat;
    const GroundWeather *at = w->course.at;
    double               sum[about_columns] = {0};
    for (int k = 0; k < about_columns; k++)
        ground_column_start(&w->now.about[k],
                            &w->config->ground->kind[k == about_paved ? SURFACE_BUILT : SURFACE_GRASS], &w->layers[k],
                            air_k);
    for (int i = 0; i < count; i++) {
        ground_k[i] = about_mean_k(w->now.about);
        step_about(w, w->now.about, &at[i], &at[i + 1], (double)w->course.wide * c->step_s);
        for (int k = 0; k < about_columns; k++) sum[k] += w->now.about[k].state.temp_k[0];
    }
    for (int k = 0; k < about_columns; k++)
        ground_column_start(&w->now.about[k], w->now.about[k].kind, &w->layers[k], sum[k] / count);
}

/* Outer temperature at which a day's mean flux is what goes through to behind_k. */
static double steady_k(const WallFlux *flux, int count, double through_w_m2k, double behind_k, double guess_k)
{
    double temp_k = guess_k;
    for (int n = 0; n < 8; n++) {
        double sum = through_w_m2k * (behind_k - temp_k), slope = through_w_m2k, falls;
        for (int i = 0; i < count; i++) {
            sum += wall_flux_w_m2(&falls, temp_k, &flux[i]) / count;
            slope += falls / count;
        }
        temp_k += clamp(sum / slope, -30, 30);
    }
    return temp_k;
}

enum { most_strides = 64 };

/* From the means of the day before the spin-up. */
static void start_walls(SceneryWalls *w)
{
    const HeatConfig    *c = &w->config->heat;
    const int            day = heat_day_strides(c), count = day < most_strides ? day : most_strides;
    const GroundWeather *at = w->course.at;
    double               ground_k[most_strides], air_k = 0;
    WallFlux             flux[most_strides];
    for (int i = 0; i < count; i++) air_k += at[i].air.temp_k / count;
    start_about(w, ground_k, count, air_k);
    w->now.day_k = air_k;
    for (int i = 0; i < w->count; i++) {
        const SceneryWall  *wall = &w->wall[i];
        const Construction *of = &wall->kind.of;
        double             *temp_k = w->now.temp_k + wall->first, behind_k = 0;
        ColumnState         state;
        const bool          room = of->inside == BEHIND_UNHEATED;
        for (int h = 0; h < 24; h++) behind_k += wall_behind_k(of, h + 0.5, air_k, air_k, air_k) / 24;
        const double through = room ? 0 : wall_conductance_w_m2k(&wall->kind);
        for (int k = 0; k < w->columns; k++) {
            const WallFace facing = face_of(w, k);
            if (!wall->used[k]) continue;
            for (int t = 0; t < count; t++)
                wall_flux(&flux[t], &wall->kind, &(WallPlace){&at[t], ground_k[t], w->ground_rho}, &facing);
            const double outer_k = steady_k(flux, count, through, behind_k, air_k);
            if (room) column_start(&state, &wall->kind.column, outer_k);
            else wall_start(&state, &wall->kind, outer_k, behind_k);
            memcpy(temp_k, state.temp_k, (size_t)wall->kind.column.nodes * sizeof *temp_k);
            temp_k += wall->kind.column.nodes;
        }
        w->now.room_k[i] = room ? inner_mean_k(w, wall, w->now.temp_k + wall->first) : behind_k;
    }
}

/* From the spin-up's first time to the beginning of the exercise. */
static void warm(SceneryWalls *w)
{
    const HeatConfig *c = &w->config->heat;
    w->now.index = w->first;
    start_walls(w);
    w->weather[0] = *heat_course_at(&w->course, w->now.index);
    while (w->now.index < w->begun_index) {
        const int    steps = w->now.index < w->course.fine_from ? (int)w->course.wide : 1;
        const double dt_s = steps * c->step_s;
        w->weather[1] = *heat_course_at(&w->course, w->now.index + steps);
        step_part(w, 0, dt_s);
        WallJob job = {
            w, dt_s, {&w->weather[0], w->about_k[0], w->ground_rho}, {&w->weather[1], w->about_k[1], w->ground_rho}};
        heat_run(c->pool, w->count, step_wall, &job);
        end_step(w, steps);
    }
    copy_state(&w->begun, &w->now, w);
}

/* K at the surface now for 1 W/m2 over each half hour of the day past. Film and emission as at 285 K in a wind of 3
 * m/s; nothing through the inner face. */
static void find_memory(SceneryWall *wall)
{
    static const double falls_w_m2k = 18;
    Column              c = wall->kind.column;
    ColumnState         s;
    c.conductance_w_m2k[c.nodes - 1] = 0;
    heat_pulse_start(&s, &c);
    const double falls = (wall->kind.of.inside == BEHIND_BACK ? 2 : 1) * falls_w_m2k;
    for (int age = 0; age < heat_day_slots; age++) wall->memory[age] = (float)heat_pulse_step(&s, &c, falls, slot_s);
}

static Status open_walls(SceneryWalls *w, const Materials *materials)
{
    const HeatConfig *c = &w->config->heat;
    const size_t      faces = (size_t)w->count * (size_t)w->columns;
    Status            status = STATUS_OK;
    for (int i = 0; i < w->count && status == STATUS_OK; i++) {
        SceneryWall *wall = &w->wall[i];
        status =
            wall_kind(&wall->kind, &w->config->constructions->row[wall->row], &materials->material[wall->material]);
        if (status != STATUS_OK) break;
        heat_factors_of(wall->factors[0], &wall->kind.column, c->step_s);
        heat_factors_of(wall->factors[1], &wall->kind.column, (double)heat_half_hour(c) * c->step_s);
        int room[room_faces];
        room_columns(room, c->facets);
        for (int k = 0; k < room_faces; k++) wall->used[room[k]] = true;
        for (int k = c->facets * c->facets; k < w->columns; k++) wall->used[k] = true;
        find_memory(wall);
        wall->nearest = malloc((size_t)w->columns * sizeof *wall->nearest);
        if (!wall->nearest) return STATUS_NO_MEMORY;
        find_nearest(w, wall);
        wall->first = w->temps;
        for (int k = 0; k < w->columns; k++) w->temps += wall->used[k] ? (size_t)wall->kind.column.nodes : 0;
    }
    w->now.temp_k = calloc(w->temps + 1, sizeof *w->now.temp_k);
    w->begun.temp_k = calloc(w->temps + 1, sizeof *w->begun.temp_k);
    for (int k = 0; k < 2; k++) w->table[k].face_k = calloc(faces + 1, sizeof *w->table[k].face_k);
    if (!w->now.temp_k || !w->begun.temp_k || !w->table[0].face_k || !w->table[1].face_k) return STATUS_NO_MEMORY;
    double absorbed = 0;
    for (int k = 0; k < about_columns && status == STATUS_OK; k++) {
        const GroundKind *kind = &w->config->ground->kind[k == about_paved ? SURFACE_BUILT : SURFACE_GRASS];
        status = ground_layers(&w->layers[k], kind, &c->grid);
        heat_factors_of(w->factors[0][k], &w->layers[k], c->step_s);
        heat_factors_of(w->factors[1][k], &w->layers[k], (double)heat_half_hour(c) * c->step_s);
        absorbed += k == about_hidden ? 0 : 0.5 * kind->absorptance;
    }
    w->ground_rho = 1 - absorbed;
    return status;
}

static CacheKey walls_key(const SceneryWalls *w)
{
    const SceneryHeatConfig *config = w->config;
    const HeatConfig        *c = &config->heat;
    const double             number[] = {c->grid.first_m, c->grid.growth, c->grid.depth_m, c->grid.tolerance_k,
                                         c->step_s,       c->spin_up_s,   c->unix_s,       config->east_rad};
    const int64_t            whole[] = {c->facets, w->count, w->course.wide, w->course.coarse, w->course.fine};
    CacheKey                 key = cache_key("warm walls");
    cache_key_add(&key, number, sizeof number);
    cache_key_add(&key, whole, sizeof whole);
    heat_kept_ground(&key, &config->ground->kind[SURFACE_GRASS]);
    heat_kept_ground(&key, &config->ground->kind[SURFACE_BUILT]);
    for (int i = 0; i < w->count; i++) {
        const SceneryWall  *wall = &w->wall[i];
        const Construction *of = &wall->kind.of;
        const int32_t       kind[] = {(int32_t)of->inside, of->layers};
        const double        figure[] = {of->inside_w_m2k, of->room_day_k, of->room_night_k,       of->room_j_m2k,
                                        of->room_w_m2k,   of->rough,      wall->kind.absorptance, wall->kind.emissivity};
        cache_key_add(&key, kind, sizeof kind);
        cache_key_add(&key, figure, sizeof figure);
        cache_key_add(&key, of->layer, (size_t)of->layers * sizeof *of->layer);
        cache_key_add(&key, wall->used, (size_t)w->columns * sizeof *wall->used);
    }
    cache_key_add(&key, w->course.at, (size_t)(w->course.coarse + w->course.fine) * sizeof *w->course.at);
    return key;
}

/* KeptValues of SceneryWalls: its state at the beginning. */
static void walls_kept(Kept *kept, void *user)
{
    SceneryWalls *w = user;
    WallsState   *s = &w->begun;
    for (int k = 0; k < about_columns; k++) {
        kept_doubles(kept, s->about[k].state.temp_k, (size_t)w->layers[k].nodes);
        kept_doubles(kept, &s->about[k].saturation, 1);
    }
    kept_doubles(kept, s->temp_k, w->temps);
    kept_doubles(kept, s->room_k, (size_t)w->count);
    kept_doubles(kept, &s->day_k, 1);
    kept_floats(kept, s->direct_w_m2, heat_day_slots);
}

Status scenery_walls_open(SceneryWalls *w, const Materials *materials)
{
    const HeatConfig *c = &w->config->heat;
    Status            status = open_walls(w, materials);
    if (status != STATUS_OK) return status;
    w->begun_index = (int64_t)floor(c->unix_s / c->step_s);
    w->first = w->begun_index - (int64_t)round(c->spin_up_s / c->step_s);
    w->slots = heat_day_sun(w->slot_of, w->slot_d_enu, c);
    status = heat_course_find(&w->course, c, w->first, w->begun_index);
    if (status != STATUS_OK) return status;
    CacheKey key = {.digest = NULL};
    if (c->cache) key = walls_key(w);
    for (int k = 0; k < about_columns; k++)
        ground_column_start(&w->begun.about[k],
                            &w->config->ground->kind[k == about_paved ? SURFACE_BUILT : SURFACE_GRASS], &w->layers[k],
                            0);
    w->begun.index = w->begun_index;
    if (!c->cache || !kept_fetch(walls_kept, w, c->cache, &key)) {
        warm(w);
        if (c->cache) kept_keep(walls_kept, w, c->cache, &key);
    }
    free(w->course.at);
    w->course.at = NULL;
    back_to_begun(w);
    return STATUS_OK;
}

void scenery_walls_close(SceneryWalls *w)
{
    for (int i = 0; w->wall && i < w->count; i++) free(w->wall[i].used), free(w->wall[i].nearest);
    for (int k = 0; k < 2; k++) free(w->table[k].face_k);
    free(w->wall), free(w->now.temp_k), free(w->begun.temp_k), free(w->course.at);
    *w = (SceneryWalls){0};
}

/* ---- now --------------------------------------------------------------------------------------- */

static double grid_time(const SceneryWalls *w, double unix_s)
{
    return clamp(unix_s / w->config->heat.step_s, (double)w->begun_index, 1e12);
}

void scenery_walls_advance(SceneryWalls *w, double unix_s)
{
    const double at = grid_time(w, unix_s);
    if (at < (double)(w->shown - 1)) back_to_begun(w);
    while (at > (double)w->shown) next_table(w);
}

double scenery_walls_share(const SceneryWalls *w, double unix_s)
{
    return clamp(grid_time(w, unix_s) - (double)(w->shown - 1), 0, 1);
}

size_t scenery_walls_bytes(const SceneryWalls *w)
{
    return (size_t)w->count * (sizeof *w->wall + (size_t)w->columns * (2 * sizeof(float) + 1)) +
           2 * w->temps * sizeof(double);
}
