/* render/frame/world.c: opens the tables and the tracer once. */
#include "render/frame/world.h"

#include "render/light/sky_kept.h"
#include "render/parts/parts.h"

#include <stdlib.h>

Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame,
                  const char *isa)
{
    World  world = {.catalog = catalog, .landscape = landscape, .frame = *frame, .radar = {.lobe_rad = 0.05}};
    char   materials[512], surfaces[512], detail[512], parts[512], machines[512];
    Status status = STATUS_BAD_VALUE;

    if (!etc_path(materials, sizeof materials, "materials.csv") || !etc_path(surfaces, sizeof surfaces, "surfaces.csv") ||
        !etc_path(detail, sizeof detail, "ground_detail.csv") || !etc_path(parts, sizeof parts, "heat.csv") ||
        !etc_path(machines, sizeof machines, "heat_machines.csv")) {
        log_error("render: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    status = tracer_create(&world.tracer, catalog, isa);
    if (status == STATUS_OK) status = materials_open(&world.materials, materials, surfaces, catalog);
    if (status == STATUS_OK) status = part_table_open(&world.parts, parts, machines);
    if (status == STATUS_OK && !(world.patches = calloc(1, sizeof *world.patches))) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = patch_set_create(world.patches, catalog_model_count(catalog));
    if (status == STATUS_OK) status = sky_kept_create(&world.sky, sky_kept_octets);
    if (status == STATUS_OK) status = detail_table_open(&world.detail, detail, detail_cut_off);
    PlanckTable **const planck[2] = {&world.planck_mwir, &world.planck_lwir};
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(planck[k], low_m, high_m);
    }
    if (status != STATUS_OK) {
        world_close(&world);
        return status;
    }
    *out = world;
    return STATUS_OK;
}

Status world_need_patches(const World *world, const Snapshot *snapshot)
{
    Status status = STATUS_OK;
    for (int i = 0; i < snapshot->count && status == STATUS_OK; i++) {
        const SnapshotEntity *e = &snapshot->entity[i];
        if (e->first_patch < 0 || e->model < 0 || e->model >= tracer_model_count(world->tracer)) continue;
        status = tracer_need(world->tracer, e->model);
        if (status == STATUS_OK) status = patch_set_need(world->patches, e->model, tracer_model(world->tracer, e->model));
    }
    return status;
}

Status world_plant(World *world, const Woods *woods, const ForestConfig *config, const char *isa, Pool *pool)
{
    static const uint64_t plants_seed = 1995; /* the prototypes are the same in every world */
    char   optics[512], ground[512];
    if (!etc_path(optics, sizeof optics, "plant_optics.csv") || !etc_path(ground, sizeof ground, "woods.csv")) {
        log_error("render: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    Status status = materials_add_plants(&world->materials, optics, ground);
    if (status == STATUS_OK) status = plants_create(&world->plants, plants_seed, pool);
    if (status == STATUS_OK) status = forest_create(&world->forest, woods, world->plants, config, isa);
    if (status != STATUS_OK) return status;
    forest_openness(world->plants, world->forest, pool);
    status = canopy_create(&world->canopy, woods, world->plants, &world->materials, config->leaves);
    if (status != STATUS_OK) return status;
    return far_woods_create(&world->far_woods, woods, world->forest, &world->materials, config->leaves, pool);
}

void world_close(World *world)
{
    world_cool(world);
    forest_destroy(world->forest);
    canopy_destroy(world->canopy);
    far_woods_destroy(world->far_woods);
    plants_destroy(world->plants);
    atmosphere_close(world->atmosphere);
    planck_table_destroy(world->planck_lwir);
    planck_table_destroy(world->planck_mwir);
    detail_table_close(world->detail);
    materials_close(&world->materials);
    if (world->patches) patch_set_destroy(world->patches);
    free(world->patches);
    sky_kept_destroy(world->sky);
    tracer_destroy(world->tracer);
    memset(world, 0, sizeof *world);
}
