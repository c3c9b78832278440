/* tests/fuzz/fuzz_frame_file.c: any octets as a frame file; and its fields damaged behind checksums that are right.
 * What is accepted must be what render() can be given: indices within their arrays, and ground that can be made.
 * Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/verify/saved_frame/saved_scene.h"
#include "sensor/verify/saved_frame/ground_cutout_private.h"

#include <stdlib.h>

const int fuzz_rounds = 3000;

/* ---- a small file ------------------------------------------------------------------------------- */

static void identity(double r[9]) { m3_identity(r); }

/* A house, a road, a tank and a tree of files; on invented ground they are invented. */
static void build(SavedScenery *out, bool invented)
{
    static double      corner[6][2] = {{0, 0}, {9, 0}, {9, 7}, {0, 7}, {-30, -9}, {40, -8}};
    static Building    house = {.id = 1,
                                .corners = 4,
                                .base_m = 2,
                                .eaves_m = 5,
                                .ridge_m = 8,
                                .roof = ROOF_GABLED,
                                .roof_fabric = FABRIC_TILE,
                                .levels = 2,
                                .heated = true};
    static CultureLine road = {
        .id = 2, .first_corner = 4, .corners = 2, .width_m = 5, .kind = CULTURE_ROAD, .surface = 1};
    static CulturePoint tank = {.id = 3, .x_m = 30, .size_m = {4, 4, 6}, .kind = CULTURE_TANK};
    static CultureTree  tree = {.id = 4, .y_m = 30, .height_m = 12};
    *out = (SavedScenery){.plan = {.from = invented ? CULTURE_FROM_SEED : CULTURE_FROM_RECORDS,
                                   .invented = {7, {0, 0}, 200},
                                   .clutter = 1,
                                   .south_west_m = {-200, -200},
                                   .north_east_m = {200, 200}},
                          .objects = 3};
    if (!invented) out->culture = (Culture){6, 1, 1, 1, 1, corner, &house, &road, &tank, &tree, {0}, 0, 0, NULL};
}

/* Two entities, a puff, a mark of each sort; ground of two nested levels with cover and a photograph, or invented; with
 * plants or without, with scenery or without. */
static void small_file(ByteSink *out, bool invented, bool planted, bool built)
{
    static uint16_t       stored[elevation_tile_posts];
    static ElevationTile  tile[1] = {{-elevation_base_unit, 2}};
    static uint8_t        cover[16 * 16];
    static PhotoBlock     block[2];
    static NodePose       node[2];
    static SnapshotEntity entity[2];
    static EffectPuff     puff;
    static SavedModel     model = {.model = 3, .node_count = 1, .name = "box"};
    static SavedPlane     plane = {.name = "lwir/Y", .mean = 1};
    static GroundFix      fix = {{1, 2, 3}, 1};
    static ClearLine      line = {{0, 0, 9}, {100, 0, 9}};
    static CoastPlace     place = {50, 60, true};
    SavedFrame file = {.version = "1", .host = "1:2:3", .config_sha256 = "", .settings = "seed: 1\n", .frame = 7};
    file.tables.count = 1;
    strcpy(file.tables.table[0].name, "heat.csv");
    file.model = &model, file.model_count = 1;
    file.plane = &plane, file.plane_count = 1;
    for (int e = 0; e < 2; e++) {
        entity[e] = (SnapshotEntity){.id = {1, 2, (uint16_t)(3 + e)},
                                     .type = {.kind = 1, .domain = 1},
                                     .model = 3,
                                     .p_ecef = {6378137, e, 0},
                                     .first_node = e};
        identity(entity[e].r_ecef_from_body);
        identity(node[e].r_body_from_node);
    }
    puff = (EffectPuff){.kind = EFFECT_SMOKE,
                        .p_ecef = {6378137, 0, 0},
                        .up_ecef = {1, 0, 0},
                        .axis_ecef = {1, 0, 0},
                        .throw_s = 1,
                        .scale = 1,
                        .mass_kg = 1};
    file.snapshot =
        (Snapshot){.count = 2, .node_count = 2, .entity = entity, .node = node, .puff_count = 1, .puff = &puff};
    static GroundStand stand = {.p_ecef = {6378137, 0, 0},
                                .low_m = {-4, -2, -3},
                                .high_m = {4, 2, 0},
                                .from_s = -3600,
                                .to_s = INFINITY,
                                .owner = 7};
    static GroundTrack track = {.a_ecef = {6378137, 0, 0},
                                .b_ecef = {6378137, 4, 0},
                                .a_s = 1,
                                .b_s = 2,
                                .width_m = 0.5f,
                                .apart_m = 2.5f,
                                .heat_j_m2 = 9000,
                                .tracked = true};
    static GroundBurn  burn = {.p_ecef = {6378137, 0, 9}, .t_s = 3, .radius_m = 2, .crater_m = 1, .heat_j_m2 = 1e5f};
    identity(stand.r_ecef_from_body);
    if (planted) file.snapshot.marks = (GroundMarks){1, 1, 1, &stand, &track, &burn, 5};
    file.request = (RenderRequest){.view = {.width = 16, .height = 12, .focal_px = 30},
                                   .bands = 15,
                                   .truth = true,
                                   .samples = 1,
                                   .hidden_entity = 0,
                                   .profile_bins = 16,
                                   .profile_bin_m = 0.3};
    identity(file.request.view.r_enu_from_cam);
    identity(file.eye.r_ecef_from_cam);
    identity(file.r_ecef_from_body);
    file.ground = (LandscapeParts){.invented = invented, .config = landscape_default_config()};
    if (invented) {
        file.ground.said = (LandscapeEvidence){1, 1, 1, &fix, &line, &place, 0};
    } else {
        ElevationLevel *level = file.ground.elevation.level;
        file.ground.elevation.level_count = 2;
        if (elevation_level_describe(&level[0], &(ElevationGrid){17, 17, -8, -8, 1, 0, 0.1}) != STATUS_OK) abort();
        if (elevation_level_describe(&level[1], &(ElevationGrid){9, 9, -32, -32, 8, 0, 0.1}) != STATUS_OK) abort();
        level[0].tile = level[1].tile = tile, level[0].stored = level[1].stored = stored;
        level[1].plain = false;
        file.ground.cover[0] = (CoverGrid){.nx = 16, .ny = 16, .x0_m = -8, .y0_m = -8, .cell_m = 1, .surface = cover};
        file.ground.photo =
            (Photo){.mips = 2, .nx = {2, 1}, .ny = {2, 1}, .cell_m = 8, .block = {&block[0], &block[1]}};
    }
    static const WoodsPath path[2] = {{{1, 2}, {3, 4}, 5, 0}, {{6, 7}, {6, 7}, 8, 3}};
    file.planted = planted;
    if (planted) file.woods = (WoodsConfig){.half_width_m = 500, .most_trees = 70, .path_count = 2, .path = path};
    file.built = built;
    if (built) build(&file.scenery, invented);
    static double joint[64];
    file.measured = planted;
    if (planted)
        file.radar = (SavedRadar){
            .has_aim = true, .aim_m = 900, .number = 7, .joint_count = file.snapshot.node_count, .joint = joint};
    if (file.snapshot.node_count > 64) abort();
    if (saved_frame_pack(out, &file, NULL) != STATUS_OK) abort();
}

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    ByteSink file = {0};
    small_file(&file, index % 2 == 0, index / 2 % 2 == 1, index / 4 % 2 == 1);
    const size_t size = file.count;
    if (size > fuzz_seed_octets) abort();
    memcpy(out, file.bytes, size);
    sink_free(&file);
    return size;
}

/* ---- one input ---------------------------------------------------------------------------------- */

/* Whether it was accepted, and its ground made where that is quick. */
static bool parse(const uint8_t *data, size_t size)
{
    bool        made = false;
    SavedFrame *file = malloc(sizeof *file);
    Arena      *arena = arena_create();
    if (!file || !arena) abort();
    if (saved_frame_parse(file, data, size, "input", arena) == STATUS_OK) {
        const Snapshot *s = &file->snapshot;
        for (int e = 0; e < s->count; e++)
            if (!v3_is_finite(s->entity[e].p_ecef) || s->entity[e].first_node > s->node_count) abort();
        if (file->request.hidden_entity >= s->count || file->eye.host_index >= s->count) abort();
        if (!(file->request.view.focal_px > 0) || file->plane_count > frame_max_planes) abort();
        const GroundMarks *m = &s->marks;
        for (int i = 0; i < m->stands; i++)
            if (!v3_is_finite(m->stand[i].p_ecef) || !(m->stand[i].from_s <= m->stand[i].to_s)) abort();
        for (int i = 0; i < m->tracks; i++)
            if (!v3_is_finite(m->track[i].a_ecef) || !(m->track[i].a_s <= m->track[i].b_s)) abort();
        for (int i = 0; i < m->burns; i++)
            if (!v3_is_finite(m->burn[i].p_ecef) || !(m->burn[i].radius_m >= 0)) abort();
        const WoodsConfig *w = &file->woods;
        if (file->planted && !(w->half_width_m >= 50 && w->most_trees <= woods_most_trees)) abort();
        for (int i = 0; i < w->path_count; i++)
            if (!isfinite(w->path[i].a_m[0] + w->path[i].b_m[1]) || !(w->path[i].half_m >= 0)) abort();
        const Culture *c = &file->scenery.culture;
        if (culture_fault(c)) abort();
        if (file->built && !(file->scenery.plan.clutter <= 20 && file->scenery.plan.invented.half_width_m <= 1e6))
            abort();
        Landscape   landscape = {0};
        const char *why = NULL;
        size_t      posts = 0;
        for (int n = 0; n < file->ground.elevation.level_count; n++)
            posts += (size_t)file->ground.elevation.level[n].nx * (size_t)file->ground.elevation.level[n].ny;
        if (!file->ground.invented && posts < 1 << 16 &&
            landscape_from_parts(&landscape, &why, &file->ground) == STATUS_OK) {
            float factor[albedo_channels];
            for (int k = -40; k <= 40; k += 5) {
                const double z_m = elevation_height(&landscape.elevation, k, 0.3 * k, NULL);
                if (isinf(z_m)) abort();
                if (landscape_surface(&landscape, k, 0.3 * k) >= SURFACE_COUNT) abort();
                landscape_albedo(factor, &landscape, SURFACE_GRASS, k, 0.3 * k, 1);
            }
            FrameScenery scenery; /* its buildings alone: clutter has its own table and limits */
            file->scenery.plan.clutter = 0;
            if (file->built && file->scenery.plan.from == CULTURE_FROM_RECORDS) {
                (void)saved_scenery_make(&scenery, &landscape, file, true);
                frame_scenery_free(&scenery);
            }
            landscape_destroy(&landscape);
            made = true;
        }
        made |= file->ground.invented;
    }
    arena_destroy(arena);
    free(file);
    return made;
}

/* The same octets as they are, and with every chunk's plain octets packed anew: what a checksum would hide. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bool begun = false;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    for (int k = 0; k < 8 && !begun; k++) { /* an undamaged file is accepted, or nothing here is tried */
        ByteSink whole = {0};
        small_file(&whole, k % 2 == 0, k / 2 % 2 == 1, k >= 4);
        if (!parse(whole.bytes, whole.count)) abort();
        sink_free(&whole);
    }
    begun = true;
    (void)parse(data, size);

    ChunkSource chunks;
    ByteSink    again = {0};
    char        name[chunk_name_size + 1];
    ByteSource  content;
    ByteSink    seed = {0};
    Arena      *arena = arena_create();
    if (!arena) abort();
    small_file(&seed, size % 2 == 0, size / 2 % 2 == 0, size / 4 % 2 == 0);
    if (chunks_open(&chunks, seed.bytes, seed.count, arena) != STATUS_OK) abort();
    chunks_begin(&again);
    for (int c = 0; chunks_next(&chunks, name, &content) == STATUS_OK && *name; c++) {
        ByteSink     plain = {0};
        const size_t octets = (size_t)(content.end - content.at);
        sink_bytes(&plain, content.at, octets);
        /* four octets say: which chunk, where, what */
        for (size_t i = 0; i + 3 < size && i < 24; i += 4)
            if (octets > 0 && data[i] % 13 == c)
                plain.bytes[(data[i + 1] | (size_t)data[i + 2] << 8) % octets] ^= data[i + 3];
        chunks_put(&again, name, &plain);
        sink_free(&plain);
    }
    chunks_end(&again);
    if (!again.failed) (void)parse(again.bytes, again.count);
    sink_free(&again);
    sink_free(&seed);
    arena_destroy(arena);
    return 0;
}
