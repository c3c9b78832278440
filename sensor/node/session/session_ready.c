/* sensor/node/session/session_ready.c: what a live session makes ready of the entities heard, before frames need it:
 * the models of the tracer, the beginnings of their heat (session_heat.c), and what instruments need. */
#include "sensor/node/session/session_private.h"

#include "render/heat/vehicle_heat.h"

#include <stdlib.h>

static const double prepare_s = 0.5; /* exercise time between two looks at the table */

Status session_ready_open(Session *s)
{
    if (!s->shared->live) return STATUS_OK;
    s->ready.built = calloc((size_t)catalog_model_count(s->shared->catalog) + 1, sizeof *s->ready.built);
    s->ready.arena = arena_create();
    s->ready.next_s = -INFINITY;
    return s->ready.built && s->ready.arena ? STATUS_OK : STATUS_NO_MEMORY;
}

void session_ready_close(Session *s)
{
    free(s->ready.built);
    arena_destroy(s->ready.arena);
}

/* Builds models that are not yet. While frames are made, one at a time: a frame builds what it shows by itself. */
static Status build_models(Session *s, const Snapshot *snapshot)
{
    const bool one_alone = s->host->is_there(s->host);
    Status     status = STATUS_OK;
    s->ready.unbuilt = 0;
    for (int i = 0, built = 0; i < snapshot->count && status == STATUS_OK; i++) {
        const int model = snapshot->entity[i].model;
        if (s->ready.built[model] || !catalog_has_shape(s->shared->catalog, model)) continue;
        if (one_alone && built > 0) {
            s->ready.unbuilt++;
            continue;
        }
        status = tracer_need(s->shared->world->tracer, model);
        s->ready.built[model] = true;
        s->ready.models++;
        built++;
    }
    return status;
}

void session_prepare(Session *s, double t_s)
{
    if (!s->shared->live || t_s < s->ready.next_s) return;
    Snapshot snapshot;
    s->ready.next_s = t_s + prepare_s;
    arena_reset(s->ready.arena);
    Status status = entity_table_snapshot(&snapshot, s->table, t_s, s->ready.arena);
    if (status == STATUS_OK) status = build_models(s, &snapshot);
    if (status == STATUS_OK) status = instruments_prepare(&s->instruments, s->shared->catalog, &snapshot);
    session_note_failure(s, "preparing for frames", status);
    s->ready.entities = snapshot.count;
}

SessionReady session_ready(const Session *s)
{
    const InstrumentReady instruments = instruments_ready(&s->instruments);
    const bool            heat = s->heat.vehicles && vehicle_heat_waits(world_vehicles_heat(s->heat.vehicles));
    return (SessionReady){.entities = s->ready.entities,
                          .models = s->ready.models,
                          .signatures = instruments.made,
                          .waiting = s->ready.unbuilt + instruments.waiting + heat};
}
