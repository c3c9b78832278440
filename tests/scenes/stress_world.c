/* tests/scenes/stress_world.c: worlds of blocks, and frames of them, for stress cases. */
#include "tests/scenes/stress_world.h"
#include "pitviper_output.h"

#include <stdlib.h>
#include <unistd.h>

/* A catalog of the marker alone, a plain block; unknown entities keep its shape. */
static Status open_catalog(Catalog **out)
{
    static const char text[] = "type,model,origin\n1,marker,base\n";
    char              path[temp_path_size];
    FILE             *file = temp_file(path, "") ? output_file(path, 0) : NULL;
    if (!file) return STATUS_IO;
    const bool   written = fputs(text, file) >= 0;
    const Status status = fclose(file) == 0 && written ? catalog_open(out, path, 0.01) : STATUS_IO;
    unlink(path);
    return status;
}

Status stress_world_open(StressWorld *out, int threads)
{
    const Geodetic  origin_at = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    StressWorld     w = {.arena = arena_create(), .air_arena = arena_create()};
    config.relief_m = 0;
    config.half_width_m = 500;
    config.horizon_m = 20000;
    w.entity = calloc(stress_entities, sizeof *w.entity);
    w.pose = calloc(stress_entities, sizeof *w.pose);
    Status status = w.entity && w.pose && w.arena && w.air_arena ? open_catalog(&w.catalog) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin_at);
    if (status == STATUS_OK) status = landscape_create(&w.landscape, &config, &frame, NULL, 0, NULL, 0);
    if (status == STATUS_OK) status = world_open(&w.world, w.catalog, NULL, &frame, NULL);
    if (status == STATUS_OK) status = atmosphere_open(&w.world.atmosphere, "us1976");
    if (status == STATUS_OK) status = pool_create(&w.pool, threads);
    *out = w;
    const int row = status == STATUS_OK ? materials_find(&w.world.materials, "rubber_black") : -1;
    if (row >= 0) {
        Material *m = &w.world.materials.material[row];
        for (int c = 0; c < optical_channel_count; c++) m->rho[c] = stress_rho;
        m->rho_mwir = m->rho_lwir = stress_rho_ir;
        m->gloss = 0;
        m->metal = 1;
    } else if (status == STATUS_OK) {
        status = STATUS_BAD_VALUE;
    }
    if (status != STATUS_OK) stress_world_close(out);
    else stress_clear(out);
    return status;
}

void stress_world_close(StressWorld *w)
{
    pool_destroy(w->pool);
    world_close(&w->world);
    if (w->landscape.cover) landscape_destroy(&w->landscape);
    catalog_close(w->catalog);
    arena_destroy(w->arena);
    arena_destroy(w->air_arena);
    free(w->entity);
    free(w->pose);
    *w = (StressWorld){0};
}

void stress_clear(StressWorld *w) { w->snapshot = (Snapshot){.entity = w->entity, .node = w->pose}; }

void stress_add(StressWorld *w, const double p_enu[3], const double r_enu_from_body[9])
{
    static const double side_body[3] = {0, -1, -0.75};
    const int           k = w->snapshot.count++;
    SnapshotEntity     *e = &w->entity[k];
    double              off_enu[3], base_enu[3];
    *e = (SnapshotEntity){.id = {(uint16_t)(1 + k / 60000), 1, (uint16_t)(1 + k % 60000)}, .model = 1, .first_node = k};
    m3_mul_v3(off_enu, r_enu_from_body, side_body);
    v3_sub(base_enu, p_enu, off_enu);
    ecef_from_enu(e->p_ecef, &w->world.frame, base_enu);
    m3_mul(e->r_ecef_from_body, w->world.frame.r_ecef_from_enu, r_enu_from_body);
    w->pose[k] = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    w->snapshot.node_count = w->snapshot.count;
}

void stress_no_air(StressWorld *w, const double sun_enu[3])
{
    static const double dark[AIR_BAND_COUNT] = {0};
    Air                *a = &w->air;
    air_even(a, sun_enu, stress_sun_w_m2, dark, 0, w->world.planck_mwir, w->world.planck_lwir);
    for (int b = AIR_MWIR; b <= AIR_LWIR; b++) a->light.sun_w_m2[b] = a->sun_eye_w_m2[b] = 0;
    a->light.solar_direct_w_m2 = a->light.solar_diffuse_w_m2 = 0;
    for (int c = 0; c < optical_channel_count; c++) w->world.materials.ground_rho[c] = 0;
}

Status stress_real_air(StressWorld *w, double e, double eye_m)
{
    const AirSource source = {w->world.atmosphere, w->world.planck_mwir, w->world.planck_lwir, 0, 0};
    const AirEye    eye = {.height_m = eye_m, .bands = (1 << AIR_BAND_COUNT) - 1};
    const Weather   weather = weather_default();
    const Sun       sun = {.elevation_rad = e, .distance_au = 1, .d_enu = {0, -cos(e), sin(e)}};
    arena_reset(w->air_arena);
    return air_at(&w->air, &source, &weather, &sun, &eye, NULL, w->air_arena);
}

View stress_view(const double p_enu[3], const double d_enu[3], double turn_rad, int width, int height, double focal_px)
{
    View         view = {.width = width, .height = height, .focal_px = focal_px};
    double       x[3], y[3], z[3];
    const double aside[3] = {fabs(d_enu[2]) > 0.9 * v3_length(d_enu), 0, fabs(d_enu[2]) <= 0.9 * v3_length(d_enu)};
    v3_normalize(z, d_enu);
    v3_cross(x, z, aside);
    v3_normalize(x, x);
    v3_cross(y, z, x);
    for (int k = 0; k < 3; k++) {
        view.p_enu[k] = p_enu[k];
        view.r_enu_from_cam[3 * k] = cos(turn_rad) * x[k] + sin(turn_rad) * y[k];
        view.r_enu_from_cam[3 * k + 1] = cos(turn_rad) * y[k] - sin(turn_rad) * x[k];
        view.r_enu_from_cam[3 * k + 2] = z[k];
    }
    return view;
}

RenderRequest stress_request(const View *view)
{
    return (RenderRequest){.view = *view,
                           .bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR,
                           .truth = true,
                           .samples = 1,
                           .edge_samples = 4,
                           .target_samples = 48,
                           .hidden_entity = -1};
}

bool stress_render(StressWorld *w, const RenderRequest *request)
{
    arena_reset(w->arena);
    return render(&w->picture, &w->world, &w->snapshot, request, &w->air, w->pool, w->arena) == STATUS_OK;
}

double stress_bad_values(const Picture *p)
{
    const size_t count = (size_t)p->width * (size_t)p->height;
    double       bad = 0;
    for (int k = 0; k < picture_plane_count; k++) {
        const float *plane = picture_plane(p, k);
        for (size_t i = 0; plane && i < count; i++) bad += !(plane[i] >= 0 && plane[i] < INFINITY);
    }
    for (size_t i = 0; p->range_m && i < count; i++) {
        const bool sky = p->range_m[i] == INFINITY;
        bad += !(p->range_m[i] >= 0) + (!sky && !(p->temp_k[i] > 0 && p->temp_k[i] < 1e5f));
        for (int c = 0; c < 3; c++) bad += !(fabsf(p->normal[c][i]) <= 1.0001f);
    }
    return bad;
}

static double plane_differences(const void *a, int a_width, const void *b, int b_width, const int at[6])
{
    double different = 0;
    if (!a || !b) return a != b;
    for (int y = 0; y < at[5]; y++)
        for (int x = 0; x < at[4]; x++)
            different +=
                memcmp((const char *)a + 4 * ((size_t)(at[1] + y) * (size_t)a_width + (size_t)(at[0] + x)),
                       (const char *)b + 4 * ((size_t)(at[3] + y) * (size_t)b_width + (size_t)(at[2] + x)), 4) != 0;
    return different;
}

double stress_differences(const Picture *a, int ax, int ay, const Picture *b, int bx, int by, int width, int height)
{
    const int at[6] = {ax, ay, bx, by, width, height};
    double    different = 0;
    for (int k = 0; k < picture_plane_count; k++)
        different += plane_differences(picture_plane(a, k), a->width, picture_plane(b, k), b->width, at);
    different += plane_differences(a->range_m, a->width, b->range_m, b->width, at);
    different += plane_differences(a->entity, a->width, b->entity, b->width, at);
    different += plane_differences(a->material, a->width, b->material, b->width, at);
    different += plane_differences(a->temp_k, a->width, b->temp_k, b->width, at);
    for (int c = 0; c < 3; c++) different += plane_differences(a->normal[c], a->width, b->normal[c], b->width, at);
    return different;
}
