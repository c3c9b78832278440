/* plants_scene OUT SCENE SUN_DEG: plants on flat ground under a sun of that elevation and an even sky, seen by
 * Pitviper, with everything that another renderer needs to see the same: tests/system/plants_judge.py.
 *
 * SCENE: oak or pine (one, and its shadow), stand (ninety trees of seven kinds, from above) or within (a
 * broadleaf forest of the product's own density, by rays that begin in it: straight down to its ground, and any way
 * from between its leaves). SUN_DEG below 0: there is no sun, under the same sky. Files of OUT, float32 rows: quads 12
 * corner coordinates, organ, kind, outline, albedo outlines  corners, then 24 u v pairs: one row for each kind and
 * outline rays      origin, direction, range, kind of hit, plant's organ, then radiance of red, green, near infrared
 *               under the sun alone, and again under sun and sky with what plants scatter
 * and scene.txt: names and numbers of the light and the materials. */
#include "render/frame/shade_private.h"

#include <stdio.h>
#include <stdlib.h>

enum { most_trees = 90, bands = 3 };

static const AirBand band_of[bands] = {AIR_R, AIR_G, AIR_NIR};
static const double  ground_rho = 0.25, sky_w_m2_sr = 25, within_m = 14;
static double        sun_w_m2 = 300;

typedef struct Shot {
    const char *name;
    int         trees, kind, width, height;
    double      half_m, eye_enu[3], at_enu[3], across; /* the image's width over the distance */
} Shot;

static const Shot shots[] = {
    {"oak", 1, PLANT_ENGLISH_OAK, 384, 384, 0, {-24, -20, 30}, {1, 2, 5}, 0.5},
    {"pine", 1, PLANT_PINE, 384, 384, 0, {-24, -20, 30}, {1, 2, 5}, 0.5},
    {"stand", most_trees, -1, 384, 256, 30, {-10, -110, 90}, {0, -4, 8}, 0.32},
    {"within", 0, -1, 512, 16, 0, {0, 0, 1}, {0, 1, 1}, 1},
};

static Plant plant[most_trees];
static bool  within; /* the shot's rays begin in the stand */

static double dice(uint32_t stream, int index) { return random_uniform(1995, stream, 0, (uint64_t)index); }

/* Trees of 10 to 18 m, every kind in turn; in a stand each in a cell of its own, off its middle. */
static Woods plant_trees(const Shot *shot)
{
    const int side = (int)ceil(sqrt(shot->trees));
    for (int i = 0; i < shot->trees; i++) {
        const double cell_m = 2 * shot->half_m / side;
        const bool   single = shot->trees == 1;
        plant[i] = (Plant){.height = (uint16_t)(1000 + 800 * dice(1, i)),
                           .twist = (uint16_t)(65535 * dice(2, i)),
                           .width = 128,
                           .kind = (uint8_t)(single ? shot->kind : i % PLANT_TREES)};
        if (single) continue;
        plant[i].p_m[0] = (float)(-shot->half_m + cell_m * (i % side + 0.2 + 0.6 * dice(3, i)));
        plant[i].p_m[1] = (float)(-shot->half_m + cell_m * (i / side + 0.2 + 0.6 * dice(4, i)));
        plant[i].lean[0] = (int8_t)(40 * (dice(5, i) - 0.5)), plant[i].lean[1] = (int8_t)(40 * (dice(6, i) - 0.5));
    }
    /* squares about the stand, so that the canopy's grid holds it; all plants are in the first */
    Woods woods = {.origin_enu = {-2 * woods_square_m, -2 * woods_square_m, 0},
                   .nx = 4,
                   .ny = 4,
                   .count = shot->trees,
                   .plant = plant};
    woods.first = calloc(17, sizeof *woods.first);
    for (int k = 1; woods.first && k <= 16; k++) woods.first[k] = (uint32_t)shot->trees;
    for (int i = 0; i < shot->trees; i++)
        for (int c = 0; c < 2; c++) plant[i].p_m[c] += (float)(2 * woods_square_m);
    for (int i = 0; i < shot->trees; i++) woods.by_kind[plant[i].kind]++;
    return woods;
}

/* A broadleaf forest of the density of its class, 88 m square. */
static Status plant_forest(Woods *woods)
{
    static const double half_m = 44;
    const Status        status = woods_of_class(woods, SURFACE_FOREST_BROADLEAF, 1, 7, 2);
    int                 kept = 0, square = 0;
    memset(woods->by_kind, 0, sizeof woods->by_kind);
    for (int i = 0; i < woods->count && status == STATUS_OK; i++) {
        const Plant p = woods->plant[i];
        while ((uint32_t)i == woods->first[square]) woods->first[square++] = (uint32_t)kept;
        if (fabs((double)p.p_m[0] + woods->origin_enu[0]) > half_m ||
            fabs((double)p.p_m[1] + woods->origin_enu[1]) > half_m)
            continue;
        woods->plant[kept++] = p;
        woods->by_kind[p.kind]++;
    }
    for (; status == STATUS_OK && square <= woods->nx * woods->ny; square++) woods->first[square] = (uint32_t)kept;
    woods->count = kept;
    return status;
}

/* ---- files ------------------------------------------------------------------------------------ */

static FILE *open_file(const char *folder, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file) log_error("plants_scene: cannot write %s", path), exit(1);
    return file;
}

static void write_quads(const char *folder, const Woods *woods, const Plants *plants)
{
    FILE *file = open_file(folder, "quads");
    for (int i = 0; i < woods->count; i++) {
        const Plant      *p = &woods->plant[i];
        const PlantShape *s = &plants->shape[p->kind][plant_whole];
        double            m[9];
        plant_transform(m, p, NULL);
        for (int k = 0; k < s->quads; k++) {
            const PlantQuad *q = &s->quad[k];
            float            row[16];
            for (int c = 0; c < 4; c++) {
                double corner[3];
                m3_mul_v3(corner, m,
                          (const double[3]){(double)q->corner[c][0], (double)q->corner[c][1], (double)q->corner[c][2]});
                for (int x = 0; x < 3; x++)
                    row[3 * c + x] = (float)(corner[x] + (double)p->p_m[x] + woods->origin_enu[x]);
            }
            row[12] = q->organ, row[13] = p->kind, row[14] = (float)(p->kind * plant_outlines + q->outline);
            row[15] = q->organ == PLANT_LEAF ? plants_leaf_albedo((PlantKind)p->kind, (uint32_t)i, q->piece) : 1;
            fwrite(row, sizeof row, 1, file);
        }
    }
    fclose(file);
    file = open_file(folder, "outlines");
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int o = 0; o < plant_outlines; o++) {
            const LeafOutline *out = &plants->outline[kind][o];
            float              row[1 + 2 * plant_outline_corners_most] = {(float)out->corners};
            memcpy(row + 1, out->uv, sizeof out->uv);
            fwrite(row, sizeof row, 1, file);
        }
    fclose(file);
}

static void write_scene(const char *folder, const double sun_enu[3], const Materials *materials)
{
    FILE *file = open_file(folder, "scene.txt");
    fprintf(file, "sun %.17g %.17g %.17g %g\nsky %g\nground %g\n", sun_enu[0], sun_enu[1], sun_enu[2], sun_w_m2,
            sky_w_m2_sr, ground_rho);
    for (int kind = 0; kind < PLANT_STANDING; kind++)
        for (int organ = PLANT_BARK; organ <= PLANT_LEAF; organ++) {
            const Material *m = &materials->material[materials->plant[kind][organ]];
            fprintf(file, "material %d %d", kind, organ);
            for (int b = 0; b < bands; b++)
                fprintf(file, " %.9g %.9g", (double)m->rho[band_of[b]], (double)m->tau[band_of[b]]);
            fprintf(file, "\n");
        }
    fclose(file);
}

/* ---- what Pitviper sees ----------------------------------------------------------------------- */

/* Diffuse, without gloss: the ground of one reflectance; bark and leaves as they are. */
static void make_plain(Materials *materials)
{
    bool of_plants[1024] = {false};
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int organ = 0; organ < PLANT_ORGANS; organ++) of_plants[materials->plant[kind][organ] % 1024] = true;
    for (int m = 0; m < materials->count; m++) {
        materials->material[m].gloss = 0;
        for (int c = 0; c < optical_channel_count && !of_plants[m % 1024]; c++)
            materials->material[m].rho[c] = (float)ground_rho;
    }
    for (int c = 0; c < optical_channel_count; c++) materials->ground_rho[c] = (float)ground_rho;
}

/* Bark of flat sides: how normals between corners are found is each renderer's own. */
static void flatten(Plants *plants)
{
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int k = 0; k < plants->shape[kind][plant_whole].bark_quads; k++) {
            PlantQuad *q = &plants->shape[kind][plant_whole].quad[k];
            double     u[3], v[3], n[3];
            for (int c = 0; c < 3; c++) {
                u[c] = (double)q->corner[2][c] - (double)q->corner[0][c];
                v[c] = (double)q->corner[3][c] - (double)q->corner[1][c];
            }
            v3_cross(n, u, v);
            if (!v3_normalize(n, n)) continue;
            for (int c = 0; c < 12; c++) q->n[c / 3][c % 3] = (float)n[c % 3];
        }
}

/* Rays that begin in the stand, evenly over its middle: those of the first quarter of the rows end on the ground, the
 * others go evenly any way from a place between the lowest leaves and the highest. */
static void fill_rays_within(Samples *s, const View *view, int row)
{
    const bool down = row < view->height / 4;
    s->rays.count = view->width;
    for (int i = 0; i < view->width; i++) {
        const int    at = row * view->width + i;
        const double up = down ? -1 : 2 * dice(10, at) - 1, turn = 2 * pi_rad * dice(11, at), flat = sqrt(1 - up * up);
        const double o[3] = {within_m * (2 * dice(7, at) - 1), within_m * (2 * dice(8, at) - 1),
                             down ? 0.1 : 1 + 21 * dice(9, at)};
        const double d[3] = {flat * cos(turn), flat * sin(turn), up};
        for (int c = 0; c < 3; c++) s->rays.o_enu[c][i] = o[c], s->rays.d_enu[c][i] = d[c];
        s->rays.far_m[i] = INFINITY;
    }
}

static void fill_rays(Samples *s, const View *view, int row)
{
    s->rays.count = view->width;
    for (int i = 0; i < view->width; i++) {
        double d[3];
        view_ray(d, view, i + 0.5, row + 0.5);
        for (int c = 0; c < 3; c++) s->rays.o_enu[c][i] = view->p_enu[c], s->rays.d_enu[c][i] = d[c];
        s->rays.far_m[i] = INFINITY;
    }
}

static View view_of(const Shot *shot)
{
    View   view = {.width = shot->width, .height = shot->height, .focal_px = shot->width / shot->across};
    double x[3], y[3], z[3];
    v3_sub(z, shot->at_enu, shot->eye_enu);
    v3_normalize(z, z);
    v3_cross(x, z, (const double[3]){0, 0, 1});
    v3_normalize(x, x);
    v3_cross(y, z, x);
    for (int c = 0; c < 3; c++) {
        view.p_enu[c] = shot->eye_enu[c];
        view.r_enu_from_cam[3 * c] = x[c], view.r_enu_from_cam[3 * c + 1] = y[c], view.r_enu_from_cam[3 * c + 2] = z[c];
    }
    return view;
}

/* One row of the image under a light; radiance: [bands][width]. full: sky, and what plants scatter. */
static Status see_row(float (*radiance)[hits_capacity], Samples *s, World *world, const View *view,
                      const double sun_enu[3], int row, bool full, Arena *arena)
{
    static Shader       shader;
    const Snapshot      empty = {0};
    const RenderRequest request = {.view = *view, .samples = 1, .hidden_entity = -1};
    Canopy *const       canopy = world->canopy;
    double              sky[AIR_BAND_COUNT];
    unsigned            channels = 0;
    Air                 air;
    ShadeScene          scene = {.world = world, .snapshot = &empty, .air = &air};
    for (int b = 0; b < bands; b++) channels |= 1u << band_of[b];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = full ? sky_w_m2_sr : 0;
    for (int c = 0; c < optical_channel_count; c++) world->materials.ground_rho[c] = full ? (float)ground_rho : 0;
    if (!full) world->canopy = NULL;
    air_even(&air, sun_enu, sun_w_m2, sky, 0, world->planck_mwir, world->planck_lwir);
    arena_reset(arena);
    Status status = shade_scene_create(&scene, &request, channels, NULL, arena);
    if (status == STATUS_OK) status = shade_samples_create(s, view->width, arena);
    if (status == STATUS_OK) {
        (within ? fill_rays_within : fill_rays)(s, view, row);
        s->channels = channels, s->per_rad = 1; /* footprints so wide that bark has no relief */
        scene.plants.per_rad = 1;
        shade_samples_shade(&shader, &scene, s, NULL, -1);
        for (int b = 0; b < bands; b++)
            memcpy(radiance[b], s->radiance[band_of[b]], (size_t)view->width * sizeof(float));
    }
    shade_scene_close(&scene);
    world->canopy = canopy;
    return status;
}

static Status see(const char *folder, const Shot *shot, World *world, const double sun_enu[3])
{
    static float   radiance[2][bands][hits_capacity];
    static Samples samples;
    const View     view = view_of(shot);
    Arena         *arena = arena_create();
    Status         status = arena ? STATUS_OK : STATUS_NO_MEMORY;
    FILE          *file = open_file(folder, "rays");
    for (int row = 0; row < view.height && status == STATUS_OK; row++) {
        for (int full = 0; full < 2 && status == STATUS_OK; full++)
            status = see_row(radiance[full], &samples, world, &view, sun_enu, row, full, arena);
        for (int i = 0; i < view.width && status == STATUS_OK; i++) {
            const Rays *r = &samples.rays;
            const Hits *h = &samples.hits;
            const bool  leaf = h->kind[i] == hit_plant && h->radius_m[i] == 0;
            float       line[9 + 2 * bands] = {
                      (float)r->o_enu[0][i],         (float)r->o_enu[1][i], (float)r->o_enu[2][i], (float)r->d_enu[0][i],
                      (float)r->d_enu[1][i],         (float)r->d_enu[2][i], (float)h->range_m[i],  h->kind[i],
                leaf ? PLANT_LEAF : PLANT_BARK};
            for (int b = 0; b < 2 * bands; b++) line[9 + b] = radiance[b / bands][b % bands][i];
            fwrite(line, sizeof line, 1, file);
        }
    }
    fclose(file);
    arena_destroy(arena);
    return status;
}

int main(int argc, char **argv)
{
    const Shot     *shot = NULL;
    Catalog        *catalog = NULL;
    Landscape       landscape = {0};
    World           world = {0};
    LocalFrame      frame;
    LandscapeConfig config = landscape_default_config();
    const Geodetic  origin = {0.6, -1.9, 0};
    double          sun_rad, sun_enu[3];
    char            path[512];
    for (size_t k = 0; argc == 4 && k < sizeof shots / sizeof *shots; k++)
        if (strcmp(argv[2], shots[k].name) == 0) shot = &shots[k];
    if (!shot || !text_to_double(&sun_rad, argv[3]))
        return fprintf(stderr, "usage: plants_scene OUT oak|pine|stand|within SUN_DEG\n"), 2;
    within = strcmp(shot->name, "within") == 0;
    if (sun_rad < 0) sun_w_m2 = 0, sun_rad = 45;
    sun_rad *= rad_per_deg;
    sun_enu[0] = 0.77 * cos(sun_rad), sun_enu[1] = -0.64 * cos(sun_rad), sun_enu[2] = sin(sun_rad);
    v3_normalize(sun_enu, sun_enu);
    config.relief_m = 0, config.half_width_m = 300, config.horizon_m = 2000;
    Woods  woods = {0};
    Status status = STATUS_OK;
    if (within) status = plant_forest(&woods);
    else woods = plant_trees(shot);
    if (status == STATUS_OK && !woods.first) status = STATUS_NO_MEMORY;
    if (!etc_path(path, sizeof path, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = catalog_open(&catalog, path, 0.05);
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_create(&landscape, &config, &frame, NULL, 0, NULL, 0);
    if (status == STATUS_OK) status = world_open(&world, catalog, &landscape, &frame, NULL);
    if (status == STATUS_OK) status = world_plant(&world, &woods, &(ForestConfig){.leaves = true}, NULL, NULL);
    if (status == STATUS_OK) {
        detail_table_close(world.detail);
        world.detail = NULL;
        make_plain(&world.materials);
        flatten(world.plants);
        write_scene(argv[1], sun_enu, &world.materials);
        write_quads(argv[1], &woods, world.plants);
        status = see(argv[1], shot, &world, sun_enu);
    }
    if (status != STATUS_OK) fprintf(stderr, "plants_scene: %s\n", status_name(status));
    world_close(&world);
    landscape_destroy(&landscape);
    catalog_close(catalog);
    if (within) woods_destroy(&woods);
    else free(woods.first);
    return status != STATUS_OK;
}
