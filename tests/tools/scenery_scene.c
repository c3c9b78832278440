/* tests/tools/scenery_scene.c: a gabled house on level ground under one sun and an even sky, as Pitviper shows it:
 * PART.obj (ENU), scene.txt, and radiance as floats [3][height][width].
 *     scenery_scene FOLDER        for test_scenery_judge.sh: direct (the sun alone), quick (the default), sampled (sky
 *                                 and surroundings over the hemisphere)
 *     scenery_scene FOLDER panes  for test_window_judge.sh: its windows are smooth panes, and the sun is low: of each
 *                                 view VIEW.txt and VIEW.bin
 *     scenery_scene FOLDER panes sampled  for test_window_judge_deep.sh: and VIEW_sampled.bin */
#include "tests/scenes/stress_world.h"
#include "tests/scenes/town.h"

#include "pitviper_output.h"

#include <stdlib.h>

enum { width = 168, height = 112 };
static const double sun_w_m2 = 300, sky_w_m2_sr = 40;

typedef struct Look {
    const char *name;
    double      focal_px, eye_enu[3], at_enu[3];
} Look;
static const Look house = {"scene", 190, {-24, -26, 13}, {-1, 1, 2.5}};
/* windows' middles are 1.35 m up on the sides of x -6.6 and 0.5. Where the sun is mirrored to the eye; the sky near
 * square and at grazing angles, on the sunny side and in shade; ground in the sun, 7 m and 2 m before the wall */
static const Look window[] = {
    {"glint", 1000, {3.705, 0.204, 0.56}, {0.505, -2.06, 1.36}}, {"sky", 700, {8, 6, 0.5}, {0.505, 1.93, 1.4}},
    {"grazing", 700, {1.5, -8, 0.6}, {0.505, -2.06, 1.4}},       {"shade", 700, {-14, -6, 0.5}, {-6.618, -2.06, 1.4}},
    {"ground", 700, {9, -7, 3}, {0.505, -2.06, 1.35}},           {"foot", 700, {9, -7, 7}, {0.505, -2.06, 1.35}}};
static const double      high_sun_enu[3] = {0.48, -0.6, 0.64}, low_sun_enu[3] = {0.8, -0.565685424949238, 0.2};
static const char *const part_name[3] = {"wall", "roof", "window"};
static const double      pane_rho = 2 * 0.04 / 1.04; /* of both sides of glass of index 1.5 */
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

static bool write_scene(const char *folder, const Look *look, const double sun_enu[3])
{
    char name[64];
    snprintf(name, sizeof name, "%s.txt", look->name);
    FILE *file = open_in(folder, name);
    if (!file) return false;
    fprintf(file, "size %d %d\nfocal_px %.17g\neye %.17g %.17g %.17g\nat %.17g %.17g %.17g\n", width, height,
            look->focal_px, look->eye_enu[0], look->eye_enu[1], look->eye_enu[2], look->at_enu[0], look->at_enu[1],
            look->at_enu[2]);
    fprintf(file, "sun %.17g %.17g %.17g %.17g\nsky %.17g\nground %.9g\n", sun_enu[0], sun_enu[1], sun_enu[2], sun_w_m2,
            sky_w_m2_sr, (double)ground_rho);
    for (int k = 0; k < 3; k++) fprintf(file, "part %s %.9g\n", part_name[k], (double)part_rho[k]);
    return fclose(file) == 0;
}

typedef struct Drawn {
    const char *name;
    double      sun_enu[3], sky;
    int         sky_samples;
} Drawn;

static bool draw(StressWorld *w, const char *folder, const Look *look, double ground_m, const Drawn *of)
{
    double d[3], eye[3], even[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) even[b] = of->sky;
    v3_sub(d, look->at_enu, look->eye_enu);
    memcpy(eye, look->eye_enu, sizeof eye), eye[2] += ground_m;
    const View    view = stress_view(eye, d, 0, width, height, look->focal_px);
    RenderRequest request = stress_request(&view);
    request.bands = 1u << BAND_OPTICAL, request.optical = OPTICAL_RGB;
    request.samples = of->sky_samples > 0 ? 3 : 4, request.edge_samples = 0;
    request.sky_samples = of->sky_samples, request.sky_visibility = of->sky_samples == 0;
    for (int c = 0; c < optical_channel_count; c++) /* with the sun alone nothing shines from below */
        w->world.materials.ground_rho[c] = of->sky > 0 ? ground_rho : 0;
    air_even(&w->air, of->sun_enu, sun_w_m2, even, 0, w->world.planck_mwir, w->world.planck_lwir);
    return stress_render(w, &request) && write_planes(folder, of->name, &w->picture);
}

static bool draw_house(StressWorld *w, const char *folder, double ground_m)
{
    const double *s = high_sun_enu;
    return write_scene(folder, &house, s) &&
           draw(w, folder, &house, ground_m, &(Drawn){"direct.bin", {s[0], s[1], s[2]}, 0, 0}) &&
           draw(w, folder, &house, ground_m, &(Drawn){"sampled.bin", {s[0], s[1], s[2]}, sky_w_m2_sr, 48}) &&
           draw(w, folder, &house, ground_m, &(Drawn){"quick.bin", {s[0], s[1], s[2]}, sky_w_m2_sr, 0});
}

static bool draw_windows(StressWorld *w, const char *folder, double ground_m, bool sampled)
{
    const double *s = low_sun_enu;
    bool          ok = true;
    for (size_t k = 0; k < sizeof window / sizeof *window && ok; k++) {
        char name[64];
        snprintf(name, sizeof name, "%s.bin", window[k].name);
        ok = write_scene(folder, &window[k], s) &&
             draw(w, folder, &window[k], ground_m, &(Drawn){name, {s[0], s[1], s[2]}, sky_w_m2_sr, 0});
        snprintf(name, sizeof name, "%s_sampled.bin", window[k].name);
        if (ok && sampled)
            ok = draw(w, folder, &window[k], ground_m, &(Drawn){name, {s[0], s[1], s[2]}, sky_w_m2_sr, 48});
    }
    return ok;
}

int main(int argc, char **argv)
{
    StressWorld w;
    Scenery     scenery = {0};
    const bool  panes = argc >= 3 && strcmp(argv[2], "panes") == 0;
    const bool  sampled = argc == 4 && strcmp(argv[3], "sampled") == 0;
    bool        ok = (argc == 2 || (panes && argc == 3 + sampled)) && stress_world_open(&w, 2) == STATUS_OK;
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
        if (ok) set_material(m, row, panes && k == 2 ? (float)pane_rho : part_rho[k]);
        if (ok && panes && k == 2) m->material[row].gloss = 1, m->material[row].roughness = 0;
        ok = ok && write_part(argv[1], &scenery.object[0], &scenery.model[0], k, ground_m);
    }
    /* what shines on the ground about it is of the materials as they are when scenery joins the world */
    ok = ok && world_scenery(&w.world, &scenery, NULL, w.pool) == STATUS_OK;
    ok = ok && (panes ? draw_windows(&w, argv[1], ground_m, sampled) : draw_house(&w, argv[1], ground_m));
    stress_world_close(&w);
    scenery_free(&scenery);
    return ok ? 0 : 1;
}
