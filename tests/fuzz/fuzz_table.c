/* tests/fuzz/fuzz_table.c: any octets as a table of CSV, as every table of etc/ itself whose columns it has, and as a
 * sensor's sheet.
 * Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "pitviper_channels.h"
#include "entities/catalog/catalog.h"
#include "entities/flight/flight.h"
#include "entities/scenery/scenery_clutter.h"
#include "entities/traces/effect_puffs.h"
#include "render/heat/construction.h"
#include "render/heat/given_heat.h"
#include "render/heat/vehicle_heat.h"
#include "render/heat/part_table.h"
#include "render/light/lamps.h"
#include "render/materials/materials.h"
#include "render/scattering/built/facade_table.h"
#include "render/scattering/built/thing_table.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/signatures/given_signature.h"
#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/paths/ground_bounce.h"
#include "sensor/detector/preset.h"
#include "sensor/publish/projector/drive_table.h"
#include "sensor/radar/radar_preset.h"

#include <stdlib.h>

const int fuzz_rounds = 1500;

/* A table of etc/, or a few rows in the way of the others. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const name[] = {"catalog.csv",
                                       "heat.csv",
                                       "constructions.csv",
                                       "construction_layers.csv",
                                       "effects.csv",
                                       "materials.csv",
                                       "surfaces.csv",
                                       "clutter.csv",
                                       "clutter_rear_area.csv",
                                       "missiles.csv",
                                       "sensors.csv",
                                       "sensors/example_flir2.sheet",
                                       "radars.csv",
                                       "radar/oxygen_lines.csv",
                                       "radar/water_lines.csv",
                                       "radar/clutter.csv",
                                       "radar/ground.csv",
                                       "radar/facades.csv",
                                       "radar/things.csv"};
    enum { names = sizeof name / sizeof *name };
    char path[1024];
    switch (index % (names + 9)) {
    case names + 8:
        return fuzz_seed_text(out, "radiance,level\n-1e3,0\n0,65535\n2.5,7\n");
    case names + 7:
        return fuzz_seed_text(out, "counts,level\n0,255\n100,12.5\n65535,0\n");
    case names + 6:
        return fuzz_seed_text(out, "wavelength_um,response\n3.6,0\n3.8,1\n4.7,1\n4.9,0\n");
    case names + 5:
        return fuzz_seed_text(out, "az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm\n0,0,35,1,2\n180,0,35,3,4\n300,0,35,-7,1e1\n");
    case names + 4:
        return fuzz_seed_text(out,
                              "az_deg,el_deg,f_ghz,hh_re_m,hh_im_m,vv_re_m,vv_im_m\n0,0,35,1,2,0,1\n0,5,35,1,0,0,-1\n");
    case names + 3:
        return fuzz_seed_text(out,
                              "x_m,y_m,z_m,hh_dbsm,vv_dbsm,az_deg,az_width_deg\n1,0,-1,10,5,0,90\n-1,0,-1,3,5,,\n");
    case names + 2:
        return fuzz_seed_text(out, "entity,model,unix_s,node_k\n1:1:7,tank,1782043200.5,290 300.5\n1:1:8,truck,5,1\n");
    case names + 1:
        return fuzz_seed_text(
            out, "entity,part,t_s,temp_k\n*,hull,0,290\ntank,hull,0,300\ntank,hull,60,310\n1:1:1,*,5,400\n");
    case names:
        return fuzz_seed_text(out, "type,model,origin\n1.1.*.2,unknown,base\n1,\"tank_t72\",centre\n*,unknown,base\n");
    default:
        break;
    }
    FILE *file = etc_path(path, sizeof path, name[index % (names + 9)]) ? fopen(path, "rb") : NULL;
    if (!file) return 0;
    const size_t size = fread(out, 1, fuzz_seed_octets, file);
    fclose(file);
    return size;
}

/* Every cell of the table is a string, and a number only within what was asked for. */
static void walk(const Table *table)
{
    if (table->columns < 1 || table->rows < 0) abort();
    for (int row = 0; row < table->rows; row++)
        for (int column = 0; column < table->columns; column++) {
            double      number, unix_s;
            long long   whole;
            const char *text = table_text(table, row, column);
            if (table_number(&number, table, row, column, -10, 10) == STATUS_OK && !(fabs(number) <= 10)) abort();
            if (text_to_double(&number, text) && !isfinite(number)) abort();
            (void)text_to_long(&whole, text);
            if (text_to_unix_s(&unix_s, text) && !(fabs(unix_s) <= 5e9)) abort();
            if (column > 0 && text == table_text(table, row, column - 1)) abort();
        }
}

/* Lines that were accepted give finite dispersion and attenuation at their own frequencies, too. */
static void lines_of(const char *path, bool oxygen)
{
    static GasLines lines;
    if (gas_lines_read(&lines, oxygen ? path : NULL, oxygen ? NULL : path) != STATUS_OK) return;
    const GasLineList *list = oxygen ? &lines.oxygen : &lines.water;
    if (!(list->count >= 1 && list->count <= gas_lines_max)) abort();
    for (int i = 0; i < list->count; i++)
        for (int corner = 0; corner < 8; corner++) {
            const GasState air = {corner & 1 ? 1200 : 0, corner & 2 ? 150 : 0, corner & 4 ? 350 : 150};
            GasAttenuation got;
            gas_attenuation(&got, &lines, fmax(1, fmin(1000, list->f_ghz[i])), &air);
            if (!isfinite(got.dry_db_km + got.wet_db_km + got.dry_ppm + got.wet_ppm)) abort();
        }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char materials_path[1024], surfaces_path[1024], constructions_path[1024], layers_path[1024];
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!*materials_path && !(etc_path(materials_path, sizeof materials_path, "materials.csv") &&
                              etc_path(surfaces_path, sizeof surfaces_path, "surfaces.csv") &&
                              etc_path(constructions_path, sizeof constructions_path, "constructions.csv") &&
                              etc_path(layers_path, sizeof layers_path, "construction_layers.csv")))
        abort();
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;

    (void)channels_check(path);
    (void)scenery_clutter_check(path);
    DriveTable levels;
    for (int most = 255; most <= 65535; most += 65280)
        if (drive_table_read(&levels, path, most) == STATUS_OK) {
            if (!(levels.rows >= 2 && levels.rows <= drive_rows_most)) abort();
            for (double value = -1e5; value < 1e5; value += 1.3e3)
                if (drive_level(&levels, value) > most) abort();
            if (drive_level(&levels, NAN) > most || (levels.counts && levels.of_count[65535] > most)) abort();
            drive_table_free(&levels);
        }
    Missile missile;
    int     missiles;
    if (missile_read_all(&missile, 1, &missiles, path) == STATUS_OK) {
        if (!(missiles >= 1 && missile.mass_kg > 0 && missile.lag_s > 0 && missile.area_m2 > 0)) abort();
        for (double age_s = -1; age_s < 2000; age_s += 0.7)
            if (!(missile_mass_kg(&missile, age_s) >= 0.09 * missile.mass_kg)) abort();
    }
    SpectralResponse *response;
    if (response_open(&response, path) == STATUS_OK) {
        if (!(response->nodes > 0 && response->nodes <= response_nodes_most)) abort();
        for (int i = 0; i < response->nodes; i++)
            if (!(response->node_m[i] >= 0.3e-6 && response->node_m[i] <= 30e-6 && response->weight_m[i] > 0)) abort();
        response_close(response);
    }
    SensorPreset sheet;
    if (preset_read_sheet(&sheet, path) == STATUS_OK) {
        /* what the detector's chain builds on */
        if (!(sheet.width_px >= 8 && sheet.width_px <= 8192 && sheet.height_px >= 8 && sheet.height_px <= 8192))
            abort();
        if (!(sheet.photons.read_e >= 0 && isfinite(sheet.photons.read_e) && sheet.photons.well_e >= 100)) abort();
        if (!(sheet.hfov_deg > 0 && sheet.hfov_deg < 180 && sheet.bits >= 8 && sheet.bits <= 16)) abort();
    }
    static Constructions constructions;
    if (constructions_open(&constructions, path, layers_path) == STATUS_OK ||
        constructions_open(&constructions, constructions_path, path) == STATUS_OK) {
        if (!(constructions.count >= 1 && constructions.count <= construction_most)) abort();
        if (constructions_find(&constructions, "wall", HEAT_DWELLING, "brick_red") >= constructions.count) abort();
        for (int k = 0; k < constructions.count; k++) {
            Column column;
            if (column_create(&column, constructions.row[k].layer, constructions.row[k].layers, wall_first_m,
                              wall_growth) != STATUS_OK)
                abort();
        }
    }
    Table table;
    if (table_open(&table, path) == STATUS_OK) {
        walk(&table);
        if (table_column(&table, "origin") >= 0) {
            Catalog *catalog;
            if (catalog_open(&catalog, path, 0.1) == STATUS_OK) {
                for (int kind = 0; kind < 4; kind++) {
                    const int model = catalog_find(catalog, (DisEntityType){.kind = (uint8_t)kind}, NULL, NULL);
                    if (model < 0 || model >= catalog_model_count(catalog)) abort();
                }
                catalog_close(catalog);
            }
        }
        PartTable    parts;
        EffectTable  effects;
        SensorPreset preset;
        Materials    materials;
        GivenHeat   *given;
        KeptHeat    *kept;
        if (table_column(&table, "node_k") >= 0 && heat_kept_open(&kept, path) == STATUS_OK) {
            const KeptNodes *nodes = heat_kept_find(kept, (DisEntityId){1, 1, 7}, "tank", 2);
            if (nodes && !(nodes->temp_k[1] >= 0.5 && nodes->temp_k[1] <= 1e4)) abort();
            heat_kept_close(kept);
        }
        if (table_column(&table, "temp_k") >= 0 && given_heat_open(&given, path) == STATUS_OK) {
            static ModelPart part = {.name = "hull", .role = HEAT_HULL};
            const Model      model = {.name = "tank", .part = &part, .part_count = 1};
            int              rank;
            const int        index = given_heat_find(&rank, given, (DisEntityId){1, 1, 1}, &model, 0);
            for (double t_s = -1e10; index >= 0 && t_s < 1e10; t_s += 1e9)
                if (!(given_heat_k(given, index, t_s) >= 1 && given_heat_k(given, index, t_s) <= 4000)) abort();
            given_heat_close(given);
        }
        GivenSignature *signature;
        if ((table_column(&table, "f_ghz") >= 0 || table_column(&table, "x_m") >= 0) &&
            given_signature_open(&signature, path) == STATUS_OK) {
            Centres centres = {0};
            for (int look = 0; look < 40; look++) {
                ScatterAntenna antenna;
                ScatterMatrix  s;
                radar_look(&antenna, look * 0.7, 0.1 * (look % 31 - 15), look % 2 ? INFINITY : 2000);
                given_signature_field(&s, signature, &antenna, 3.5e10);
                if (!isfinite(creal(s.hh) + cimag(s.hh) + creal(s.hv) + creal(s.vh) + creal(s.vv) + cimag(s.vv)))
                    abort();
                if (given_signature_centres(&centres, signature, &antenna, 3.5e10) != STATUS_OK || centres.count < 0)
                    abort();
            }
            centres_free(&centres);
            given_signature_close(signature);
        }
        if (table_column(&table, "line_ghz") >= 0) lines_of(path, table_column(&table, "coupling") >= 0);
        if (table_column(&table, "inside") >= 0) (void)part_table_roles(&parts, path);
        if (table_column(&table, "engine_kw") >= 0) (void)part_table_machines(&parts, path);
        if (table_column(&table, "life_s") >= 0) (void)effect_table_open(&effects, path);
        if (table_column(&table, "hfov_deg") >= 0 && preset_read(&preset, path, "staring_lwir") == STATUS_OK)
            preset_refresh(&preset);
        if (table_column(&table, "metal") >= 0 && materials_open(&materials, path, surfaces_path, NULL) == STATUS_OK)
            materials_close(&materials);
        if (table_column(&table, "surface") >= 0 && materials_open(&materials, materials_path, path, NULL) == STATUS_OK)
            materials_close(&materials);
        if (table_column(&table, "pulse_us") >= 0) (void)radar_preset_check(path);
        static LampTypes lamps;
        if (table_column(&table, "flux_lm") >= 0 && lamp_types_read(&lamps, path) == STATUS_OK)
            for (int k = 0; k < lamps.count; k++)
                if (!(lamps.type[k].share <= 1 && lamps.type[k].w_lm[optical_channel_pan] <= 3)) abort();
        static ClutterTable clutter;
        if (table_column(&table, "texture_m") >= 0 && clutter_table_open(&clutter, path) == STATUS_OK)
            for (int surface = 0; surface < SURFACE_COUNT; surface++)
                for (int band = 0; band < CLUTTER_BAND_COUNT; band++) {
                    const ClutterRow *row = &clutter.row[surface][band];
                    if (!(clutter_sigma0(row, 0.1, 0.003) >= 0 && clutter_foliage_db(row, 9) >= 0)) abort();
                    if (!(clutter_texture(row, -8) >= 0 && clutter_texture(row, 8) < 1e4)) abort();
                }
        static GroundTable ground;
        if (table_column(&table, "heights") >= 0 && ground_table_open(&ground, path) == STATUS_OK)
            for (int surface = 0; surface < SURFACE_COUNT; surface++) {
                const GroundSurface of = ground_surface(&ground.row[surface], 35e9);
                double complex      te, tm;
                ground_reflection(&te, &tm, &of, 700, 0.2);
                if (!(cabs(te) <= 1 + 1e-9 && cabs(tm) <= 1 + 1e-9)) abort();
            }
        static FacadeTable facades;
        const RadarSurface wall = {.kind = RADAR_HALF_SPACE, .eps = 4, .rough_m = 1e-3};
        if (table_column(&table, "uneven_m") >= 0 && facade_table_open(&facades, path) == STATUS_OK)
            for (int i = 0; i < facades.count; i++) {
                const double sigma0 = facade_sigma0(&facades.row[i], CLUTTER_KA, &wall, 700, 0.7);
                if (!(sigma0 >= 0 && sigma0 <= 4) || !isfinite(facade_height(&facades.row[i], 1, 9.5, -7))) abort();
            }
        static ThingTable things;
        if (table_column(&table, "dbsm_180") >= 0 && thing_table_open(&things, path) == STATUS_OK)
            for (int i = 0; i < things.count; i++)
                if (!(thing_rcs_m2(&things.row[i], CLUTTER_W, (const double[3]){-1, 0, 0}) > 0)) abort();
        table_close(&table);
    }
    close(file);
    return 0;
}
