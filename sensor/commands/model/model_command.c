/* sensor/commands/model/model_command.c: `pitviper model`: lists models, describes one, draws it from eight sides. */
#include "entities/catalog/model_info.h"
#include "entities/import/sidecar.h"
#include "sensor/frame/json_object.h"
#include "sensor/commands/commands.h"
#include "pitviper_output.h"
#include "render/scene/view.h"
#include "sensor/commands/model/model_stage.h"
#include "sensor/detector/display_values.h"
#include "sensor/detector/level.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/publish/images/picture_text.h"
#include "sensor/settings/command_line.h"
#include "sensor/settings/config.h"

#include <stdlib.h>
#include <strings.h>

/* ---- `pitviper model info --json`: lengths in m, angles in deg ----------------------------------- */

/* Names and paths are other people's octets. */
static void set_text(json_t *object, const char *key, const char *text)
{
    char safe[4400];
    text_escape(safe, sizeof safe, text, strlen(text));
    json_object_set_new(object, key, json_string(safe));
}

static void set_count(json_t *object, const char *key, long long count)
{
    json_object_set_new(object, key, json_integer(count));
}

static json_t *numbers(const double *value, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(array, json_real(value[i] + 0.0));
    return array;
}

static json_t *import_json(const ModelImport *r)
{
    static const char *const source[MATERIAL_SOURCE_COUNT] = {"sidecar", "name", "colour", "default"};
    json_t                  *import = json_object(), *lost = json_object(), *left = json_object(), *by = json_object();
    char                     axis[4];
    set_text(import, "file", r->file);
    set_count(import, "octets", r->octets);
    if (r->sidecar[0]) set_text(import, "sidecar", r->sidecar);
    json_set_number(import, "scale_m", r->scale_m);
    set_text(import, "scale_from", r->unit_from);
    set_text(import, "forward", model_info_axis(axis, r, 0));
    set_text(import, "up", model_info_axis(axis, r, 1));
    set_text(import, "axes_from", r->axes_from);
    json_object_set_new(import, "mirrored", json_boolean(r->mirrored));
    json_object_set_new(import, "origin", numbers(r->p_origin_file, 3));
    set_count(import, "nodes", r->source_nodes);
    set_count(import, "meshes", r->source_meshes);
    set_count(import, "materials", r->source_materials);
    set_count(import, "unnamed_nodes", r->unnamed_nodes);
    set_count(import, "shared_names", r->shared_names);
    set_count(import, "joints_from_file", r->joints_from_file);
    set_count(import, "smoothed_parts", r->smoothed_parts);
    set_count(left, "meshes_by_sidecar", r->dropped_meshes);
    set_count(left, "meshes_without_triangles", r->empty_meshes);
    set_count(left, "triangles_without_area", r->degenerate_triangles);
    json_object_set_new(import, "left_out", left);
    for (int i = 0; i < IMPORT_LOST_COUNT; i++)
        if (r->lost[i] > 0) set_count(lost, import_lost_name((ImportLost)i), r->lost[i]);
    json_object_set_new(import, "lost", lost);
    for (int i = 0; i < MATERIAL_SOURCE_COUNT; i++) set_count(by, source[i], r->material_parts[i]);
    json_object_set_new(import, "material_parts_by", by);
    return import;
}

static json_t *node_json(const Model *m, const ModelNode *node)
{
    const bool turns = node->joint == JOINT_ROTATION;
    json_t    *out = json_object();
    set_text(out, "name", node->name);
    if (node->parent >= 0) {
        set_text(out, "parent", m->node[node->parent].name);
        json_object_set_new(out, "at_m", numbers(node->p_parent, 3));
    }
    if (node->joint == JOINT_FIXED) return out;
    set_text(out, "joint", turns ? "turns" : "slides");
    json_object_set_new(out, "axis", numbers(node->axis, 3));
    if (node->low <= node->high) {
        const double limit[2] = {turns ? node->low / rad_per_deg : node->low,
                                 turns ? node->high / rad_per_deg : node->high};
        json_object_set_new(out, turns ? "limits_deg" : "limits_m", numbers(limit, 2));
    }
    if (node->dis_class) {
        set_count(out, "dis_class", node->dis_class);
        set_count(out, "dis_metric", node->dis_metric);
    }
    if (node->spin_rps_moving != 0) json_set_number(out, "spin_rpm", node->spin_rps_moving * 60 / (2 * pi_rad));
    if (node->roll_radius_m > 0) json_set_number(out, "roll_radius_m", node->roll_radius_m);
    return out;
}

static json_t *part_json(const Model *m, const ModelPart *part)
{
    json_t *out = json_object();
    set_text(out, "name", part->name);
    set_text(out, "node", m->node[part->node].name);
    set_text(out, "material", part->material);
    set_text(out, "heat", heat_role_name(part->role));
    set_count(out, "triangles", part->triangle_count);
    if (part->thickness_m > 0) json_set_number(out, "thickness_mm", 1e3 * part->thickness_m);
    return out;
}

/* Prints one JSON object and a line end. False: there is no memory, or it cannot be written. */
static bool model_record_print(FILE *to, const ModelInfo *info)
{
    const Model *m = &info->model;
    const double size[3] = {m->length_m, m->width_m, m->height_m};
    json_t      *out = json_object(), *edges = json_object(), *nodes = json_array(), *parts = json_array();
    set_text(out, "model", m->name);
    if (info->imported) json_object_set_new(out, "import", import_json(&info->import));
    else json_set_number(out, "sag_m", m->sag_m);
    json_object_set_new(out, "size_m", numbers(size, 3));
    if (info->sized) {
        json_object_set_new(out, "size_fits", json_boolean(info->fit.fits));
        if (!info->fit.fits) set_text(out, "size_advice", info->fit.advice);
    }
    if (info->odd) set_text(out, "odd_size", info->advice);
    json_object_set_new(out, "box_low_m", numbers(m->box_low, 3));
    json_object_set_new(out, "box_high_m", numbers(m->box_high, 3));
    json_set_number(out, "radius_m", m->radius_m);
    set_count(out, "triangles", m->triangle_count);
    set_count(out, "vertices", m->vertex_count);
    set_count(edges, "open", info->edges.open);
    set_count(edges, "open_parts", info->edges.open_parts);
    set_count(edges, "crowded", info->edges.crowded);
    set_count(edges, "inside_out_parts", info->edges.inside_out_parts);
    json_object_set_new(out, "edges", edges);
    for (int i = 0; i < m->node_count; i++) json_array_append_new(nodes, node_json(m, &m->node[i]));
    for (int i = 0; i < m->part_count; i++) json_array_append_new(parts, part_json(m, &m->part[i]));
    json_object_set_new(out, "nodes", nodes);
    json_object_set_new(out, "parts", parts);
    char *text = json_dumps(out, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    json_decref(out);
    if (text) text_print(to, "%s\n", text);
    free(text);
    return text != NULL;
}

/* ---- show: optical, with a scale, in one image ------------------------------------------------------ */

/* ---- the command ------------------------------------------------------------------------------- */

enum {
    columns = 4,
    rows = 2,
    tile_width = 360,
    tile_height = 270,
    width = columns * tile_width,
    height = rows * tile_height
};
static const double view_hfov_deg = 20, view_down_deg = 14;

static void dot(uint8_t *rgb, int x, int y, uint8_t value)
{
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    memset(rgb + 3 * ((size_t)y * width + (size_t)x), value, 3);
}

static void write_text(uint8_t *rgb, int x, int y, const char *text)
{
    picture_text_write(rgb, width, height, x, y, text);
}

/* The largest of 1, 2 or 5 times a power of ten that is not above this. */
static double round_length(double most)
{
    const double power = pow(10, floor(log10(most)));
    return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

/* Draws a scale bar of a round length, at the distance of the model. */
static void draw_scale(uint8_t *rgb, double px_per_m)
{
    const double length_m = round_length(0.3 * tile_width / px_per_m);
    const int    px = (int)(length_m * px_per_m + 0.5), y = height - 14;
    char         text[32];
    for (int x = -1; x <= px + 1; x++)
        for (int v = -1; v <= 4; v++) dot(rgb, 12 + x, y + v, x < 0 || x > px || v < 0 || v > 3 ? 0 : 255);
    snprintf(text, sizeof text, "%g m", length_m);
    write_text(rgb, 12, y - 20, text);
}

/* Gives a view from the south, slightly above, with the whole model in the image. px_per_m: the scale at the model. */
static View view_of(double *px_per_m, const ModelStage *stage)
{
    const Model *model = catalog_model(stage->catalog, stage->model);
    double       reach_m = 0;
    for (int k = 0; k < 4; k++) /* largest horizontal distance of a corner from the centre, for any rotation */
        reach_m = fmax(reach_m, hypot(k & 1 ? model->box_high[0] : model->box_low[0],
                                      k & 2 ? model->box_high[1] : model->box_low[1]));
    const double tall_m = fmax(-model->box_low[2], 0.01), low_m = fmax(model->box_high[2], 0);
    const double half_m = fmax(1.1 * reach_m, 0.75 * (tall_m + low_m) * tile_width / tile_height);
    const double away_m = half_m / tan(0.5 * view_hfov_deg * rad_per_deg) + 0.3 * reach_m;
    const double down_rad = view_down_deg * rad_per_deg;
    View         view = {
                .width = tile_width, .height = tile_height, .focal_px = view_focal_px(tile_width, view_hfov_deg * rad_per_deg)};
    const double *at = stage->place_m, ground_m = elevation_height(&stage->landscape.elevation, at[0], at[1], NULL);
    const double  towards[3] = {0, cos(down_rad), -sin(down_rad)};
    const double  aim[3] = {at[0], at[1], ground_m + 0.5 * (tall_m - low_m)};
    v3_add_scaled(view.p_enu, aim, -away_m, towards);
    view_upright(view.r_enu_from_cam, towards);
    *px_per_m = view.focal_px / away_m;
    return view;
}

/* Renders one side into its tile of the three planes. */
static Status draw_side(float *const plane[3], double white[3], double *px_per_m, ModelStage *stage, int side)
{
    Snapshot       snapshot;
    SnapshotEntity entity;
    Picture        picture;
    arena_reset(stage->arena);
    const RenderRequest request = {.view = view_of(px_per_m, stage),
                                   .bands = 1u << BAND_OPTICAL,
                                   .optical = OPTICAL_RGB,
                                   .sky_visibility = true,
                                   .samples = 1,
                                   .edge_samples = 4,
                                   .target_samples = 48,
                                   .hidden_entity = -1};
    /* the first view is nose on; the others follow clockwise from above: right side, tail ... */
    Status status = model_stage_put(&snapshot, &entity, stage, -0.5 * pi_rad - side * 0.25 * pi_rad);
    /* sun, atmosphere and view are the same for all sides: only the model turns */
    if (status == STATUS_OK && side == 0) status = model_stage_light(stage, &request, stage->begin_s);
    if (status == STATUS_OK)
        status = render(&picture, &stage->world, &snapshot, &request, &stage->air, stage->pool, stage->arena);
    if (status != STATUS_OK) return status;
    memcpy(white, picture.white_w_m2_sr, 3 * sizeof *white);
    const size_t left = (size_t)(side % columns) * tile_width, top = (size_t)(side / columns) * tile_height;
    for (int c = 0; c < 3; c++)
        for (size_t y = 0; y < tile_height; y++)
            memcpy(plane[c] + (top + y) * width + left, picture.optical[c] + y * tile_width,
                   tile_width * sizeof(float));
    return STATUS_OK;
}

static void write_labels(uint8_t *rgb, const Model *model, double px_per_m)
{
    char text[80];
    for (int side = 0; side < columns * rows; side++) {
        snprintf(text, sizeof text, "%d deg", 45 * side);
        write_text(rgb, side % columns * tile_width + 12, side / columns * tile_height + 10, text);
    }
    for (int y = 0; y < height; y++)
        for (int k = 1; k < columns; k++) dot(rgb, k * tile_width, y, 0);
    for (int x = 0; x < width; x++) dot(rgb, x, tile_height, 0);
    draw_scale(rgb, px_per_m);
    snprintf(text, sizeof text, "%.2f x %.2f x %.2f m", model->length_m, model->width_m,
             fmax(model->box_high[2], 0) - model->box_low[2]);
    write_text(rgb, width - 12 * (int)strlen(text) - 8, height - 24, text);
}

/* Opens the stage on a morning in June. */
static Status open_stage(ModelStage *stage, const char *name, double sag_m)
{
    const Geodetic   origin = {.lat_rad = 48 * rad_per_deg, .lon_rad = 11 * rad_per_deg};
    ModelStageConfig config = {.name = name, .sag_m = sag_m, .origin = origin, .surface = SURFACE_NONE};
    if (!text_to_unix_s(&config.begin_s, "2026-06-21T09:00:00Z")) return STATUS_BAD_VALUE;
    return model_stage_open(stage, &config);
}

/* Writes a PNG of the model (a built-in name, a file or a sidecar) from eight sides, every 45 degrees, with a scale. */
static Status show_model(const char *name, double sag_m, const char *out)
{
    const size_t count = (size_t)width * height;
    ModelStage   stage = {0};
    double       white[3] = {0}, px_per_m = 1;
    float       *values = calloc(3 * count, sizeof *values);
    uint8_t     *rgb = malloc(3 * count);
    Status       status = values && rgb ? open_stage(&stage, name, sag_m) : STATUS_NO_MEMORY;
    float *const plane[3] = {values, values + count, values + 2 * count};
    for (int side = 0; side < columns * rows && status == STATUS_OK; side++)
        status = draw_side(plane, white, &px_per_m, &stage, side);
    if (status == STATUS_OK) {
        const Model   *model = catalog_model(stage.catalog, stage.model);
        DetectorConfig display = detector_default_config();
        DisplayColour  colour;
        display.display_gamma = true;
        display_colour(&colour, white, 0, INFINITY);
        /* fixed exposure: a reflectance of 0.5 is white, for every model */
        display.auto_level = false;
        display.level_low = 0;
        display.level_high = 0.5 * colour.white;
        display_colour_apply(plane, (const float *const *)plane, count, &colour);
        const float *const shown[3] = {plane[0], plane[1], plane[2]};
        detector_display_rgb(rgb, shown, count, &display, detector_level(&display, shown, 3, count));
        write_labels(rgb, model, px_per_m);
        status = image_write_png(out, rgb, width, height, 3, 8);
        if (status == STATUS_OK)
            printf("%s: %s, %.3f x %.3f x %.3f m (length, width, height), from eight sides, nose on first\n", out,
                   model->name, model->length_m, model->width_m, fmax(model->box_high[2], 0) - model->box_low[2]);
    }
    if (status == STATUS_NO_MEMORY) log_error("model: out of memory: %s", name);
    model_stage_close(&stage);
    free(values);
    free(rgb);
    return status;
}

/* ---- the command ------------------------------------------------------------------------------------ */

static const char help[] =
    "usage: pitviper model list [-c FILE]\n"
    "       pitviper model info NAME|FILE [--sag M] [--length M] [--width M] [--height M] [-c FILE] [--json]\n"
    "       pitviper model show NAME|FILE [--out PNG] [--sag M] [-c FILE]\n"
    "       pitviper model --keys\n"
    "\n"
    "list: every built-in shape and every row of the catalog: name, kind, size, source, articulated parts.\n"
    "info: contents of a model: nodes and joints, parts, materials, heat, size; of a file its unit and axes, where they\n"
    "come from, and what the import lost.\n"
    "show: an optical image of it from eight sides, with a scale: PNG.\n"
    "\n"
    "NAME: a built-in model (tank, truck, helicopter ...). FILE: OBJ, glTF, AC3D, 3DS, ASE, PLY, STL and others, also\n"
    "as .gz; OpenFlight (.flt, by osgconv); or a sidecar (.yaml) that names one. A sidecar beside the file is read:\n"
    "tank.glb, tank.yaml. etc/ADDING.md describes how to add vehicles, materials, sensors and shapes.\n"
    "\n"
    "  --sag M            chord error of a built-in model: largest distance of facets from surfaces, 1e-05 .. 0.1 m "
    "(0.005)\n"
    "  --length M         scale a built-in model to that length, width or height, as a row of etc/catalog.csv does:\n"
    "  --width M          0.001 .. 2000 m; sizes not given follow in proportion. Length and width: bounding box at\n"
    "  --height M         rest; height: above the ground, or above the lowest point below it. For a file: checks that\n"
    "                     it has that size, and prints which axes or scale would give it\n"
    "  --out PNG          output of show (default: NAME.png in the current folder)\n"
    "  --config FILE      or -c: settings, whose models.catalog and models.materials are read\n"
    "  --json             info as one JSON object\n"
    "  --keys             every key of a sidecar: type, unit, range, meaning\n";

typedef struct ModelOptions {
    const char *name, *out, *config;
    double      sag_m;
    ModelSize   size;
    bool        json;
} ModelOptions;

typedef enum Option { OUT = 256, CONFIG, SAG, LENGTH, WIDTH, HEIGHT, JSON, HELP } Option;

/* allowed: bits of the options that apply to the action. 0: valid; else exit with this code - 1. argv[0] is the
 * action. */
static int parse(ModelOptions *o, unsigned allowed, int argc, char **argv)
{
    static const struct option options[] = {
        {"out", 1, NULL, OUT},       {"config", 1, NULL, CONFIG}, {"sag", 1, NULL, SAG},
        {"length", 1, NULL, LENGTH}, {"width", 1, NULL, WIDTH},   {"height", 1, NULL, HEIGHT},
        {"json", 0, NULL, JSON},     {"help", 0, NULL, HELP},     {NULL, 0, NULL, 0}};
    double *const figure[] = {&o->size.length_m, &o->size.width_m, &o->size.height_m};
    *o = (ModelOptions){.sag_m = 0.005};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:o:", options)) != -1;) {
        if (option == 'c') option = CONFIG;
        if (option == 'o') option = OUT;
        if (option >= OUT && option < HELP && !(allowed >> (option - OUT) & 1))
            return 1 +
                   command_line_wrong("model", "--%s does not apply to %s", options[option - OUT].name, "this action");
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case JSON:
            o->json = true;
            break;
        case CONFIG:
            o->config = optarg;
            break;
        case SAG:
            if (!text_to_double(&o->sag_m, optarg) || o->sag_m < 1e-5 || o->sag_m > 0.1)
                return 1 + command_line_wrong("model", "--sag: '%s' is not a number in 1e-05 .. 0.1 m", optarg);
            break;
        case LENGTH:
        case WIDTH:
        case HEIGHT:
            if (!text_to_double(figure[option - LENGTH], optarg) || *figure[option - LENGTH] < 0.001 ||
                *figure[option - LENGTH] > 2000)
                return 1 + command_line_wrong("model", "--%s: '%s' is not a number in 0.001 .. 2000 m",
                                              options[option - OUT].name, optarg);
            break;
        case HELP:
            fputs(help, stdout);
            return 1 + 0;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    }
    if (optind < argc) o->name = argv[optind++];
    if (optind < argc) return 1 + command_line_wrong("model", "one model at a time, not also '%s'", argv[optind]);
    return 0;
}

static int list_command(int argc, char **argv)
{
    ModelOptions o;
    char         catalog[4096];
    const int    stop = parse(&o, 1u << (CONFIG - OUT), argc, argv);
    if (stop) return stop - 1;
    if (o.name) return command_line_wrong("model", "list takes no model, not '%s'", o.name);
    if (config_tables_of(o.config) != STATUS_OK || !etc_path(catalog, sizeof catalog, "catalog.csv")) return 1;
    return model_list(stdout, catalog) == STATUS_OK ? 0 : 1;
}

static int show_command(int argc, char **argv)
{
    ModelOptions o;
    char         out[256];
    const int    stop = parse(&o, 1u << (OUT - OUT) | 1u << (CONFIG - OUT) | 1u << (SAG - OUT), argc, argv);
    if (stop) return stop - 1;
    if (!o.name) return command_line_wrong("model", "show needs a model: a built-in name, or a file");
    if (o.out && strcasecmp(output_ending(o.out), ".png") != 0)
        return command_line_wrong("model", "%s: the picture's name ends with .png", o.out);
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* the model is shown whatever its entity types */
    const char *slash = strrchr(o.name, '/'), *last = slash ? slash + 1 : o.name;
    snprintf(out, sizeof out, "%.*s.png", (int)strcspn(last, "."), last);
    return show_model(o.name, o.sag_m, o.out ? o.out : out) == STATUS_OK ? 0 : 1;
}

static int info_command(int argc, char **argv)
{
    ModelOptions o;
    ModelInfo    info;
    const int    stop = parse(&o,
                              1u << (SAG - OUT) | 1u << (LENGTH - OUT) | 1u << (WIDTH - OUT) | 1u << (HEIGHT - OUT) |
                                  1u << (CONFIG - OUT) | 1u << (JSON - OUT),
                              argc, argv);
    if (stop) return stop - 1;
    if (!o.name) return command_line_wrong("model", "info needs a model: a built-in name, or a file");
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* that model, whatever its entity types */
    if (model_info_open(&info, o.name, &o.size, o.sag_m) != STATUS_OK) return 1;
    const bool put = !o.json || model_record_print(stdout, &info);
    if (!o.json) model_info_print(&info);
    if (!put) log_error("model: no memory: %s", o.name);
    model_info_close(&info);
    return put ? 0 : 1;
}

static int keys_command(int argc, char **argv)
{
    if (argc > 1) return command_line_wrong("model", "--keys takes no '%s'", argv[1]);
    sidecar_write_keys(stdout);
    return 0;
}

int model_command(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } actions[] = {{"info", info_command}, {"list", list_command}, {"show", show_command}, {"--keys", keys_command}};
    thread_flush_denormals();
    if (argc < 2) return command_line_wrong("model", "no action: list, info NAME|FILE, show NAME|FILE or --keys");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        fputs(help, stdout);
        return 0;
    }
    WordMeant meant = word_meant(argv[1]);
    for (size_t i = 0; i < sizeof actions / sizeof *actions; i++) {
        if (strcmp(argv[1], actions[i].name) != 0) {
            word_consider(&meant, actions[i].name);
            continue;
        }
        static char called[] = "pitviper model";
        argv[1] = called; /* the name that messages begin with */
        return actions[i].run(argc - 1, argv + 1);
    }
    return command_line_wrong("model", "no such action: %s%s", argv[1],
                              *word_hint(&meant) ? meant.hint
                                                 : "; there are list, info NAME|FILE, show NAME|FILE and --keys");
}
