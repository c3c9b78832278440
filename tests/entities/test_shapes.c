/* Shapes and sizes of the types that exercises send: what each is seen as, against published figures that stand here
 * and nowhere in the catalog's making; that every shape is closed, outward, standing, articulated, warm and not too
 * heavy in any size; and that what has no shape is not there. labels: physics */
#include "tests/entities/model_fixture.h"

#include "entities/motion/articulation.h"
#include "entities/catalog/catalog.h"

/* ---- the common types -------------------------------------------------------------------------- */

enum { tight = 5, loose = 10 }; /* per cent; loose where books differ by variant, load or what sticks out */

typedef struct Published {
    DisEntityType type;
    const char   *shape;                       /* the silhouette a viewer expects; NULL: nothing to be seen */
    double        length_m, width_m, height_m; /* 0: nothing published, or nothing that all books agree on */
    int           percent;
    const char   *what; /* and where the figures are from */
} Published;

/* The 79 lines of a list of types as exercises send them, with a viewer's expectation. Where the 2006 edition of
 * SISO-REF-010 (open-dis/dis-enumerations, data/siso-std-010.xml) gives a number to another thing than the list, the
 * edition counts: 1.1.225.4.2 is the M110, 4.3 the M109, 5.1 the M114, 7.10 a tow vehicle, 1.2.225.3.1 the B-1B, 21.1
 * the UH-1. */
static const Published published[] = {
    {{1, 1, 225, 1, 1, 3, 0},
     "tank",
     9.83,
     3.66,
     2.89,
     tight,
     "M1A2: TM 9-2350-255 (9.83 gun forward; 2.89 over the gun)"},
    {{1, 1, 222, 1, 2, 2, 0}, "tank", 9.53, 3.59, 0, tight, "T-72M: Zaloga, T-72 1974-93"},
    {{1, 1, 222, 1, 1, 1, 0}, "tank", 9.66, 3.59, 0, tight, "T-80: JAA"},
    {{1, 1, 78, 1, 1, 3, 0}, "tank", 9.67, 3.70, 2.79, loose, "Leopard 2: JAA (Leopard 1 has 9.54 x 3.37 x 2.76)"},
    {{1, 1, 225, 2, 1, 2, 0}, "carrier", 6.55, 3.28, 2.97, tight, "M2 Bradley: TM 9-2350-284 (without side armour)"},
    {{1, 1, 222, 2, 2, 1, 0}, "carrier", 6.735, 3.15, 2.45, tight, "BMP-2: JAA"},
    {{1, 1, 222, 2, 13, 1, 0}, "carrier_wheeled", 7.65, 2.90, 2.41, tight, "BTR-80: JAA (2.35 .. 2.46 high)"},
    {{1, 1, 225, 2, 5, 19, 0}, "carrier_wheeled", 6.95, 2.72, 2.64, tight, "Stryker: US Army fact sheet"},
    {{1, 1, 225, 2, 3, 1, 0}, "carrier", 4.863, 2.686, 2.52, tight, "M113A2: TM 9-2350-261"},
    {{1, 1, 225, 3, 11, 0, 0}, "carrier", 4.86, 2.69, 2.68, loose, "M577: JAA"},
    {{1, 1, 225, 4, 3, 7, 0}, "howitzer", 9.68, 3.15, 3.24, tight, "M109A6: US Army fact sheet"},
    {{1, 1, 222, 4, 2, 0, 0}, "howitzer", 7.26, 2.85, 2.73, tight, "2S1: JAA"},
    {{1, 1, 225, 4, 1, 0, 0}, "rocket_launcher", 6.97, 2.97, 2.59, tight, "M270: JAA"},
    {{1, 1, 225, 5, 2, 0, 0}, "gun", 11.0, 2.80, 2.90, tight, "M198 in action: FM 6-50"},
    {{1, 1, 225, 5, 1, 0, 0}, "gun", 7.32, 2.44, 1.80, tight, "M114: JAA"},
    {{1, 1, 225, 6, 1, 0, 0}, "jeep", 4.57, 2.16, 1.83, tight, "HMMWV: TM 9-2320-280"},
    {{1, 1, 222, 6, 1, 0, 0}, "jeep", 3.85, 1.75, 2.03, tight, "GAZ-69: JMV"},
    {{1, 1, 225, 7, 1, 0, 0}, "truck", 6.71, 2.44, 2.84, tight, "M35A2: TM 9-2320-209"},
    {{1, 1, 225, 7, 19, 0, 0}, "truck_heavy", 10.17, 2.44, 2.57, tight, "HEMTT: TM 9-2320-279"},
    {{1, 1, 225, 9, 1, 0, 0}, "carrier_cargo", 5.89, 2.69, 2.82, tight, "M548: JMV"},
    {{1, 1, 225, 8, 1, 0, 0}, "carrier_cargo", 0, 0, 0, tight, "small tracked utility vehicle"},
    {{1, 1, 225, 10, 9, 0, 0}, "mortar", 0, 0, 0, tight, "M120 (its tube is checked below)"},
    {{1, 1, 225, 14, 1, 0, 0}, "trailer", 5.36, 2.43, 2.29, tight, "M1082: JMV"},
    {{1, 1, 225, 18, 1, 0, 0}, "bulldozer", 5.15, 3.80, 3.30, loose, "D7G with straight blade: Caterpillar"},
    {{1, 1, 225, 24, 1, 0, 0}, "locomotive", 22.3, 3.12, 4.70, tight, "ES44AC: GE"},
    {{1, 1, 225, 25, 1, 0, 0},
     "railcar",
     16.9,
     3.20,
     4.60,
     tight,
     "50-foot box car: AAR plate C (17.0 x 3.25 x 4.72 at most)"},
    {{1, 1, 225, 28, 1, 0, 0}, "launcher", 7.389, 3.18, 3.45, tight, "2P25: Jane's Land-Based Air Defence"},
    {{1, 1, 222, 28, 8, 0, 0}, "launcher", 0, 0, 0, tight, "air defence"},
    {{1, 1, 225, 29, 1, 0, 0}, "shelter", 0, 0, 0, tight, "C3I system"},
    {{1, 1, 225, 32, 1, 0, 0}, "radar", 0, 0, 0, tight, "surveillance facility"},
    {{1, 1, 225, 39, 1, 0, 0}, "tent", 9.75, 4.88, 3.05, tight, "GP medium: TM 10-8340 (32 x 16 x 10 ft)"},
    {{1, 1, 225, 50, 1, 0, 0}, "robot", 0.864, 0.572, 0.43, tight, "TALON: Foster-Miller"},
    {{1, 1, 225, 80, 1, 0, 0}, "motorcycle", 2.20, 0.94, 1.35, tight, "KLR 650: Kawasaki"},
    {{1, 1, 225, 81, 1, 0, 0}, "car", 4.64, 1.776, 1.455, tight, "Corolla E170: Toyota"},
    {{1, 1, 225, 82, 1, 0, 0}, "bus", 11.95, 2.55, 3.12, tight, "Citaro: Mercedes"},
    {{1, 1, 225, 83, 1, 0, 0}, "truck", 7.366, 2.50, 2.87, tight, "Ural-4320: JMV"},
    {{1, 1, 225, 85, 1, 0, 0}, "semi_trailer", 16.5, 2.55, 4.0, tight, "Directive 96/53/EC"},
    {{1, 1, 225, 86, 1, 0, 0}, "semi_trailer", 16.5, 2.55, 4.0, tight, "Directive 96/53/EC"},
    {{1, 1, 225, 87, 1, 0, 0}, "bulldozer", 0, 0, 0, tight, "construction specialty vehicle"},
    {{1, 2, 225, 1, 3, 3, 0}, "aircraft", 15.06, 9.45, 5.09, tight, "F-16C: USAF fact sheet"},
    {{1, 2, 225, 1, 5, 3, 0}, "aircraft", 19.43, 13.05, 5.63, tight, "F-15C: USAF fact sheet"},
    {{1, 2, 225, 2, 4, 0, 0}, "attack_plane", 16.26, 17.53, 4.47, tight, "A-10: USAF fact sheet"},
    {{1, 2, 225, 3, 3, 0, 0}, "bomber", 48.5, 56.4, 12.4, tight, "B-52H: USAF fact sheet"},
    {{1, 2, 225, 3, 1, 0, 0}, "bomber", 44.5, 41.8, 10.4, tight, "B-1B, wings forward: USAF fact sheet"},
    {{1, 2, 225, 4, 1, 0, 0}, "cargo_plane", 29.79, 40.41, 11.66, tight, "C-130H: USAF fact sheet"},
    {{1, 2, 225, 4, 9, 0, 0}, "cargo_jet", 53.04, 51.75, 16.79, tight, "C-17: USAF fact sheet"},
    {{1, 2, 225, 4, 10, 0, 0}, "airliner_4", 70.66, 64.44, 19.41, tight, "747-400: Boeing D6-58326-1"},
    {{1, 2, 225, 5, 1, 0, 0}, "patrol_plane", 35.61, 30.38, 10.27, tight, "P-3C: US Navy fact file"},
    {{1, 2, 225, 6, 9, 2, 0}, "aircraft", 18.24, 16.15, 4.95, tight, "EA-6B: US Navy fact file"},
    {{1, 2, 225, 20, 1, 0, 0},
     "helicopter",
     17.73,
     5.23,
     3.87,
     tight,
     "AH-64A: JAW (rotors turning; over the stub wings)"},
    {{1, 2, 225, 20, 2, 0, 0},
     "helicopter",
     15.2,
     0,
     4.11,
     loose,
     "AH-1G: TM 55-1520-236 (16.14 with the tail rotor's disc)"},
    {{1, 2, 225, 21, 2, 0, 0}, "helicopter_utility", 19.76, 16.36, 5.13, tight, "UH-60A: TM 1-1520-237"},
    {{1, 2, 225, 21, 1, 0, 0},
     "helicopter_light",
     17.40,
     0,
     4.41,
     tight,
     "UH-1H: TM 55-1520-210 (17.40 rotors turning)"},
    {{1, 2, 225, 23, 1, 0, 0}, "helicopter_tandem", 30.1, 0, 5.7, tight, "CH-47D: US Army fact sheet"},
    {{1, 2, 225, 24, 2, 0, 0}, "helicopter_light", 12.58, 10.67, 3.93, tight, "OH-58D: JAW"},
    {{1, 2, 225, 50, 4, 0, 0}, "uav", 8.22, 14.8, 2.1, tight, "MQ-1: USAF fact sheet"},
    {{1, 2, 225, 50, 4, 4, 0}, "uav", 11.0, 20.1, 3.8, tight, "MQ-9: USAF fact sheet"},
    {{1, 2, 225, 50, 10, 0, 0}, "quadcopter", 0, 0, 0, tight, "quadcopter"},
    {{1, 2, 225, 101, 1, 0, 0}, "airship", 58.5, 15.2, 18.1, tight, "GZ-20: Goodyear"},
    {{1, 2, 225, 85, 11, 0, 0}, "light_plane", 8.28, 11.0, 2.72, tight, "Cessna 172: type certificate 3A12"},
    {{1, 2, 225, 84, 1, 0, 0}, "light_plane", 0, 0, 0, tight, "light sport"},
    {{1, 2, 225, 86, 1, 0, 0}, "airliner", 20.86, 19.61, 6.30, tight, "Challenger 600: Bombardier"},
    {{1, 2, 225, 87, 1, 0, 0}, "airliner", 39.47, 35.79, 12.55, tight, "737-800: Boeing D6-58325-6"},
    {{1, 3, 225, 1, 1, 0, 0}, "aircraft_carrier", 332.8, 76.8, 74, tight, "Nimitz: US Navy (244 ft from keel to mast)"},
    {{1, 3, 225, 4, 1, 0, 0}, "ship", 155.3, 20.1, 0, tight, "Arleigh Burke: JFS"},
    {{1, 3, 225, 6, 1, 0, 0}, "ship", 136.0, 13.7, 0, tight, "Oliver Hazard Perry: JFS"},
    {{1, 3, 225, 7, 1, 0, 0}, "boat", 54.6, 7.6, 0, tight, "Cyclone: JFS"},
    {{1, 3, 225, 61, 1, 0, 0}, "boat", 0, 0, 0, tight, "non-combatant ship"},
    {{1, 3, 225, 84, 1, 0, 0}, "rhib", 10.95, 3.20, 0, tight, "11 m RIB: USMI"},
    {{1, 3, 225, 81, 1, 0, 0},
     "cargo_ship",
     294,
     32.2,
     57.9,
     tight,
     "Panamax: Panama Canal Authority (294.1 x 32.3; air draught 57.9)"},
    {{1, 4, 225, 3, 1, 0, 0}, "submarine", 110.3, 10.1, 0, tight, "Los Angeles: JFS"},
    {{1, 4, 225, 2, 1, 0, 0}, "submarine", 170.7, 12.8, 0, tight, "Ohio: JFS"},
    {{1, 5, 225, 1, 1, 0, 0}, "satellite", 0, 0, 0, tight, "satellite"},
    {{2, 2, 225, 1, 2, 0, 0}, "missile", 1.17, 0, 0, tight, "BGM-71A: FM 3-22.34"},
    {{2, 1, 225, 1, 1, 0, 0}, "missile_air", 2.87, 0.447, 0.447, tight, "AIM-9: DS (span 0.63, as an X)"},
    {{2, 2, 225, 2, 14, 0, 0}, "shell", 0.98, 0, 0, tight, "M830: TM 43-0001-28"},
    {{2, 8, 225, 2, 1, 0, 0}, "shell", 0.057, 0, 0, tight, "5.56 mm cartridge: 57.4 mm, MIL-C-9963"},
    {{2, 9, 225, 1, 14, 0, 0}, "bomb_guided", 3.27, 0, 0, tight, "GBU-12: USAF fact sheet"},
    {{2, 11, 225, 2, 1, 0, 0}, "bomb", 2.21, 0.273, 0.273, tight, "Mk 82: DS"},
    {{2, 7, 225, 1, 2, 0, 0}, "torpedo", 5.79, 0.533, 0.533, tight, "Mk 48: US Navy fact file"},
    {{2, 7, 225, 1, 1, 0, 0}, "torpedo", 2.59, 0.324, 0.324, tight, "Mk 46: US Navy fact file"},
    {{2, 6, 225, 1, 14, 1, 0}, "torpedo", 5.79, 0.533, 0.533, tight, "Mk 48 of domain antiship"},
    {{2, 9, 225, 2, 73, 2, 0}, "bomb", 2.21, 0.273, 0.273, tight, "Mk 82: DS"},
    {{2, 9, 225, 2, 75, 2, 0}, "bomb", 3.28, 0.457, 0.457, tight, "Mk 84: DS"},
    {{2, 9, 225, 1, 19, 1, 0}, "missile_cruise", 5.56, 0, 0, tight, "BGM-109C: DS (without its booster)"},
    {{2, 1, 225, 1, 16, 1, 0}, "missile_air", 5.31, 0, 0, tight, "MIM-104: DS"},
    {{2, 1, 225, 1, 15, 1, 0}, "missile_air", 1.52, 0, 0, tight, "FIM-92: DS"},
    {{2, 2, 225, 1, 3, 5, 0}, "missile", 1.63, 0, 0, tight, "AGM-114K: DS"},
    {{2, 2, 225, 2, 1, 1, 0}, "shell", 0.0587, 0.013, 0.013, tight, "12.7 mm M2 bullet: 2.31 in, TM 43-0001-27"},
    {{1, 3, 0, 61, 1, 0, 0}, "cargo_ship", 294, 32.2, 0, tight, "a container ship of no navy"},
    {{1, 3, 125, 61, 2, 3, 0}, "tanker", 0, 0, 0, tight, "a tanker of no navy"},
    {{2, 8, 225, 3, 1, 0, 0}, "mine", 0.337, 0.337, 0.124, tight, "M15: TM 43-0001-36"},
    {{2, 10, 222, 1, 1, 0, 0}, "missile_ballistic", 11.25, 1.81, 1.81, tight, "R-17: DS"},
    {{3, 1, 225, 1, 1, 0, 0}, "person", 0, 0, 1.80, tight, "a man and his helmet"},
    {{3, 1, 225, 3, 1, 0, 0}, "person", 0, 0, 1.80, tight, "civilian"},
    {{3, 1, 0, 201, 1, 0, 0}, "animal", 0, 0, 0, tight, "animal"},
    {{4, 1, 0, 1, 0, 0, 0}, NULL, 0, 0, 0, tight, "environmental"},
    {{5, 1, 225, 1, 1, 0, 0}, "building", 0, 0, 0, tight, "building"},
    {{5, 1, 225, 5, 1, 0, 0}, "bridge", 30, 8, 0, tight, "bridge"},
    {{5, 1, 225, 90, 1, 0, 0}, "net", 9, 5.8, 3, tight, "a net over a jeep"},
    {{5, 1, 0, 90, 2, 0, 0}, "net", 12, 6.6, 3.6, tight, "a net over a tank"},
    {{5, 1, 0, 91, 0, 0, 0}, "wall", 12, 0.4, 2, tight, "wall"},
    {{6, 1, 225, 1, 0, 0, 0}, "crates", 1.22, 1.02, 1.20, tight, "loaded pallet: MIL-P-15011 (48 x 40 in)"},
    {{7, 1, 225, 1, 1, 0, 0}, NULL, 0, 0, 0, tight, "radio"},
    {{8, 2, 225, 1, 1, 0, 0}, NULL, 0, 0, 0, tight, "chaff"},
    {{8, 2, 225, 2, 1, 0, 0}, "flare", 0.148, 0, 0, tight, "MJU-7: DS"},
    {{8, 1, 225, 4, 1, 0, 0}, NULL, 0, 0, 0, tight, "smoke"},
    {{8, 4, 225, 6, 1, 0, 0}, "buoy", 0.124, 0.124, 0.914, tight, "AN/SSQ-53: Jane's Underwater Warfare Systems"},
    {{9, 1, 225, 1, 1, 0, 0}, "radar", 0, 0, 0, tight, "sensor or emitter"},
    {{1, 1, 0, 1, 1, 3, 0}, "tank", 9.53, 3.59, 0, tight, "a tank of no country"},
    {{0, 0, 0, 0, 0, 0, 0}, "unknown", 0, 0, 0, tight, "nothing said"},
    {{1, 0, 225, 1, 0, 0, 0}, "unknown", 0, 0, 0, tight, "a platform of no domain"},
};

static Catalog *open_catalog(double sag_m)
{
    char     path[512];
    Catalog *c = NULL;
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    CHECK(catalog_open(&c, path, sag_m) == STATUS_OK);
    return c;
}

static double up_m(const Model *m) { return fmax(m->box_high[2], 0) - m->box_low[2]; }

static bool near(double got, double want, int percent) { return !(want > 0) || fabs(got / want - 1) <= 0.01 * percent; }

static void common_types_have_their_shape_and_size(void **state)
{
    (void)state;
    Catalog *c = open_catalog(0.01);
    int      wrong = 0;
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        const Published *p = published + i;
        const int        k = catalog_find(c, p->type, NULL, NULL);
        const Model     *m = catalog_model(c, k);
        bool             right = catalog_has_shape(c, k) == (p->shape != NULL);
        if (right && p->shape)
            right = !strcmp(m->name, p->shape) && near(m->length_m, p->length_m, p->percent) &&
                    near(m->width_m, p->width_m, p->percent) && near(up_m(m), p->height_m, p->percent);
        wrong += !right;
        if (!right)
            print_message("%s: %s %.3f x %.3f x %.3f, want %s %.3f x %.3f x %.3f\n", p->what, m->name, m->length_m,
                          m->width_m, up_m(m), p->shape ? p->shape : "nothing", p->length_m, p->width_m, p->height_m);
        CHECK(catalog_is_built(c, k));
    }
    assert_int_equal(wrong, 0);
    catalog_close(c);
}

/* ---- every row ---------------------------------------------------------------------------------- */

static int joint_count(const Model *m, uint32_t dis_class)
{
    int n = 0;
    for (int i = 0; i < m->node_count; i++) n += m->node[i].dis_class == dis_class;
    return n;
}

/* A type that has exactly what one row names. */
static bool row_type(DisEntityType *out, const char *text)
{
    int field[7] = {0};
    for (int f = 0; f < 7 && *text; f++) {
        field[f] = *text == '*' ? f == 3 ? 250 : 0 : (int)strtol(text, NULL, 10);
        while (*text && *text != '.') text++;
        if (*text) text++;
    }
    *out = (DisEntityType){(uint8_t)field[0], (uint8_t)field[1], (uint16_t)field[2], (uint8_t)field[3],
                           (uint8_t)field[4], (uint8_t)field[5], (uint8_t)field[6]};
    return true;
}

/* Through the catalog, in the size of the row: closed, outward, of positive volume, parts and materials named; what
 * rolls is round and stands on the ground; the figures of the row are met. */
static void every_row_gives_a_sound_model(void **state)
{
    (void)state;
    static const char *const column[3] = {"length_m", "width_m", "height_m"};
    char                     path[512];
    Table                    table = {0};
    int                      compared = 0;
    Catalog                 *c = open_catalog(0.05);
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    CHECK(table_open(&table, path) == STATUS_OK);
    for (int r = 0; r < table.rows; r++) {
        DisEntityType type;
        const char   *text = table_text(&table, r, 0);
        CHECK(row_type(&type, text));
        const int    k = catalog_find(c, type, NULL, NULL);
        const Model *m = catalog_model(c, k);
        if (strcmp(m->name, table_text(&table, r, 1)) != 0) continue; /* stars that a deeper row takes */
        compared++;
        if (model_validate(m) != STATUS_OK) fail_msg("%s", text);
        for (int part = 0; part < m->part_count; part++) CHECK(part_volume_m3(m, m->part + part) > 0);
        const double got[3] = {m->length_m, m->width_m, up_m(m)};
        for (int k2 = 0; k2 < 3; k2++) {
            const char *figure = table_text(&table, r, table_column(&table, column[k2]));
            if (*figure && !near(got[k2], strtod(figure, NULL), 2))
                fail_msg("%s: %s %g, want %s", text, column[k2], got[k2], figure);
        }
        for (int n = 0; n < m->node_count; n++)
            if (m->node[n].roll_radius_m > 0 && m->node[n].parent == 0 && !strncmp(m->node[n].name, "wheel", 5)) {
                /* its rim reaches its rolling radius all around: high, low, ahead and behind */
                double reach[2] = {0, 0};
                for (int part = 0; part < m->part_count; part++) {
                    const ModelPart *p = m->part + part;
                    for (int t = p->first_triangle; p->node == n && t < p->first_triangle + p->triangle_count; t++)
                        for (int v = 0; v < 3; v++) {
                            const double *q = m->vertex[m->triangle[t][v]];
                            reach[0] = fmax(reach[0], fabs(q[0]));
                            reach[1] = fmax(reach[1], fabs(q[2]));
                        }
                }
                CHECK_NEAR(reach[0] / m->node[n].roll_radius_m, 1, 0.12);
                CHECK_NEAR(reach[1] / m->node[n].roll_radius_m, 1, 0.12);
                const bool tracked = joint_count(m, 0) > 0 && m->node[n].p_parent[2] + m->node[n].roll_radius_m < -0.01;
                if (!tracked)
                    CHECK_NEAR(m->node[n].p_parent[2], -m->node[n].roll_radius_m,
                               0.03 * m->node[n].roll_radius_m + 0.002);
            }
    }
    CHECK(compared > 0.9 * table.rows);
    table_close(&table);
    catalog_close(c);
}

/* ---- every shape -------------------------------------------------------------------------------- */

/* Area of the outline along an axis, as a share of the box's face: a raster of 96 x 96 cells that any triangle's middle
 * covers. */
static double outline_share(const Model *m, int axis)
{
    enum { cells = 96 };
    static uint8_t cell[cells][cells];
    NodePose       pose[64];
    const int      a = (axis + 1) % 3, b = (axis + 2) % 3;
    int            covered = 0;
    memset(cell, 0, sizeof cell);
    CHECK(m->node_count <= 64);
    model_pose(pose, m, NULL);
    for (int part = 0; part < m->part_count; part++)
        for (int t = m->part[part].first_triangle; t < m->part[part].first_triangle + m->part[part].triangle_count;
             t++) {
            double p[3][2];
            for (int c = 0; c < 3; c++) {
                double q[3];
                m3_mul_v3(q, pose[m->part[part].node].r_body_from_node, m->vertex[m->triangle[t][c]]);
                v3_add(q, q, pose[m->part[part].node].p_body);
                p[c][0] = (q[a] - m->box_low[a]) / (m->box_high[a] - m->box_low[a]) * cells;
                p[c][1] = (q[b] - m->box_low[b]) / (m->box_high[b] - m->box_low[b]) * cells;
            }
            const double det = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
            if (fabs(det) < 1e-12) continue;
            const int i0 = (int)fmax(fmin(p[0][0], fmin(p[1][0], p[2][0])), 0),
                      i1 = (int)fmin(fmax(p[0][0], fmax(p[1][0], p[2][0])), cells - 1);
            const int j0 = (int)fmax(fmin(p[0][1], fmin(p[1][1], p[2][1])), 0),
                      j1 = (int)fmin(fmax(p[0][1], fmax(p[1][1], p[2][1])), cells - 1);
            for (int i = i0; i <= i1; i++)
                for (int j = j0; j <= j1; j++) {
                    const double x = i + 0.5 - p[0][0], y = j + 0.5 - p[0][1];
                    const double u = (x * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * y) / det;
                    const double v = ((p[1][0] - p[0][0]) * y - x * (p[1][1] - p[0][1])) / det;
                    if (u >= 0 && v >= 0 && u + v <= 1) cell[i][j] = 1;
                }
        }
    for (int i = 0; i < cells; i++)
        for (int j = 0; j < cells; j++) covered += cell[i][j];
    return (double)covered / (cells * cells);
}

/* A bus fills its box from the side, an aeroplane does not from above: limits from three-view drawings by eye. */
static void outlines_fill_their_boxes_as_they_should(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double      front[2], side[2], above[2]; /* least and most */
    } want[] = {
        {"bus", {0.85, 1}, {0.80, 1}, {0.90, 1}},
        {"car", {0.70, 0.97}, {0.55, 0.85}, {0.85, 1}},
        {"jeep", {0.60, 0.95}, {0.55, 0.85}, {0.75, 1}},
        {"semi_trailer", {0.8, 1}, {0.7, 0.95}, {0.9, 1}},
        {"motorcycle", {0.10, 0.45}, {0.25, 0.65}, {0.1, 0.45}},
        {"locomotive", {0.55, 0.95}, {0.6, 0.95}, {0.6, 1}},
        {"gun", {0.15, 0.6}, {0.05, 0.35}, {0.05, 0.35}},
        {"rocket_launcher", {0.7, 1}, {0.55, 0.95}, {0.85, 1}},
        {"airliner", {0.05, 0.25}, {0.2, 0.5}, {0.2, 0.4}},
        {"airliner_4", {0.05, 0.25}, {0.2, 0.5}, {0.2, 0.4}},
        {"bomber", {0.03, 0.2}, {0.15, 0.5}, {0.1, 0.35}},
        {"cargo_plane", {0.08, 0.3}, {0.35, 0.65}, {0.15, 0.4}},
        {"light_plane", {0.08, 0.35}, {0.3, 0.6}, {0.2, 0.45}},
        {"uav", {0.02, 0.25}, {0.2, 0.6}, {0.1, 0.3}},
        {"quadcopter", {0.15, 0.6}, {0.15, 0.65}, {0.05, 0.4}},
        {"helicopter_utility", {0.08, 0.3}, {0.15, 0.45}, {0.08, 0.3}},
        {"submarine", {0.4, 0.8}, {0.35, 0.7}, {0.7, 0.98}},
        {"aircraft_carrier", {0.2, 0.6}, {0.3, 0.6}, {0.65, 0.95}},
        {"boat", {0.25, 0.7}, {0.3, 0.65}, {0.7, 0.98}},
        {"cargo_ship", {0.6, 0.95}, {0.45, 0.85}, {0.85, 1}},
        {"shell", {0.7, 0.82}, {0.6, 0.95}, {0.6, 0.95}},
        {"missile_cruise", {0.05, 0.3}, {0.35, 0.7}, {0.15, 0.4}},
        {"tent", {0.7, 0.95}, {0.7, 0.98}, {0.98, 1}},
        {"net", {0.5, 0.8}, {0.55, 0.85}, {0.6, 0.8}}, /* above: its share that is covered */
        {"wall", {0.7, 0.85}, {0.98, 1}, {0.98, 1}},
        {"crates", {0.9, 1}, {0.85, 1}, {0.95, 1}},
        {"animal", {0.3, 0.8}, {0.25, 0.6}, {0.4, 0.85}},
        {"satellite", {0.1, 0.35}, {0.7, 1}, {0.7, 1}},
    };
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        Model               m = build(want[i].name, 0.01);
        const double        share[3] = {outline_share(&m, 0), outline_share(&m, 1), outline_share(&m, 2)};
        const double *const limit[3] = {want[i].front, want[i].side, want[i].above};
        for (int a = 0; a < 3; a++)
            if (!(share[a] >= limit[a][0] && share[a] <= limit[a][1]))
                fail_msg("%s: view %d covers %.3f of its box, want %.2f .. %.2f", want[i].name, a, share[a],
                         limit[a][0], limit[a][1]);
        model_destroy(&m);
    }
}

/* Closed parts without crossing numbers, a heat role, a bounded number of
 * triangles, and nothing under the ground but hulls in water. */
static void shapes_are_sound(void **state)
{
    (void)state;
    for (int i = 0; i < parametric_count(); i++) {
        const char *name = parametric_name(i);
        Model       m = build(name, 0.005);
        ModelEdges  edges;
        CHECK(model_validate(&m) == STATUS_OK);
        CHECK(model_edges(&edges, &m) == STATUS_OK);
        assert_int_equal(edges.open, 0);
        assert_int_equal(edges.inside_out_parts, 0);
        if (m.triangle_count > 70000) fail_msg("%s: %d triangles", name, m.triangle_count);
        const bool afloat = !strcmp(name, "ship") || !strcmp(name, "boat") || !strcmp(name, "rhib") ||
                            !strcmp(name, "submarine") || !strcmp(name, "aircraft_carrier") ||
                            !strcmp(name, "cargo_ship") || !strcmp(name, "tanker");
        if (!afloat && m.box_high[2] > 0.006) fail_msg("%s: %g m under the ground", name, m.box_high[2]);
        if (afloat) CHECK(m.box_high[2] > 0.3);
        for (int p = 0; p < m.part_count; p++) {
            CHECK(m.part[p].role < HEAT_ROLE_COUNT && m.part[p].material[0]);
        }
        model_destroy(&m);
    }
}

static bool has_role(const Model *m, HeatRole role)
{
    for (int p = 0; p < m->part_count; p++)
        if (m->part[p].role == role) return true;
    return false;
}

/* What runs is warm where it should be, and what its class of thing moves does move. */
static void engines_are_warm_and_joints_are_there(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        HeatRole    warm;
        uint32_t    dis_class[2]; /* 0: none */
        int         wheels, spinning;
    } want[] = {
        {"car", HEAT_EXHAUST, {0}, 4, 0},
        {"jeep", HEAT_ENGINE_DECK, {0}, 4, 0},
        {"bus", HEAT_ENGINE_DECK, {0}, 4, 0},
        {"motorcycle", HEAT_ENGINE_DECK, {0}, 2, 0},
        {"carrier_wheeled", HEAT_EXHAUST, {4096, 4416}, 8, 0},
        {"truck_heavy", HEAT_EXHAUST, {0}, 8, 0},
        {"semi_trailer", HEAT_EXHAUST, {0}, 10, 0},
        {"rocket_truck", HEAT_GUN, {4096, 4736}, 6, 0},
        {"rocket_launcher", HEAT_GUN, {4096, 4736}, 16, 0},
        {"howitzer", HEAT_GUN, {4096, 4416}, 18, 0},
        {"bulldozer", HEAT_ENGINE_DECK, {0}, 16, 0},
        {"gun", HEAT_GUN, {4096, 4416}, 2, 0},
        {"mortar", HEAT_GUN, {4096, 4416}, 0, 0},
        {"locomotive", HEAT_ENGINE_DECK, {0}, 12, 0},
        {"railcar", HEAT_WHEEL, {0}, 8, 0},
        {"airliner", HEAT_TURBINE, {3072, 0}, 0, 0},
        {"cargo_plane", HEAT_TURBINE, {3072, 0}, 0, 4},
        {"bomber", HEAT_TURBINE, {3072, 0}, 0, 0},
        {"light_plane", HEAT_EXHAUST, {0}, 0, 1},
        {"uav", HEAT_EXHAUST, {0}, 0, 1},
        {"quadcopter", HEAT_ROTOR, {0}, 0, 4},
        {"helicopter_utility", HEAT_TURBINE, {0}, 0, 2},
        {"helicopter_tandem", HEAT_TURBINE, {0}, 0, 2},
        {"boat", HEAT_EXHAUST, {4096, 4416}, 0, 1},
        {"aircraft_carrier", HEAT_CABIN, {5376, 0}, 0, 1},
        {"missile_air", HEAT_MOTOR, {0}, 0, 0},
        {"radar", HEAT_ENGINE_DECK, {5376, 0}, 2, 1},
        {"animal", HEAT_CLOTHING, {0}, 0, 0},
    };
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        Model m = build(want[i].name, 0.02);
        int   wheels = 0, spinning = 0;
        for (int n = 0; n < m.node_count; n++) {
            wheels += m.node[n].roll_radius_m > 0;
            spinning += m.node[n].spin_rps_moving != 0;
        }
        if (!has_role(&m, want[i].warm)) fail_msg("%s has no part of %s", want[i].name, heat_role_name(want[i].warm));
        for (int k = 0; k < 2; k++)
            if (want[i].dis_class[k]) CHECK(joint_count(&m, want[i].dis_class[k]) > 0);
        assert_int_equal(wheels, want[i].wheels);
        assert_int_equal(spinning, want[i].spinning);
        model_destroy(&m);
    }
}

/* A reported elevation lifts the muzzle by sine and cosine of it, whatever the size; a turret carries it round. */
static void guns_point_where_they_are_reported(void **state)
{
    (void)state;
    static const struct {
        const char *name, *node, *part;
        ModelSize   size;
    } want[] = {
        {"howitzer", "gun", "gun", {0, 0, 0}},   {"howitzer", "gun", "gun", {7.26, 2.85, 2.73}},
        {"gun", "gun", "gun", {11.0, 2.8, 2.9}}, {"tank", "gun", "gun_barrel", {9.83, 3.66, 2.89}},
        {"mortar", "tube", "tube", {0, 0, 0}},   {"rocket_launcher", "launcher", "pods", {0, 0, 0}},
    };
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        Model    m;
        double   value[64] = {0};
        NodePose rest[64], lifted[64], turned[64];
        CHECK(parametric_build_size(&m, want[i].name, &want[i].size, 0.02) == STATUS_OK && m.node_count <= 64);
        const int    gun = find_node(&m, want[i].node), turret = m.node[gun].parent;
        const double low = fmax(m.node[gun].low, 0), by = fmin(0.2, m.node[gun].high - low);
        value[gun] = low;
        model_pose(rest, &m, value);
        value[gun] = low + by;
        model_pose(lifted, &m, value);
        value[turret] = 0.5;
        model_pose(turned, &m, value);
        /* the barrel's direction is the node's x axis */
        CHECK_NEAR(asin(-lifted[gun].r_body_from_node[6]) - asin(-rest[gun].r_body_from_node[6]), by, 1e-9);
        CHECK_NEAR(atan2(turned[gun].r_body_from_node[3], turned[gun].r_body_from_node[0]), 0.5, 1e-9);
        model_destroy(&m);
    }
}

/* ---- sizes ------------------------------------------------------------------------------------------ */

static void sizes_are_met_and_proportions_kept(void **state)
{
    (void)state;
    Model own = build("truck", 0.01), m;
    CHECK(parametric_build_size(&m, "truck", &(ModelSize){.length_m = 2 * own.length_m}, 0.01) == STATUS_OK);
    CHECK_NEAR(m.length_m / own.length_m, 2, 2e-3);
    CHECK_NEAR(m.width_m / own.width_m, 2, 4e-3); /* alone: all follow; facets are finer by half */
    CHECK_NEAR(m.height_m / own.height_m, 2, 4e-3);
    assert_string_equal(m.name, "truck");
    CHECK(m.part_count == own.part_count && m.node_count == own.node_count && m.sag_m == 0.01);
    model_destroy(&m);
    /* out of proportion: still round wheels that stand on the ground and have their radius */
    CHECK(parametric_build_size(&m, "truck", &(ModelSize){9, 2, 4}, 0.01) == STATUS_OK);
    CHECK_NEAR(m.length_m, 9, 0.01);
    CHECK_NEAR(m.width_m, 2, 0.01);
    CHECK_NEAR(m.height_m, 4, 0.01);
    CHECK_NEAR(m.box_high[2], 0, 0.011);
    double low[3], high[3];
    part_box(low, high, &m, "tyre", NULL);
    CHECK_NEAR((high[0] - low[0]) / (high[2] - low[2]), 1, 0.01);
    CHECK_NEAR(0.5 * (high[2] - low[2]), m.node[find_node(&m, "wheel_left_1")].roll_radius_m, 0.011);
    /* normals stay upright on their facets: unit, and outward (validated), and on flat sides exactly across */
    CHECK(model_validate(&m) == STATUS_OK);
    model_destroy(&m);
    model_destroy(&own);

    /* a rotor stays a circle: its reach is the same whichever way its blade points */
    CHECK(parametric_build_size(&m, "helicopter_utility", &(ModelSize){.length_m = 30, .height_m = 9}, 0.02) ==
          STATUS_OK);
    double value[16] = {0}, reach[2];
    part_box(low, high, &m, "blades", value);
    reach[0] = high[0] - m.node[find_node(&m, "main_rotor")].p_parent[0];
    value[find_node(&m, "main_rotor")] = 0.5 * pi_rad;
    part_box(low, high, &m, "blades", value);
    reach[1] = high[1];
    CHECK_NEAR(reach[0] / reach[1], 1, 1e-3);
    model_destroy(&m);
}

static char last_error[512];
static void keep_error(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR) snprintf(last_error, sizeof last_error, "%s", line);
}

static void bad_sizes_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *row, *says;
    } bad[] = {
        {"1.1,tank,base,0,3,2\n", "length_m"},    {"1.1,tank,base,-9,3,2\n", "length_m"},
        {"1.1,tank,base,nan,3,2\n", "length_m"},  {"1.1,tank,base,9,2001,2\n", "width_m"},
        {"1.1,tank,base,9,3,tall\n", "height_m"}, {"1.1,tank,base,0.01,,\n", "too far"},
        {"1.1,flare,base,2000,,\n", "too far"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char     path[text_file_size], text[256];
        Catalog *c = NULL;
        snprintf(text, sizeof text, "type,model,origin,length_m,width_m,height_m\n%s", bad[i].row);
        text_file(path, text);
        last_error[0] = 0;
        log_set_sink(keep_error, NULL);
        const Status status = catalog_open(&c, path, 0.02);
        log_set_sink(NULL, NULL);
        remove(path);
        if (status != STATUS_BAD_VALUE) fail_msg("accepted: %s", bad[i].row);
        CHECK(c == NULL);
    }
}

/* Rows of one shape in two sizes are two models of one class; the same size twice is one. */
static void sizes_make_models_and_shapes_make_classes(void **state)
{
    (void)state;
    char     path[text_file_size];
    Catalog *c = NULL;
    text_file(path, "type,model,origin,length_m,width_m,height_m\n1.1.1,tank,base,,,\n1.1.2,tank,base,9.83,,\n1.1.3,"
                    "tank,base,9.83,,\n"
                    "1.1.4,truck,base,,,\n1.1.5,none,base,,,\n");
    CHECK(catalog_open(&c, path, 0.05) == STATUS_OK);
    remove(path);
    assert_int_equal(catalog_model_count(c), 5); /* unknown, two tanks, the truck, nothing */
    int model[5];
    for (int i = 0; i < 5; i++) {
        model[i] = catalog_find(c, (DisEntityType){1, 1, (uint16_t)(i + 1), 0, 0, 0, 0}, NULL, NULL);
        CHECK(catalog_has_shape(c, model[i]) == (i < 4));
        CHECK(catalog_is_built(c, model[i]));
    }
    CHECK(model[0] != model[1] && model[1] == model[2]);
    CHECK(catalog_class(c, model[1]) == catalog_class(c, model[0]) && catalog_class(c, model[0]) == model[0]);
    CHECK(catalog_class(c, model[3]) == model[3]);
    CHECK_NEAR(catalog_model(c, model[1])->length_m, 9.83, 0.01);
    CHECK_NEAR(catalog_model(c, model[0])->length_m, 9.53, 0.01);
    catalog_close(c);
}

/* The coarse form that stands in until a type is asked for has the parts and nodes that the fine one will have. */
static void coarse_forms_have_the_same_parts(void **state)
{
    (void)state;
    for (int i = 0; i < parametric_count(); i++) {
        Model coarse = build(parametric_name(i), 0.1), fine;
        CHECK(parametric_build_size(&fine, parametric_name(i), &(ModelSize){.length_m = 1.1 * coarse.length_m}, 0.02) ==
              STATUS_OK);
        CHECK(coarse.part_count == fine.part_count && coarse.node_count == fine.node_count);
        for (int p = 0; p < fine.part_count; p++) {
            assert_string_equal(coarse.part[p].name, fine.part[p].name);
            assert_string_equal(coarse.part[p].material, fine.part[p].material);
            CHECK(coarse.part[p].role == fine.part[p].role && coarse.part[p].node == fine.part[p].node);
        }
        model_destroy(&coarse);
        model_destroy(&fine);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(common_types_have_their_shape_and_size),
        cmocka_unit_test(every_row_gives_a_sound_model),
        cmocka_unit_test(outlines_fill_their_boxes_as_they_should),
        cmocka_unit_test(shapes_are_sound),
        cmocka_unit_test(engines_are_warm_and_joints_are_there),
        cmocka_unit_test(guns_point_where_they_are_reported),
        cmocka_unit_test(sizes_are_met_and_proportions_kept),
        cmocka_unit_test(bad_sizes_are_refused),
        cmocka_unit_test(sizes_make_models_and_shapes_make_classes),
        cmocka_unit_test(coarse_forms_have_the_same_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
