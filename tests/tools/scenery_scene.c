/* tests/tools/scenery_scene.c: scenery_scene FOLDER: a gabled house on level ground under one sun and an even sky, as
 * Pitviper shows it, for test_scenery_judge.sh: PART.obj (ENU), scene.txt, and radiance as floats [3][height][width]:
 * direct (the sun alone), quick (the default), sampled (sky and surroundings over the hemisphere). */
#include "tests/scenes/stress_world.h"
#include "tests/scenes/town.h"

#include "pitviper_output.h"

#include <stdlib.h>

enum { width = 168, height = 112 };
static const double focal_px = 190, sun_w_m2 = 300, sky_w_m2_sr = 40, eye_enu[3] = {-24, -26, 13},
                    at_enu[3] = {-1, 1, 2.5};
static const char *const part_name[3] = {"wall", "roof", "window"};
static const float       part_rho[3] = {0.45f, 0.25f, 0.1f}, ground_rho = 0.3f;

static FILE *open_in(const char *folder, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return output_file(path, 0);
}

static bool write_part(const char *folder, const SceneryObject *o, const Model *m, int part, double ground_m)
{
    char name[64];
    snprintf(name, sizeof name, "%s.obj", part_name[part]);
    FILE *file = open_in(folder, name);
    int   vertices = 0;
    for (int t = 0; file && t < m->triangle_count; t++) {
        if (strcmp(m->part[m->triangle_part[t]].name, part_name[part]) != 0) continue;
        for (int c = 0; c < 3; c++) {
            double p[3];
            m3_mul_v3(p, o->r_enu_from_body, m->vertex[m->triangle[t][c]]);
            v3_add(p, p, o->p_enu);
            fprintf(file, "v %.9f %.9f %.9f\n", p[0], p[1], p[2] - ground_m);
        }
        vertices += 3;
        fprintf(file, "f %d %d %d\n", vertices - 2, vertices - 1, vertices);
    }
    return file && fclose(file) == 0 && vertices > 0;
}

static bool write_planes(const char *folder, const char *name, const Picture *p)
{
    FILE        *file = open_in(folder, name);
    const size_t count = (size_t)width * height;
    bool         ok = file != NULL;
    for (int k = 0; k < 3 && ok; k++) ok = fwrite(p->optical[k], sizeof(float), count, file) == count;
    return file && fclose(file) == 0 && ok;
}

static void set_material(Materials *m, int row, float rho)
{
    for (int c = 0; c < optical_channel_count; c++) m->material[row].rho[c] = rho;
    m->material[row].gloss = 0;
}

static bool draw(StressWorld *w, const char *folder, const char *name, double ground_m, double sky, int sky_samples)
{
    const double sun_enu[3] = {0.48, -0.6, 0.64};
    double       d[3], eye[3], even[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) even[b] = sky;
    v3_sub(d, at_enu, eye_enu);
    memcpy(eye, eye_enu, sizeof eye), eye[2] += ground_m;
    const View    view = stress_view(eye, d, 0, width, height, focal_px);
    RenderRequest request = stress_request(&view);
    request.bands = 1u << BAND_OPTICAL, request.optical = OPTICAL_RGB;
    request.samples = sky_samples > 0 ? 3 : 4, request.edge_samples = 0;
    request.sky_samples = sky_samples, request.sky_visibility = sky_samples == 0;
    for (int c = 0; c < optical_channel_count; c++) /* with the sun alone nothing shines from below */
        w->world.materials.ground_rho[c] = sky > 0 ? ground_rho : 0;
    air_even(&w->air, sun_enu, sun_w_m2, even, 0, w->world.planck_mwir, w->world.planck_lwir);
    FILE *file = open_in(folder, "scene.txt");
    if (!file) return false;
    fprintf(file, "size %d %d\nfocal_px %.17g\neye %.17g %.17g %.17g\nat %.17g %.17g %.17g\n", width, height, focal_px,
            eye_enu[0], eye_enu[1], eye_enu[2], at_enu[0], at_enu[1], at_enu[2]);
    fprintf(file, "sun %.17g %.17g %.17g %.17g\nsky %.17g\nground %.9g\n", sun_enu[0], sun_enu[1], sun_enu[2], sun_w_m2,
            sky_w_m2_sr, (double)ground_rho);
    for (int k = 0; k < 3; k++) fprintf(file, "part %s %.9g\n", part_name[k], (double)part_rho[k]);
    return fclose(file) == 0 && stress_render(w, &request) && write_planes(folder, name, &w->picture);
}

int main(int argc, char **argv)
{
    StressWorld w;
    Scenery     scenery = {0};
    bool        ok = argc == 2 && stress_world_open(&w, 2) == STATUS_OK;
    if (!ok) return 2;
    w.world.landscape = &w.landscape;
    detail_table_close(w.world.detail);
    w.world.detail = NULL;
    Materials *m = &w.world.materials;
    for (int s = 0; s < SURFACE_COUNT; s++) set_material(m, m->surface[s], ground_rho);
    for (int c = 0; c < optical_channel_count; c++) m->ground_rho[c] = ground_rho;
    const TownOf of = {.buildings = 1, .middle_enu = {51, 51}, .landscape = &w.landscape, .seed = 5};
    ok = town_create(&scenery, &of) == STATUS_OK;
    if (ok) strcpy(scenery.model[0].part[0].material, "brick_red"); /* no ground is of it, as some is of concrete */
    const double ground_m = elevation_height(&w.landscape.elevation, 0, 0, NULL);
    for (int k = 0; k < 3 && ok; k++) {
        const int row = materials_find(m, scenery.model[0].part[k].material);
        ok = strcmp(scenery.model[0].part[k].name, part_name[k]) == 0 && row > 0;
        if (ok) set_material(m, row, part_rho[k]);
        ok = ok && write_part(argv[1], &scenery.object[0], &scenery.model[0], k, ground_m);
    }
    /* what shines on the ground about it is of the materials as they are when scenery joins the world */
    ok = ok && world_scenery(&w.world, &scenery, NULL, w.pool) == STATUS_OK;
    ok = ok && draw(&w, argv[1], "direct.bin", ground_m, 0, 0);
    ok = ok && draw(&w, argv[1], "sampled.bin", ground_m, sky_w_m2_sr, 48);
    ok = ok && draw(&w, argv[1], "quick.bin", ground_m, sky_w_m2_sr, 0);
    stress_world_close(&w);
    scenery_free(&scenery);
    return ok ? 0 : 1;
}
