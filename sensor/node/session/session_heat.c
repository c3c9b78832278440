/* sensor/node/session/session_heat.c: temperatures of the session's entities, which outlast a frame. */
#include "sensor/node/session/session_private.h"

#include <unistd.h>

enum { work_ticks = seeker_ticks_per_s / 10 };

Status session_heat_open(Session *s)
{
    const SessionShared *shared = s->shared;
    if (!shared->world->heat) return STATUS_OK;
    s->heat.arena = arena_create();
    if (!s->heat.arena) return STATUS_NO_MEMORY;
    const char *given = shared->config->heat.given;
    const char *kept = shared->config->heat.vehicles;
    Status      status = *given ? given_heat_open(&s->heat.given, given) : STATUS_OK;
    if (status == STATUS_OK && *kept && access(kept, F_OK) == 0) status = heat_kept_open(&s->heat.kept, kept);
    if (status != STATUS_OK) return status;
    return world_vehicles_create(&s->heat.vehicles, shared->world,
                                 &(WorldVehiclesConfig){.step_s = shared->config->heat.vehicle_step_s,
                                                        .window_us = vehicle_window_us,
                                                        .given = s->heat.given,
                                                        .kept = s->heat.kept});
}

/* Every second, when something appeared, fired or burst, and while work is left. */
void session_heat_warm(Session *s, double tick_s)
{
    const uint64_t changes = entity_table_changes(s->table);
    if (!s->heat.vehicles) return;
    const bool left = s->tick % work_ticks == 0 && vehicle_heat_waits(world_vehicles_heat(s->heat.vehicles));
    if (s->tick % seeker_ticks_per_s != 0 && changes == s->heat.changes && !left) return;
    Snapshot snapshot;
    arena_reset(s->heat.arena);
    Status status = entity_table_snapshot(&snapshot, s->table, tick_s, s->heat.arena);
    if (status == STATUS_OK) status = world_vehicles_tick(s->heat.vehicles, &snapshot);
    session_note_failure(s, "heat of vehicles", status);
    s->heat.changes = changes;
}

void session_heat_report(const Session *s)
{
    if (!s->heat.vehicles) return;
    const VehicleHeat         *heat = world_vehicles_heat(s->heat.vehicles);
    const VehicleHeatCounters *c = vehicle_heat_counters(heat);
    log_detail("heat of vehicles: %llu begun, %llu steps, %.0f ms in all, %.1f ms the longest tick, %.2f MB",
               (unsigned long long)c->begun, (unsigned long long)c->steps, 1e3 * c->spent_s, 1e3 * c->longest_s,
               1e-6 * (double)vehicle_heat_bytes(heat));
    if (c->neighbours_left_out > 0)
        log_detail("heat of vehicles: %llu times a neighbour was one too many for another entity's heat",
                   (unsigned long long)c->neighbours_left_out);
    if (c->left_out > 0)
        log_warn(
            "heat of vehicles: too many entities: those with the highest ids were as warm as the air (entities.shown)");
    if (c->failed > 0)
        log_warn("heat of vehicles: %llu steps were given up, and temperatures kept; look at etc/heat.csv and "
                 "etc/heat_machines.csv for extreme values",
                 (unsigned long long)c->failed);
}

Status session_heat_keep(const Session *s)
{
    if (!s->heat.vehicles || !*s->shared->config->heat.vehicles) return STATUS_OK;
    return vehicle_heat_keep(world_vehicles_heat(s->heat.vehicles), s->shared->config->heat.vehicles);
}

void session_heat_close(Session *s)
{
    world_vehicles_destroy(s->heat.vehicles);
    given_heat_close(s->heat.given);
    heat_kept_close(s->heat.kept);
    arena_destroy(s->heat.arena);
}
