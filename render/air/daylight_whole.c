/* render/air/daylight_whole.c: daylight under a weather: its totals, and with the tables by direction in a pool's
 * tasks. */
#include "render/air/air_private.h"
#include "render/air/atmosphere_private.h"

static AirState state_of(const Atmosphere *model, const Weather *weather)
{
    Weather w = *weather;
    if (isnan(w.air_temp_k)) w.air_temp_k = atmosphere_temp_k(model, 0);
    return (AirState){droplets_haze_m(w.visibility_m, w.fog), w.air_temp_k, weather_vapour_kg_m3(&w)};
}

Status daylight_air(const Atmosphere **out, const Atmosphere *model, const Weather *weather, unsigned bands,
                    Arena *arena)
{
    const AirState state = state_of(model, weather);
    return atmosphere_in(out, model, &state, bands, arena);
}

void daylight_at(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun)
{
    const AirState state = state_of(source->atmosphere, weather);
    AirSource      here = *source;
    AirSums        room;
    double         diffuse_w_m2[AIR_BAND_COUNT];
    here.atmosphere = atmosphere_sums_in(&room, source->atmosphere, &state);
    memset(out, 0, offsetof(Daylight, sky));
    daylight_sums(out, &here, weather, sun, 0, diffuse_w_m2);
}

static void ask_task(void *user, int worker, int task)
{
    (void)worker;
    daylight_ask(user, task);
}

static void draw_task(void *user, int worker, int task)
{
    (void)worker;
    daylight_draw(user, task);
}

static void plane_task(void *user, int worker, int task)
{
    (void)worker;
    daylight_plane(user, task);
}

void air_run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool) pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

Status daylight_by_direction(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun,
                             unsigned bands, Pool *pool, Arena *arena)
{
    const DaylightInput in = {.source = source, .weather = weather, .sun = sun, .bands = bands};
    DaylightJob        *job;
    const Status        status = daylight_begin(&job, out, &in, arena);
    if (status != STATUS_OK) return status;
    air_run(pool, daylight_asks(job), ask_task, job);
    air_run(pool, daylight_draws(job), draw_task, job);
    air_run(pool, daylight_planes(job), plane_task, job);
    daylight_end(job);
    return STATUS_OK;
}
