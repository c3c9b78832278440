/* Every column of numbers of the tables that users may write against tests/data/columns.csv: its bounds are tried in a
 * copy of the table, they are taken, what lies beyond is refused with a line that names the column and its range. */
#include "tests/check.h"

#include "entities/catalog/catalog.h"
#include "entities/flight/missile.h"
#include "entities/scenery/scenery_clutter.h"
#include "entities/traces/effect_puffs.h"
#include "pitviper_table.h"
#include "render/heat/construction.h"
#include "render/heat/given_heat.h"
#include "render/heat/ground_column_private.h"
#include "render/heat/part_table.h"
#include "render/light/lamps.h"
#include "render/materials/materials.h"
#include "render/scattering/built/facade_table.h"
#include "render/scattering/built/thing_table.h"
#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/ground_bounce.h"
#include "render/scattering/radar_surfaces.h"
#include "render/scattering/signatures/given_signature.h"
#include "terrain/from_files/culture_import_private.h"
#include "sensor/detector/preset.h"
#include "sensor/publish/projector/drive_table.h"
#include "sensor/quality/quality.h"
#include "sensor/radar/radar_preset.h"
#include "terrain/detail/detail.h"
#include "terrain/surface.h"
#include "terrain/weather/weather_private.h"
#include "terrain/woods/woods.h"

static Materials optical; /* of etc/, for tables that name its rows */

/* Readers of the program, of one file each; what they read is dropped. */
static Status read_materials(const char *path)
{
    char surfaces[4096];
    CHECK(etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    Materials    m;
    const Status status = materials_open(&m, path, surfaces, NULL);
    if (status == STATUS_OK) materials_close(&m);
    return status;
}
static Status read_roles(const char *path)
{
    static PartTable t;
    return part_table_roles(&t, path);
}
static Status read_machines(const char *path)
{
    static PartTable t;
    return part_table_machines(&t, path);
}
static Status read_ground_heat(const char *path)
{
    static GroundKinds k;
    return ground_kinds_open(&k, path, &optical);
}
static Status read_constructions(const char *path)
{
    static Constructions c;
    char                 layers[4096];
    CHECK(etc_path(layers, sizeof layers, "construction_layers.csv"));
    return constructions_open(&c, path, layers);
}
static Status read_layers(const char *path)
{
    static Constructions c;
    char                 constructions[4096];
    CHECK(etc_path(constructions, sizeof constructions, "constructions.csv"));
    return constructions_open(&c, constructions, path);
}
static Status read_missiles(const char *path)
{
    Missile m;
    int     count;
    return missile_read_all(&m, 1, &count, path);
}
static Status read_effects(const char *path)
{
    static EffectTable t;
    return effect_table_open(&t, path);
}
static Status read_lamps(const char *path)
{
    static LampTypes t;
    return lamp_types_read(&t, path);
}
static Status read_clutter(const char *path)
{
    static ClutterTable t;
    return clutter_table_open(&t, path);
}
static Status read_facades(const char *path)
{
    static FacadeTable t;
    return facade_table_open(&t, path);
}
static Status read_things(const char *path)
{
    static ThingTable t;
    return thing_table_open(&t, path);
}
static Status read_oxygen(const char *path)
{
    static GasLines g;
    return gas_lines_read(&g, path, NULL);
}
static Status read_water(const char *path)
{
    static GasLines g;
    return gas_lines_read(&g, NULL, path);
}
static Status read_ground(const char *path)
{
    static GroundTable t;
    return ground_table_open(&t, path);
}
static Status read_radar_materials(const char *path)
{
    static RadarMaterials m;
    const Status          status = radar_materials_open(&m, path, &optical);
    if (status == STATUS_OK) radar_materials_close(&m);
    return status;
}
static Status read_quality(const char *path)
{
    static QualityTable t;
    return quality_open(&t, path);
}
static Status read_sensor(const char *path)
{
    static SensorPreset p;
    return preset_read(&p, path, "staring_lwir");
}
static Status read_radar(const char *path)
{
    static RadarPreset p;
    return radar_preset_read(&p, path, "seeker_94");
}
static Status read_detail(const char *path)
{
    DetailTable *t = NULL;
    const Status status = detail_table_open(&t, path, 1);
    detail_table_close(t);
    return status;
}
static Status read_woods(const char *path)
{
    static WoodsTable t;
    return woods_table_read(&t, path);
}
static Status read_catalog(const char *path)
{
    Catalog     *c = NULL;
    const Status status = catalog_open(&c, path, 0.1);
    if (status == STATUS_OK) catalog_close(c);
    return status;
}
static Status read_drive(const char *path)
{
    DriveTable   t;
    const Status status = drive_table_read(&t, path, 65535);
    if (status == STATUS_OK) drive_table_free(&t);
    return status;
}
static Status read_given_heat(const char *path)
{
    GivenHeat   *g = NULL;
    const Status status = given_heat_open(&g, path);
    given_heat_close(g);
    return status;
}
static Status read_kept_heat(const char *path)
{
    KeptHeat    *k = NULL;
    const Status status = heat_kept_open(&k, path);
    heat_kept_close(k);
    return status;
}
static Status read_signature(const char *path)
{
    GivenSignature *g = NULL;
    const Status    status = given_signature_open(&g, path);
    given_signature_close(g);
    return status;
}
static Status read_culture_tags(const char *path)
{
    CultureRules r = {0};
    const Status status = culture_rules_open(&r, path);
    culture_rules_close(&r);
    return status;
}
static Status read_trees(const char *path)
{
    const LocalFrame frame = {0};
    Culture          c = {0};
    CultureReport    r = {0};
    const Status     status =
        culture_trees_read(&c, &r, &(CultureFiles){.trees = path, .frame = &frame, .half_m = culture_farthest_m});
    culture_free(&c);
    return status;
}
static Status read_weather(const char *path)
{
    WeatherRows  rows = {0};
    const Status status = weather_file_read(&rows, path);
    if (status == STATUS_OK) weather_rows_close(&rows);
    return status;
}

/* text: of a table that etc/ does not have; `@` stands where the column and its value go. */
static const struct Reader {
    const char *table;
    Status (*read)(const char *path);
    const char *text;
} readers[] = {
    {"materials.csv", read_materials, NULL},
    {"heat.csv", read_roles, NULL},
    {"heat_machines.csv", read_machines, NULL},
    {"ground_heat.csv", read_ground_heat, NULL},
    {"constructions.csv", read_constructions, NULL},
    {"construction_layers.csv", read_layers, NULL},
    {"ground_detail.csv", read_detail, NULL},
    {"effects.csv", read_effects, NULL},
    {"missiles.csv", read_missiles, NULL},
    {"lamps.csv", read_lamps, NULL},
    {"quality.csv", read_quality, NULL},
    {"sensors.csv", read_sensor, NULL},
    {"radars.csv", read_radar, NULL},
    {"woods.csv", read_woods, NULL},
    {"clutter.csv", scenery_clutter_check, NULL},
    {"clutter_rear_area.csv", scenery_clutter_check, NULL},
    {"cover_nlcd.csv", surface_table_check, NULL},
    {"catalog.csv", read_catalog, NULL},
    {"radar/clutter.csv", read_clutter, NULL},
    {"radar/ground.csv", read_ground, NULL},
    {"radar/facades.csv", read_facades, NULL},
    {"radar/things.csv", read_things, NULL},
    {"radar/materials.csv", read_radar_materials, NULL},
    {"radar/oxygen_lines.csv", read_oxygen, NULL},
    {"radar/water_lines.csv", read_water, NULL},
    {"tags_height", read_culture_tags, "@,key,value,makes,kind,width_m,surface\n@,a,*,building,,,\n"},
    {"tags_width", read_culture_tags, "@,key,value,makes,kind,height_m,surface\n@,a,*,building,,,\n"},
    {"trees", read_trees, "@,lat,lon,height_m\n@,47,13,5\n"},
    {"trees_enu", read_trees, "@,x_m,y_m,height_m\n@,1,2,5\n"},
    {"weather", read_weather, "@,unix_s,air_temp_k\n@,0,280\n"},
    {"weather_air", read_weather, "@,unix_s\n@,0\n"},
    {"drive_levels", read_drive, "@,counts\n@,0\n0,1\n"},
    {"given_heat", read_given_heat, "@,entity,part,t_s,temp_k\n@,*,*,0,300\n"},
    {"signature", read_signature, "@,x_m,y_m,z_m,hh_dbsm,vv_dbsm\n@,0,0,0,0,0\n"},
    {"signature_look", read_signature, "@,az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm\n@,0,0,10,0,0\n"},
    {"signature_field", read_signature, "@,az_deg,el_deg,f_ghz,hh_re_m,hh_im_m,vv_re_m,vv_im_m\n@,0,0,10,1,0,1,0\n"},
    {"kept_heat", read_kept_heat, "@,entity,model,unix_s,node_k\n@,1:2:3,tank,0,300\n"},
};
enum { reader_count = sizeof readers / sizeof *readers };

static int faults;
#define FAULT(...)                                                                                                     \
    do {                                                                                                               \
        print_error(__VA_ARGS__);                                                                                      \
        faults++;                                                                                                      \
    } while (0)

/* ---- a table with one cell changed --------------------------------------------------------------------- */

static bool is_number(const char *text)
{
    double number;
    return text_to_double(&number, text);
}

/* The first row where the column has a number; none: the first of all. */
static int first_number(const Table *t, int column)
{
    int row = 0;
    while (row < t->rows && !is_number(table_text(t, row, column))) row++;
    return row < t->rows ? row : 0;
}

static void write_copy(FILE *to, const Table *t, int row, int column, const char *value)
{
    for (int r = -1; r < t->rows; r++)
        for (int c = 0; c < t->columns; c++) {
            const char *text = r == row && c == column ? value : table_text(t, r, c);
            fputc('"', to);
            for (; *text; text++) fputs(*text == '"' ? "\"\"" : (const char[]){*text, 0}, to);
            fputs(c + 1 < t->columns ? "\"," : "\"\n", to);
        }
}

static void write_text(FILE *to, const char *text, const char *column, const char *value)
{
    int put = 0;
    for (; *text; text++)
        if (*text == '@') fputs(put++ ? value : column, to);
        else fputc(*text, to);
}

/* ---- one bound ------------------------------------------------------------------------------------------- */

typedef struct Trial {
    const struct Reader *reader;
    const Table         *table; /* NULL: the reader's text */
    const char          *name;
    int                  row, at;
    char                 range[96];
} Trial;

/* Tries a value. Whether columns fit one another is not asked: refused is what names this column and says its range. */
static void expect(const Trial *c, const char *value, bool taken)
{
    char   path[text_file_size], names[96], *text = NULL;
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    CHECK(to != NULL);
    if (c->table) write_copy(to, c->table, c->row, c->at, value);
    else write_text(to, c->reader->text, c->name, value);
    CHECK(fclose(to) == 0);
    text_file(path, text);
    free(text);
    check_said[0] = 0;
    const Status status = c->reader->read(path);
    remove(path);
    snprintf(names, sizeof names, "column %s: ", c->name);
    const bool refused = status != STATUS_OK && strstr(check_said, names) && strstr(check_said, c->range);
    if (refused == taken || (!taken && status == STATUS_OK))
        FAULT("%s: %s: %s is %s; said: %s\n", c->reader->table, c->name, value,
              taken ? "refused" : "taken, or refused without its range", check_said);
}

static void try_bounds(Trial *c, const char *kind, const char *least, const char *most)
{
    const bool whole = strcmp(kind, "whole") == 0;
    double     low, high;
    char       value[64];
    CHECK(text_to_double(&low, least) && text_to_double(&high, most) && low < high);
    snprintf(c->range, sizeof c->range, "number in %g .. %g", low, high);
    expect(c, least, true);
    expect(c, most, true);
    snprintf(value, sizeof value, "%.17g", whole ? low - 1 : nextafter(low, -INFINITY));
    expect(c, value, false);
    snprintf(value, sizeof value, "%.17g", whole ? high + 1 : nextafter(high, INFINITY));
    expect(c, value, false);
    expect(c, "nan", false);
    if (!whole) return;
    snprintf(value, sizeof value, "%.17g", low + 0.5);
    expect(c, value, false);
}

/* Every column of a table of etc/ that holds numbers is in the list; those of the further channel swir are read in runs
 * with it alone. */
static void check_listed(const struct Reader *reader, const Table *t, const Table *list, const int at[2])
{
    for (int c = 0; c < t->columns; c++) {
        const char *name = table_text(t, -1, c);
        int         line = 0;
        if (strstr(name, "_swir") || t->rows == 0 || !is_number(table_text(t, first_number(t, c), c))) continue;
        while (line < list->rows && (strcmp(table_text(list, line, at[0]), reader->table) != 0 ||
                                     strcmp(table_text(list, line, at[1]), name) != 0))
            line++;
        if (line == list->rows)
            FAULT(
                "%s: column %s is not in tests/data/columns.csv; add its row there, with what physics says of its bounds\n",
                reader->table, name);
    }
}

static void every_column_is_as_the_list_has_it(void **state)
{
    (void)state;
    static const char *const names[] = {"table", "column", "kind", "least", "most"};
    Table                    list, table;
    char                     path[4096], surfaces[4096];
    int                      at[5], seen = 0;
    CHECK(etc_path(path, sizeof path, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    assert_int_equal(materials_open(&optical, path, surfaces, NULL), STATUS_OK);
    assert_int_equal(table_open(&list, "tests/data/columns.csv"), STATUS_OK);
    CHECK(table_columns(at, &list, names, 5, "test"));
    log_set_sink(check_listen, NULL);
    for (int k = 0; k < reader_count; k++) {
        const struct Reader *reader = &readers[k];
        if (!reader->text) {
            CHECK(etc_path(path, sizeof path, reader->table));
            assert_int_equal(table_open(&table, path), STATUS_OK);
            check_listed(reader, &table, &list, at);
        }
        for (int line = 0; line < list.rows; line++) {
            if (strcmp(table_text(&list, line, at[0]), reader->table) != 0) continue;
            Trial c = {.reader = reader, .name = table_text(&list, line, at[1]), .table = reader->text ? NULL : &table};
            if (c.table && (c.at = table_column(&table, c.name)) < 0) {
                FAULT("%s: there is no column %s\n", reader->table, c.name);
                continue;
            }
            if (c.table) c.row = first_number(&table, c.at);
            seen++;
            try_bounds(&c, table_text(&list, line, at[2]), table_text(&list, line, at[3]),
                       table_text(&list, line, at[4]));
        }
        if (!reader->text) table_close(&table);
    }
    log_set_sink(NULL, NULL);
    if (seen != list.rows) FAULT("%d rows of tests/data/columns.csv are of no column\n", list.rows - seen);
    table_close(&list);
    materials_close(&optical);
    assert_int_equal(faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_column_is_as_the_list_has_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
