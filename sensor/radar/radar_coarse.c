/* sensor/radar/radar_coarse.c: a radar's coarse signatures (render/scattering/signatures/coarse.h): opened when they
 * are needed, and prepared while a node has nothing in sight. */
#include "sensor/radar/seeker_radar_private.h"

enum { coarse_nice = 5 }; /* before fine ones, after rendering */

Status radar_coarse_open(SeekerRadar *r)
{
    if (r->coarse) return STATUS_OK;
    SignaturesConfig config = signatures_coarse(&r->fine);
    config.nice = coarse_nice;
    const Status status = catalog_open(&r->coarse_catalog, r->catalog_path, coarse_sag_m());
    return status == STATUS_OK ? signatures_create(&r->coarse, &config, r->coarse_catalog, &r->materials) : status;
}

void radar_coarse_close(SeekerRadar *r)
{
    signatures_destroy(r->coarse);
    if (r->coarse_catalog) catalog_close(r->coarse_catalog);
}

Status seeker_radar_prepare(SeekerRadar *r, const Catalog *catalog, const Snapshot *snapshot)
{
    Status status = STATUS_OK;
    for (int i = 0; i < snapshot->count && status == STATUS_OK && r->coarse; i++) {
        const SnapshotEntity *e = &snapshot->entity[i];
        Origin                origin;
        if (!catalog_has_shape(catalog, e->model)) continue;
        status =
            signatures_prepare(r->coarse, catalog_find(r->coarse_catalog, e->type, &origin, NULL), snapshot_damage(e));
    }
    return status;
}

RadarPrepared seeker_radar_prepared(const SeekerRadar *r)
{
    if (!r->coarse) return (RadarPrepared){0};
    return (RadarPrepared){(int)signatures_counters(r->coarse).made, signatures_waiting(r->coarse)};
}
